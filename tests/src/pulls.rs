//! Measures the pulls of parameters and slopes, and the cost of predictions, over random scenes.
//!
//! A pull is a deviation divided by its stated error. It is then converted from Student's
//! distribution to the normal distribution. The deviation is the difference between a measured
//! parameter and its value in the scene, or between a measured slope and the predicted slope. If
//! the stated errors are right, pulls have mean 0 and standard deviation 1, and their tails are the
//! tails of a normal distribution.

use crate::hostile::child::work_of;
use crate::progress::progress;
use crate::report::Bound::Below;
use crate::report::{Check, ReportSection, Row};
use crate::scenes::traced;
use crate::statistics::mean;
use crate::{nets, wild};
use etendue_compare::{Class, Prediction, Verdict, compare};
use etendue_predict::{Applicability, predict, test_of, too_much_work};
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_theory::{Observed, PathKind};
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::PathBuf;

/// Options that select the measured scenes and the number of photons.
#[derive(Debug, clap::Args)]
pub(crate) struct PullOptions {
    /// Number of scenes.
    #[arg(long, default_value_t = 300)]
    scenes: u64,
    /// Index of the first scene.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Seed of the random scenes.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Photons per scene.
    #[arg(long, default_value_t = 1_000_000)]
    photons: u64,
    /// Folder to which all scenes are written.
    #[arg(long)]
    keep: Option<PathBuf>,
}

/// Fractions of a normal distribution beyond 2, 3 and 4 standard deviations.
const NORMAL: [(f64, f64); 3] = [(2.0, 0.0455), (3.0, 0.0027), (4.0, 6.3e-5)];
/// Permitted deviation of the pulls' mean from 0 and of their standard deviation from 1, in
/// addition to the standard errors of both.
const MAX_DEVIATION: f64 = 0.05;
/// Maximum permitted deviation of a statistic, in standard errors. One statistic in 400 exceeds
/// this maximum by chance.
const MAX_ERRORS: f64 = 3.0;
/// Maximum noise of a plane that is judged, relative to the plane's spectrum.
const MAX_NOISE: f64 = 0.25;
/// Minimum number of scenes in a group that is judged; with fewer scenes, the standard errors of
/// the group's mean and deviation are uncertain.
const MIN_SCENES: usize = 10;
/// Maximum number of rows in the table of single pulls and in the table of single scenes.
const LISTED: usize = 12;
/// A prediction may take more time than tracing the photons of its scene only if it takes at most
/// this number of CPU seconds.
const MAX_SECONDS: f64 = 10.0;

/// The pull of one measured number.
struct Pull {
    scene: u64,
    plane: String,
    kind: &'static str,
    parameter: String,
    value: f64,
}

/// The CPU seconds spent on one scene.
struct Cost {
    scene: u64,
    traced: f64,
    predicted: f64,
    slowest: String,
}

/// Measures and predicts all scenes, and returns the sections on pulls and cost.
pub(crate) fn pulls(options: &PullOptions) -> io::Result<Vec<ReportSection>> {
    let bar = progress(options.scenes, "scenes");
    let (mut pulls, mut costs) = (Vec::new(), Vec::new());
    for number in options.first..options.first + options.scenes {
        if let Some(scene) = drawn(options, number)? {
            costs.extend(judged(&scene, number, &mut pulls)?);
        }
        bar.one();
    }
    bar.end();
    Ok(vec![
        grouped(
            &pulls,
            options,
            "Pulls by kind of prediction",
            |pull| pull.kind.to_owned(),
            true,
        ),
        grouped(
            &pulls,
            options,
            "Pulls by parameter",
            |pull| pull.parameter.clone(),
            false,
        ),
        largest(&pulls),
        cost(&costs),
    ])
}

/// Draws the scene with this number. Scenes with even numbers and scenes with odd numbers come from
/// different generators: `wild`, and the generator for nets. Returns `None` if the scene is
/// invalid.
fn drawn(options: &PullOptions, number: u64) -> io::Result<Option<Scene>> {
    let folder = tempfile::tempdir()?;
    let file = if number.is_multiple_of(2) {
        wild::scene(options.seed, number, options.photons, folder.path()).ok()
    } else {
        SceneFile::parse(&nets::scene(number)).ok()
    };
    let Some(mut file) = file else {
        return Ok(None);
    };
    file.run.photons = options.photons;
    // Each scene has its own seed, because photons of the same seed would have the same noise in
    // all scenes.
    file.run.seed = options.seed + number;
    file.run.resolution = MAX_NOISE;
    if let Some(kept) = &options.keep {
        fs::create_dir_all(kept)?;
        fs::write(kept.join(format!("{number}.ron")), wild::text(&file)?)?;
    }
    Ok(resolve("scene", file, folder.path(), u64::MAX).ok())
}

/// Adds the pulls of a scene to the list, and returns the CPU seconds spent on this scene.
/// Returns `None` if no theory applies to any plane of the scene, or if the scene takes too much
/// work.
fn judged(scene: &Scene, number: u64, pulls: &mut Vec<Pull>) -> io::Result<Option<Cost>> {
    let planes = scene.planes.iter();
    let theories: Vec<Applicability> = planes
        .map(|plane| Applicability::new(scene, plane))
        .collect();
    let has_theory =
        |theory: &Applicability| theory.class() != Class::Reference && theory.dark.is_none();
    if too_much_work(scene, &theories).is_some() || !theories.iter().any(has_theory) {
        return Ok(None);
    }
    let start = cpu_seconds()?;
    let measurement = traced(scene);
    let mut cost = Cost {
        scene: number,
        traced: cpu_seconds()? - start,
        predicted: 0.0,
        slowest: String::new(),
    };
    let mut slowest = 0.0;
    for (i, (plane, theory)) in scene.planes.iter().zip(&theories).enumerate() {
        if !has_theory(theory) {
            continue;
        }
        let start = cpu_seconds()?;
        let prediction = predict(scene, plane, theory);
        let seconds = cpu_seconds()? - start;
        cost.predicted += seconds;
        let kind = kind(theory, &prediction);
        if seconds >= slowest {
            slowest = seconds;
            cost.slowest = format!("{} ({kind}, {seconds:.1} s)", plane.name);
        }
        let Ok(compared) = compare(&measurement, i, &prediction, &test_of(scene)) else {
            continue;
        };
        let report = compared.report;
        let groups = match prediction.replicates.len() {
            0 => measurement.batches().len(),
            replicates => replicates.min(measurement.batches().len()),
        };
        // A plane is skipped if its noise exceeds the resolution, because with so few photons the
        // errors are not normally distributed.
        if report.exact_verdict() == Verdict::Undecided {
            continue;
        }
        let mut add = |parameter: &str, value: f64| {
            if value.is_finite() {
                pulls.push(Pull {
                    scene: number,
                    plane: plane.name.clone(),
                    kind,
                    parameter: parameter.to_owned(),
                    value: normal(value, groups - 1),
                });
            }
        };
        let slope = report.slope;
        if let (Some(measured), Some(predicted), Some(error)) =
            (slope.measured, slope.predicted, slope.error)
        {
            add("shear slope", (measured - predicted) / error);
        }
        for parameter in &report.parameters {
            // Parameters that the photons do not determine are not reported as measured.
            if parameter.detectable < parameter.scene.abs() {
                let word = parameter.name.split(' ').next().unwrap_or_default();
                add(
                    word,
                    (parameter.measured - parameter.scene) / parameter.error,
                );
            }
        }
    }
    Ok(Some(cost))
}

/// The normal quantile that corresponds to the quantile `t` of Student's distribution
/// with this number of degrees of freedom. The approximation is accurate to 0.01 for 30 or more
/// degrees of freedom (Abramowitz and Stegun 1964, 26.7.8). Deviations in units of stated errors
/// follow Student's distribution, because stated errors come from the spread of a few dozen
/// batches.
fn normal(t: f64, freedom: usize) -> f64 {
    let freedom = freedom as f64;
    t * (1.0 - 0.25 / freedom) / (1.0 + t * t / (2.0 * freedom)).sqrt()
}

/// A name for the theory of a plane and the way in which it is evaluated.
fn kind(theory: &Applicability, prediction: &Prediction) -> &'static str {
    let nets = !prediction.replicates.is_empty();
    let is_rule = prediction.quadrature_error.is_some();
    let kind = theory.theory.path().map(Observed::kind);
    match (kind, nets, is_rule) {
        (None, true, _) => "exact, nets",
        (None, false, true) => "exact, quadrature",
        (None, false, false) => "exact, closed form",
        (Some(PathKind::Specular), true, _) => "specular, nets",
        (Some(PathKind::Specular), false, _) => "specular, quadrature",
        (Some(PathKind::Several), ..) => "several surfaces, nets",
        (Some(PathKind::Scattered), ..) => "scattering, nets",
    }
}

/// The sum of user and system time of this process.
fn cpu_seconds() -> io::Result<f64> {
    let stat = fs::read_to_string("/proc/self/stat")?;
    Ok(work_of(&stat).unwrap_or_default().as_secs_f64())
}

/// A section with a row for the pulls of each group.
fn grouped(
    pulls: &[Pull],
    options: &PullOptions,
    title: &str,
    group: impl Fn(&Pull) -> String,
    is_judged: bool,
) -> ReportSection {
    let mut groups: BTreeMap<String, Vec<&Pull>> = BTreeMap::new();
    for pull in pulls {
        groups.entry("all".into()).or_default().push(pull);
        groups.entry(group(pull)).or_default().push(pull);
    }
    let required = if is_judged {
        format!(
            "Required: the mean is 0 and the standard deviation is 1, each to {MAX_DEVIATION} or \
            {MAX_ERRORS} standard errors (over scenes), in groups of at least {MIN_SCENES} \
            scenes."
        )
    } else {
        "This table has no requirements of its own.".into()
    };
    ReportSection::new(
        title,
        format!(
            "A pull is a measured number minus its prediction, in units of the stated error. The \
             scenes have the seed {}, and each is traced with {} photons. Of a normal \
             distribution, 4.55, 0.27 and 0.006 % are beyond 2, 3 and 4. {required}",
            options.seed, options.photons
        ),
        "group | scenes | pulls | mean | standard deviation | beyond 2 | beyond 3 | beyond 4 | \
         verdict",
        groups
            .iter()
            .map(|(name, pulls)| row(name, pulls, is_judged)),
    )
}

fn row(name: &str, pulls: &[&Pull], is_judged: bool) -> Row {
    let mut scenes: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
    for pull in pulls {
        scenes.entry(pull.scene).or_default().push(pull.value);
    }
    let count = pulls.len() as f64;
    let total = |of: &dyn Fn(f64) -> f64| pulls.iter().map(|p| of(p.value)).sum::<f64>() / count;
    // The pulls of one scene are dependent, so standard errors are computed from the scatter
    // between scenes.
    let error = |of: &dyn Fn(f64) -> f64| {
        let all = total(of);
        let apart = scenes
            .values()
            .map(|s| s.iter().map(|v| of(*v) - all).sum::<f64>());
        apart.map(|d| d * d).sum::<f64>().sqrt() / count
    };
    let [mean, mean_error] = [total(&|v| v), error(&|v| v)];
    let sd = total(&|v| v * v).sqrt();
    let sd_error = 0.5 * error(&|v| v * v) / sd;
    let mut cells = vec![
        name.to_owned(),
        scenes.len().to_string(),
        pulls.len().to_string(),
        format!("{mean:+.3} ± {mean_error:.3}"),
        format!("{sd:.3} ± {sd_error:.3}"),
    ];
    for (distance, _) in NORMAL {
        let share = total(&|v| f64::from(v.abs() > distance));
        cells.push(format!("{:.2} %", 100.0 * share));
    }
    let within = |id, off: f64, error: f64| {
        let bound = MAX_DEVIATION.max(MAX_ERRORS * error);
        Check::new(id, off, Below(bound)).because("0.05, or three standard errors")
    };
    let checks = vec![
        within("mean", mean.abs(), mean_error),
        within("sd", (sd - 1.0).abs(), sd_error),
    ];
    if is_judged && scenes.len() >= MIN_SCENES {
        Row::new(cells, checks)
    } else {
        cells.push(String::new());
        Row::new(cells, Vec::new())
    }
}

/// A section of the report with a table of the largest pulls. For each pull, the table
/// names the scene, the plane and the parameter.
fn largest(pulls: &[Pull]) -> ReportSection {
    let mut sorted: Vec<&Pull> = pulls.iter().collect();
    sorted.sort_by(|a, b| b.value.abs().total_cmp(&a.value.abs()));
    let row = |pull: &&Pull| {
        let cells = vec![
            pull.scene.to_string(),
            pull.plane.clone(),
            pull.kind.to_owned(),
            pull.parameter.clone(),
            format!("{:+.2}", pull.value),
        ];
        Row::new(cells, Vec::new())
    };
    ReportSection::new(
        "The largest pulls",
        "This table has no requirements of its own.",
        "scene | plane | kind | parameter | pull",
        sorted.iter().take(LISTED).map(row),
    )
}

/// The section that compares the cost of predictions with the cost of tracing photons.
fn cost(costs: &[Cost]) -> ReportSection {
    let ratio = |cost: &Cost| cost.predicted / cost.traced.max(0.01);
    let mut sorted: Vec<&Cost> = costs.iter().collect();
    sorted.sort_by(|a, b| ratio(b).total_cmp(&ratio(a)));
    let row = |name: String, cost: &&Cost| {
        let cells = vec![
            name,
            cost.scene.to_string(),
            format!("{:.2}", cost.traced),
            format!("{:.2}", cost.predicted),
            format!("{:.1}", ratio(cost)),
            cost.slowest.clone(),
        ];
        Row::new(cells, Vec::new())
    };
    let worst = sorted.iter().take(LISTED);
    let mut rows: Vec<Row> = worst.map(|cost| row("worst".into(), cost)).collect();
    rows.extend(
        sorted
            .get(sorted.len() / 2)
            .map(|cost| row("median".into(), cost)),
    );
    let slow = |cost: &&Cost| cost.predicted > MAX_SECONDS.max(cost.traced);
    let count = costs.iter().filter(slow).count();
    let [mean, _] = mean(&costs.iter().map(ratio).collect::<Vec<_>>());
    ReportSection::new(
        "The cost of predictions",
        format!(
            "The CPU seconds of all predictions of a scene are compared with the CPU seconds of \
             its photons; the mean ratio is {mean:.2}. Required: no scene has predictions that \
             take more than {MAX_SECONDS} s and longer than its photons."
        ),
        "| scene | photons | predictions | ratio | slowest plane",
        rows,
    )
    .with_checks(vec![Check::none("slow", count)])
}
