//! `etendue sweep`: fields of a scene over ranges; every plane's numbers as one table, and curves.
//!
//! Each point is a run of its own, kept below `points` in a folder named by the hash of its scene. A
//! sweep that was stopped, or that has other values now, goes on from what is there.

mod pictures;
mod table;

use crate::args::{SceneArgs, SweepArgs};
use crate::print::{say, say_replaced};
use crate::threads::on_threads;
use crate::values::{Point, Setting, Sweep, points, shown};
use crate::{progress, warnings};
use etendue_compare::{Applicability, Test};
use etendue_field::{decimals, fixed, uncertain};
use etendue_pipeline::Leader;
use etendue_pipeline::MeasuredScene;
use etendue_pipeline::Silent;
use etendue_pipeline::Summary;
use etendue_pipeline::judged;
use etendue_pipeline::table::aligned;
use etendue_pipeline::{limits, load, method};
use etendue_scene::{Scene, SceneFile, read_file};
use etendue_store::Failure;
use etendue_store::Method;
use etendue_store::sealed::json;
use etendue_store::stored::{VERSION, check_earlier, summary_of};
use etendue_store::unfinished;
use etendue_store::{LINKED, MAX_INDEX_BYTES, Plan, Results, SUMMARY, SWEEP, inside};
use serde::Serialize;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use table::{BANDWIDTHS, Found, SLOPE};

/// The table, in two formats.
const TABLES: [&str; 2] = ["sweep.csv", "sweep.parquet"];

/// `etendue sweep`: returns the exit code.
pub(crate) fn sweep(args: &SweepArgs) -> Result<u8, Failure> {
    sweep_with(args, None)
}

/// The same, with other processes that run points as well.
pub(crate) fn sweep_with(args: &SweepArgs, workers: Option<&Leader<'_>>) -> Result<u8, Failure> {
    on_threads(&args.threads, || {
        let all = Points::read(args)?;
        let folder = args.out.clone();
        let name = || Path::new("out").join(format!("{}-sweep", all.base.name));
        let folder = folder.unwrap_or_else(name);
        let checked = |scene| {
            let theories = Applicability::of_planes(scene);
            method::check(scene, args.photons.method)?;
            limits::check(scene, &theories, rayon::current_num_threads())
        };
        all.scenes.iter().try_for_each(checked)?;
        if !args.quiet {
            warnings::tell_at(&all.points, &all.scenes);
        }
        let Points { base, sweeps, .. } = &all;
        check_earlier(&folder, SWEEP, base, args.force.force)?;
        check_fields(&folder, sweeps, args.force.force)?;
        let inputs = load::inputs(&all.scene.source(), base);
        // Before the work, and once more for the table: each point claims a folder of its own.
        drop(Results::claim(&folder, plan(&inputs, args.force.force))?);
        unfinished::keeps(
            "interrupted: the points that are done are kept, and the same command goes on from them",
        );
        let found = run_all(args, &folder, &inputs, &all, workers)?;
        let results = Results::claim(&folder, plan(&inputs, args.force.force))?;
        finish(args, base, sweeps, &found, results)
    })
}

/// What is asked for: a scene at each point of a sweep.
pub(crate) struct Points {
    scene: SceneArgs,
    base: Scene,
    sweeps: Vec<Sweep>,
    method: Method,
    points: Vec<Point>,
    /// One for each point.
    pub(crate) scenes: Vec<Scene>,
}

impl Points {
    /// Those of a command line.
    pub(crate) fn read(args: &SweepArgs) -> Result<Self, Failure> {
        let (set, sweeps) = settings(&args.set);
        check(args, &set, &sweeps)?;
        let scene = SceneArgs {
            path: args.path.clone(),
            set,
        };
        let base = load::scene(&scene.source(), |run| args.photons.set(run))?;
        let points = points(&sweeps, args.together)?;
        let has_own_seed = !args.common_seed && sweeps.iter().all(|s| s.path != "run.seed");
        let at = |point| {
            let mut at = scene.at(point, |run| args.photons.set(run))?;
            if has_own_seed {
                at.run.seed = seed_of(&at);
                at.file.run.seed = at.run.seed;
            }
            Ok(at)
        };
        let scenes = points.iter().map(at).collect::<Result<_, _>>()?;
        Ok(Self {
            scene,
            base,
            sweeps,
            method: args.photons.method,
            points,
            scenes,
        })
    }

    /// Runs a point; returns its `summary.json`.
    pub(crate) fn summary(&self, point: u32) -> Result<Vec<u8>, Failure> {
        let scene = self.scenes.get(point as usize);
        let scene = scene.ok_or_else(|| Failure::cannot_run("no such point"))?;
        let theories = Applicability::of_planes(scene);
        let case = MeasuredScene::of(scene.clone(), theories, self.method, &Silent)?;
        let summary = Summary::new(&case, &judged(&case, &Test::of(&case.scene))?, Vec::new());
        Ok(summary.json(&BTreeMap::new()))
    }
}

/// The seed of a point, told by its scene and the seed of the sweep, whatever other points there are. A number that every reader of JSON
/// holds exactly.
fn seed_of(scene: &Scene) -> u64 {
    let hash = blake3::hash(scene.hash().as_bytes());
    let mut words = hash.as_bytes().chunks_exact(8).map(|word| {
        let word: [u8; 8] = word.try_into().unwrap_or_default();
        u64::from_le_bytes(word)
    });
    words.next().unwrap_or(0) >> 24
}

/// Fails where nothing is swept, or a field is given its values twice.
fn check(args: &SweepArgs, set: &[(String, String)], sweeps: &[Sweep]) -> Result<(), Failure> {
    if sweeps.is_empty() {
        let given: Vec<String> = set
            .iter()
            .map(|(path, value)| format!("{path}={value} is one value; "))
            .collect();
        let message = format!(
            "nothing is swept: {}--set PATH=A..B:N or PATH=A,B,C gives a field several, such as --set blockers.0.pitch=0.05..0.4:8",
            given.concat()
        );
        return Err(Failure::bad_input(message));
    }
    let options = [
        ("run.photons", args.photons.photons.is_some()),
        ("run.seed", args.photons.seed.is_some()),
    ];
    let options = options
        .iter()
        .filter(|(_, given)| *given)
        .map(|(path, _)| *path);
    let fixed = set.iter().map(|(path, _)| path.as_str()).chain(options);
    let mut given: Vec<&str> = fixed
        .chain(sweeps.iter().map(|sweep| sweep.path.as_str()))
        .collect();
    given.sort_unstable();
    match given.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(Failure::bad_input(format!("{} is given twice", pair[0]))),
        None => Ok(()),
    }
}

/// Fails where the folder holds a sweep of other fields.
fn check_fields(folder: &Path, sweeps: &[Sweep], force: bool) -> Result<(), Failure> {
    let earlier = read_file(&folder.join(SWEEP), MAX_INDEX_BYTES).ok();
    let earlier: Option<Value> = earlier.and_then(|bytes| serde_json::from_slice(&bytes).ok());
    let Some(fields) = earlier
        .as_ref()
        .and_then(|index| index["sweeps"].as_object())
    else {
        return Ok(());
    };
    let now: BTreeSet<&str> = sweeps.iter().map(|sweep| sweep.path.as_str()).collect();
    let earlier: BTreeSet<&str> = fields.keys().map(String::as_str).collect();
    if force || now == earlier {
        return Ok(());
    }
    let earlier: Vec<&str> = earlier.into_iter().collect();
    Err(Failure::cannot_run(format!(
        "{} holds a sweep of {}: choose another folder with --out, or replace it with --force",
        folder.display(),
        earlier.join(", ")
    )))
}

/// What is set to one value, and what is swept.
fn settings(all: &[Setting]) -> (Vec<(String, String)>, Vec<Sweep>) {
    let (mut set, mut sweeps) = (Vec::new(), Vec::new());
    for setting in all {
        match setting {
            Setting::Value(path, value) => set.push((path.clone(), value.clone())),
            Setting::Sweep(sweep) => sweeps.push(sweep.clone()),
        }
    }
    (set, sweeps)
}

fn plan(inputs: &[PathBuf], force: bool) -> Plan {
    let pictures = pictures::NAMES.iter();
    let pictures =
        pictures.flat_map(|name| ["png", "svg", "csv"].map(|end| format!("{name}.{end}")));
    Plan {
        index: SWEEP,
        files: pictures.chain(TABLES.map(str::to_owned)).collect(),
        inputs: inputs.to_vec(),
        force,
    }
}

/// What each point gives, run now or before.
fn run_all(
    args: &SweepArgs,
    folder: &Path,
    inputs: &[PathBuf],
    all: &Points,
    workers: Option<&Leader<'_>>,
) -> Result<Vec<Found>, Failure> {
    let bar = progress::steps("running", all.points.len(), "points", args.quiet);
    let names = folders(args, folder, all)?;
    let earlier = |point: usize| {
        let there = folder.join(&names[point]);
        summary_of(&there, &all.scenes[point], args.photons.method)
    };
    let claimed = |point: u32| {
        let plan = Plan {
            index: SUMMARY,
            files: Vec::new(),
            inputs: inputs.to_vec(),
            force: args.force.force,
        };
        Results::claim_below(folder, &names[point as usize], plan)
    };
    let kept = |results: Results, summary: &[u8]| -> Result<Value, Failure> {
        results.finish(|_| summary.to_vec())?;
        bar.inc(1);
        serde_json::from_slice(summary).map_err(Failure::cannot_run)
    };
    let own = |point: u32| {
        bar.set_message(shown(&all.points[point as usize]));
        let results = claimed(point)?;
        kept(results, &all.summary(point)?)
    };
    let mut summaries: Vec<Option<Value>> = (0..names.len()).map(earlier).collect();
    let missing = (0..).zip(&summaries);
    let missing = missing.filter(|(_, summary)| summary.is_none());
    let missing: Vec<u32> = missing.map(|(point, _)| point).collect();
    bar.set_position((names.len() - missing.len()) as u64);
    let found: BTreeMap<u32, Value> = match workers {
        None => missing
            .iter()
            .map(|i| Ok((*i, own(*i)?)))
            .collect::<Result<_, Failure>>()?,
        Some(workers) => workers.run(&all.scenes, &missing, &own, &|point, summary| {
            kept(claimed(point)?, summary)
        })?,
    };
    bar.finish_and_clear();
    for (point, summary) in found {
        summaries[point as usize] = Some(summary);
    }
    let points = all.points.iter().zip(names).zip(summaries);
    let found = points.map(|((point, folder), summary)| {
        let summary = summary.ok_or_else(|| Failure::cannot_run("a point was not run"))?;
        Ok(Found {
            point: point.clone(),
            folder,
            summary,
        })
    });
    found.collect()
}

/// The folders of the points, none of which leads out of that of the sweep.
fn folders(args: &SweepArgs, folder: &Path, all: &Points) -> Result<Vec<String>, Failure> {
    let name = |scene: &Scene| {
        let name = format!("points/{}", name_of(scene, args));
        match inside(folder, &format!("{name}/{SUMMARY}")) {
            Some(_) => Ok(name),
            None => Err(Failure::write(&folder.join(name), LINKED)),
        }
    };
    all.scenes.iter().map(name).collect()
}

/// The name of a point: the same for the same scene and method.
fn name_of(scene: &Scene, args: &SweepArgs) -> String {
    let what = format!("{} {}", scene.hash(), args.photons.method.words());
    blake3::hash(what.as_bytes()).to_hex()[..16].to_owned()
}

/// `sweep.json`, all but the hashes of the files.
#[derive(Debug, Serialize)]
struct Index<'a> {
    scene: &'a str,
    version: &'a str,
    /// The scene without the fields that are swept.
    scene_file: &'a SceneFile,
    /// Whether the fields go in step.
    together: bool,
    sweeps: BTreeMap<&'a str, &'a [f64]>,
    /// Folders of the points, in the order of the table.
    points: Vec<&'a str>,
    files: &'a BTreeMap<String, String>,
}

/// Writes the table and the pictures; returns the exit code.
fn finish(
    args: &SweepArgs,
    base: &Scene,
    sweeps: &[Sweep],
    found: &[Found],
    mut results: Results,
) -> Result<u8, Failure> {
    let paths: Vec<String> = sweeps.iter().map(|sweep| sweep.path.clone()).collect();
    results.write(TABLES[0], &table::csv(&paths, found)?)?;
    results.write(TABLES[1], &table::parquet(&paths, found)?)?;
    let figures = pictures::drawn(&base.name, found, args.together)?;
    for (name, figure) in pictures::NAMES.iter().zip(&figures) {
        etendue_report::pictures::write(&mut results, name, figure)?;
    }
    let finished = results.finish(|files| {
        json(&Index {
            scene: &base.name,
            version: VERSION,
            scene_file: &base.file,
            together: args.together,
            sweeps: sweeps
                .iter()
                .map(|s| (s.path.as_str(), s.values.as_slice()))
                .collect(),
            points: found.iter().map(|at| at.folder.as_str()).collect(),
            files,
        })
    })?;
    say_replaced(&finished, args.quiet);
    if !args.quiet {
        say(&aligned(rows(&paths, found)).join("\n"));
        if figures.is_empty() {
            say("no curves: they would have more than 24 panels");
        }
        let count = |verdict: &str| {
            found
                .iter()
                .filter(|at| at.summary["verdict"] == verdict)
                .count()
        };
        let [pass, fail, undecided] = ["pass", "fail", "undecided"].map(count);
        say(&format!(
            "{} points: {pass} pass, {fail} fail, {undecided} undecided",
            found.len()
        ));
        say(&format!("sweep in {}", finished.folder.display()));
    }
    let any = |verdict: &str| found.iter().any(|at| at.summary["verdict"] == verdict);
    Ok(match (any("fail"), any("undecided")) {
        (true, _) => 1,
        (false, true) => 4,
        (false, false) => 0,
    })
}

/// The table for the terminal: a row for each plane at each point.
fn rows(paths: &[String], found: &[Found]) -> Vec<Vec<String>> {
    let shown = [
        (BANDWIDTHS[0], "ρ of 95 % [cycles/m]"),
        (BANDWIDTHS[1], "ν of 95 % [cycles/slope]"),
        (SLOPE, "shear slope [m]"),
    ];
    let mut header = paths.to_vec();
    header.extend(["plane", "verdict", "p"].map(str::to_owned));
    header.extend(
        shown
            .iter()
            .flat_map(|(_, name)| [(*name).to_owned(), "predicted".to_owned()]),
    );
    let row = |at: &Found, plane: &Value| {
        let mut row: Vec<String> = at.point.iter().map(|(_, x)| x.to_string()).collect();
        let words = ["name", "verdict"].map(|key| plane[key].as_str().unwrap_or_default());
        row.extend(words.map(str::to_owned));
        row.push(
            plane["p_value"]
                .as_f64()
                .map_or("–".to_owned(), |p| format!("{p:.4}")),
        );
        let numbers = table::numbers(plane);
        for (quantity, _) in shown {
            let number = numbers.iter().find(|number| number.quantity == quantity);
            let measured = number.and_then(|n| Some(uncertain(n.measured?, n.error?)));
            let predicted = number.and_then(|n| {
                let places = n.error.filter(|e| *e > 0.0).map_or(4, decimals);
                Some(fixed(n.predicted?, places))
            });
            row.extend([measured, predicted].map(|cell| cell.unwrap_or("–".to_owned())));
        }
        row
    };
    let rows = found
        .iter()
        .flat_map(|at| at.planes().map(move |plane| row(at, plane)));
    std::iter::once(header).chain(rows).collect()
}
