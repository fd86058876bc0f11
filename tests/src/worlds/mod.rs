//! Probes random worlds with the program: rays that are traced back from the camera must agree with
//! photons from the lights, or with rays that never sample a light.

mod draw;

use crate::hostile::child::{self, Limit};
use crate::hostile::on_threads;
use crate::hostile::stages::words;
use crate::progress::progress;
use crate::report::{Check, ReportSection, Row};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Options of the search.
#[derive(Debug, clap::Args)]
pub(crate) struct WorldOptions {
    /// Number of worlds.
    #[arg(long, default_value_t = 100)]
    scenes: u64,
    /// Index of the first world.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Seed of the random worlds.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Backward rays of a plane.
    #[arg(long, default_value_t = 1 << 17)]
    rays: u64,
    /// Photons of a world.
    #[arg(long, default_value_t = 1 << 21)]
    photons: u64,
    /// Number of worlds that run in parallel [default: one for each core].
    #[arg(long)]
    threads: Option<usize>,
    /// Folder for worlds with a fault.
    #[arg(long, default_value = "target/worlds")]
    out: PathBuf,
    /// Only draw the worlds and save all of them, without running any.
    #[arg(long)]
    draw: bool,
    /// Program to test [default: etendue in the same folder].
    #[arg(long)]
    etendue: Option<PathBuf>,
}

/// Time after which a probe counts as hung.
const LIMIT: Limit = Limit {
    clock: Duration::from_secs(3600),
    work: Duration::from_secs(600),
};

/// Exit codes of a probe with a verdict: pass, fail and undecided.
const VERDICTS: [i32; 3] = [0, 1, 4];

/// Repetitions of a failed probe, with other seeds. At a level of 1 %, a correct probe fails twice
/// in one of 10,000 worlds.
const AGAIN: u64 = 2;

/// What was found in one world.
#[derive(Debug)]
enum WorldOutcome {
    /// The ray of the pixel meets nothing.
    Nothing,
    /// The verdicts of the planes.
    Planes(Vec<String>),
    /// The probe failed with every seed. The text contains its planes with their p-values.
    Wrong(String),
    /// The program ended without a verdict, for this reason.
    Broken(String),
}

/// Probes all worlds.
pub(crate) fn worlds(options: &WorldOptions) -> io::Result<ReportSection> {
    let program = child::program(options.etendue.as_deref())?;
    let place = tempfile::tempdir()?;
    let bar = progress(options.scenes, "worlds");
    let numbers = options.first..options.first + options.scenes;
    let found = on_threads(options.threads, numbers, &bar, |_, number| {
        let at = place.path().join(number.to_string());
        fs::create_dir_all(&at)?;
        let outcome = one(options, &program, number, &at)?;
        fs::remove_dir_all(&at)?;
        Ok(outcome)
    })?;
    Ok(section(options.seed, &found))
}

/// Draws and probes a world, and saves it if it shows a fault.
fn one(options: &WorldOptions, program: &Path, number: u64, at: &Path) -> io::Result<WorldOutcome> {
    let (text, pixel) = draw::world(options.seed, number);
    fs::write(at.join("world.xml"), &text)?;
    let mut outcome = WorldOutcome::Nothing;
    if !options.draw {
        for seed in 1..=1 + AGAIN {
            outcome = probed(options, program, pixel, seed, at)?;
            if !matches!(outcome, WorldOutcome::Wrong(_)) {
                break;
            }
        }
    }
    if options.draw || matches!(outcome, WorldOutcome::Wrong(_) | WorldOutcome::Broken(_)) {
        fs::create_dir_all(&options.out)?;
        let [column, row] = pixel;
        let name = format!("{}-{number}-{column}-{row}.xml", options.seed);
        fs::write(options.out.join(name), &text)?;
    }
    Ok(outcome)
}

/// Probes a world with one seed of rays and photons.
fn probed(
    options: &WorldOptions,
    program: &Path,
    [column, row]: [usize; 2],
    seed: u64,
    at: &Path,
) -> io::Result<WorldOutcome> {
    let command = format!(
        "probe world.xml --pixel {column},{row} --depth 2 --window 16 --rays {} --photons {} --seed {seed} --threads 1 --quiet --force --out out",
        options.rays, options.photons
    );
    let ended = child::call_within(LIMIT, program, at, &words(&command), at)?;
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    if said.contains("meets nothing") {
        return Ok(WorldOutcome::Nothing);
    }
    if ended.hung {
        return Ok(WorldOutcome::Broken("hangs".to_owned()));
    }
    let Some(code) = ended.code.filter(|code| VERDICTS.contains(code)) else {
        return Ok(WorldOutcome::Broken(format!("{:?}: {said}", ended.code)));
    };
    let probe = fs::read(at.join("out/probe.json"))?;
    let probe: Value = serde_json::from_slice(&probe).map_err(io::Error::other)?;
    let planes = probe["planes"].as_array().cloned().unwrap_or_default();
    let word =
        |plane: &Value, key: &str| plane["report"][key].as_str().unwrap_or_default().to_owned();
    if code == 1 {
        let told = planes
            .iter()
            .map(|plane| format!("{} {}", word(plane, "name"), plane["report"]["p_value"]));
        return Ok(WorldOutcome::Wrong(told.collect::<Vec<_>>().join(", ")));
    }
    let verdict = |plane: &Value| match (plane["judge"].as_str(), plane["photons_miss"].as_str()) {
        (Some("photons"), Some(_)) => "undecided: photons miss light".to_owned(),
        (Some("photons"), None) => word(plane, "verdict"),
        _ => format!("{}, by BSDF rays", word(plane, "verdict")),
    };
    Ok(WorldOutcome::Planes(planes.iter().map(verdict).collect()))
}

fn section(seed: u64, found: &[(u64, WorldOutcome)]) -> ReportSection {
    let mut planes: BTreeMap<&str, usize> = BTreeMap::new();
    let mut others: BTreeMap<String, Vec<u64>> = BTreeMap::new();
    let (mut wrong, mut broken) = (0, 0);
    for (number, outcome) in found {
        let other = match outcome {
            WorldOutcome::Planes(verdicts) => {
                for verdict in verdicts {
                    *planes.entry(verdict).or_default() += 1;
                }
                continue;
            }
            WorldOutcome::Nothing => "pixels that see nothing".to_owned(),
            WorldOutcome::Wrong(planes) => {
                wrong += 1;
                format!("**wrong**, failures that repeat: {planes}")
            }
            WorldOutcome::Broken(why) => {
                broken += 1;
                format!("**broken**: {why}")
            }
        };
        others.entry(other).or_default().push(*number);
    }
    let row = |what: String, count: usize, which: &[u64]| {
        let shown: Vec<String> = which.iter().take(20).map(u64::to_string).collect();
        Row::new(vec![what, count.to_string(), shown.join(", ")], Vec::new())
    };
    let mut rows = vec![row("worlds".to_owned(), found.len(), &[])];
    for (verdict, count) in planes {
        rows.push(row(format!("planes, {verdict}"), count, &[]));
    }
    for (what, which) in others {
        rows.push(row(what, which.len(), &which));
    }
    ReportSection::new(
        format!("Random worlds, seed {seed}"),
        "Random worlds have all shapes, materials, textures and lights of Mitsuba scenes that \
         Étendue reads. Each world is probed at a random pixel, with planes at the camera and at \
         two surfaces. A probe that fails is repeated with two other seeds. Required: no probe \
         fails each time, and none ends without a verdict.",
        "what | count | worlds",
        rows,
    )
    .with_checks(vec![
        Check::none("wrong", wrong),
        Check::none("broken", broken),
    ])
}
