//! Runs a sweep. The missing points are run first, and then the table and the curves are written.

use crate::sweep::differences::PointDifferences;
use crate::sweep::pictures;
use crate::sweep::points::{SweepPoints, files};
use crate::sweep::quiet_reporter::Unshown;
use crate::sweep::request::SweepRequest;
use crate::sweep::table::{self, BANDWIDTHS, PointResult, SLOPE};
use crate::sweep::values::{Sweep, SweepPoint, short, shown};
use etendue_field::{decimals, fixed, tidy, uncertain};
use etendue_pipeline::{Leader, Reporter, Run, Task, Work, load};
use etendue_report::pictures::PictureFiles;
use etendue_scene::{Scene, SceneFile, read_file};
use etendue_store::sealed::json;
use etendue_store::stored::{check_earlier, summary_of};
use etendue_store::{
    Failure, MAX_INDEX_BYTES, Plan, Results, SUMMARY, SWEEP, VERSION, below, unfinished,
};
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The file name of the table.
const TABLE: &str = "sweep.csv";
/// The file name of the differences of neighbouring points, if points have one seed.
const DIFFERENCES: &str = "differences.csv";

/// A finished sweep.
#[derive(Debug)]
pub struct FinishedSweep {
    /// The results folder.
    pub folder: PathBuf,
    /// The table for a terminal: a header, and a row for each plane at each point.
    pub rows: Vec<Vec<String>>,
    /// Whether there are curves; curves are omitted if they would have more than 24 panels.
    pub has_curves: bool,
    /// The numbers of points that pass, fail, and are undecided.
    pub verdicts: [usize; 3],
    /// The reasons why planes are undecided, each with its point and plane.
    pub undecided: Vec<String>,
}

/// A sweep whose points are stored, before the table and the pictures are written.
#[derive(Debug)]
pub(crate) struct TracedSweep<'a> {
    request: &'a SweepRequest,
    points: &'a SweepPoints,
    folder: &'a Path,
    pub(crate) found: Vec<PointResult>,
    results: Results,
}

/// Runs the missing points, and writes the table and the pictures. Each point is stored in
/// `folder`.
pub fn run(
    request: &SweepRequest,
    all: &SweepPoints,
    folder: &Path,
    workers: Option<&Leader<'_>>,
    reporter: &dyn Reporter,
) -> Result<FinishedSweep, Failure> {
    let traced = begin(request, all, folder, &[], workers, reporter)?;
    traced.finish(Vec::new(), reporter)
}

/// Runs the missing points, each stored in `folder`; `names` are those of further files.
pub(crate) fn begin<'a>(
    request: &'a SweepRequest,
    all: &'a SweepPoints,
    folder: &'a Path,
    names: &[String],
    workers: Option<&Leader<'_>>,
    reporter: &dyn Reporter,
) -> Result<TracedSweep<'a>, Failure> {
    let checked =
        |scene: &Scene| Run::of(scene.clone(), request.method, Vec::new())?.check_limits();
    all.scenes.iter().try_for_each(checked)?;
    let SweepPoints { base, sweeps, .. } = all;
    let arguments = request.scene.arguments;
    check_earlier(folder, SWEEP, base, request.force, arguments)?;
    check_fields(request, folder, sweeps)?;
    let inputs = load::inputs(&all.source, base);
    // The folder is claimed and released before the work, and claimed again for the table. Each
    // point claims its own folder.
    drop(Results::claim(folder, plan(request, &inputs))?);
    unfinished::keeps(
        "interrupted: finished points are kept; the same command continues from them",
    );
    let found = run_all(request, folder, &inputs, all, workers, reporter)?;
    let mut plan = plan(request, &inputs);
    plan.files.extend_from_slice(names);
    Ok(TracedSweep {
        request,
        points: all,
        folder,
        found,
        results: Results::claim(folder, plan)?,
    })
}

/// Fails if the folder already holds a sweep of other fields.
fn check_fields(request: &SweepRequest, folder: &Path, sweeps: &[Sweep]) -> Result<(), Failure> {
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
    if request.force || now == earlier {
        return Ok(());
    }
    let earlier: Vec<&str> = earlier.into_iter().collect();
    Err(Failure::cannot_run(format!(
        "{} holds a sweep of {}: {}, or replace it with {}",
        folder.display(),
        earlier.join(", "),
        request.scene.arguments.another_folder(),
        request.scene.arguments.force()
    )))
}

fn plan(request: &SweepRequest, inputs: &[PathBuf]) -> Plan {
    let pictures = pictures::NAMES
        .iter()
        .flat_map(|name| ["png", "svg", "csv"].map(|end| format!("{name}.{end}")));
    Plan {
        index: SWEEP,
        files: pictures
            .chain([TABLE.to_owned()])
            .chain(request.common_seed.then(|| DIFFERENCES.to_owned()))
            .collect(),
        inputs: inputs.to_vec(),
        force: request.force,
        arguments: request.scene.arguments,
    }
}

/// The result of each point, from this command or an earlier one.
fn run_all(
    request: &SweepRequest,
    folder: &Path,
    inputs: &[PathBuf],
    all: &SweepPoints,
    workers: Option<&Leader<'_>>,
    reporter: &dyn Reporter,
) -> Result<Vec<PointResult>, Failure> {
    let bar = reporter.begin(Work::Steps {
        verb: "running",
        total: all.points.len(),
        things: "points",
    });
    let names = folders(request, folder, all)?;
    let earlier = |point: usize| {
        let there = folder.join(&names[point]);
        summary_of(&there, &all.scenes[point], request.method)
    };
    let claimed = |point: u32| {
        let plan = Plan {
            index: SUMMARY,
            files: all.names(point),
            ..plan(request, inputs)
        };
        Results::claim_below(folder, &names[point as usize], plan)
    };
    let kept = |results: Results, point: &[u8]| {
        bar.advance(1);
        kept(results, point)
    };
    let own = |point: u32| {
        bar.name(&shown(&all.points[point as usize]));
        let results = claimed(point)?;
        kept(results, &all.run(point, &Unshown(&*bar))?)
    };
    let mut summaries: Vec<Option<Value>> = (0..names.len()).map(earlier).collect();
    let is_missing = |point: &u32| summaries[*point as usize].is_none();
    let missing: Vec<u32> = (0..).take(names.len()).filter(is_missing).collect();
    bar.set((names.len() - missing.len()) as u64);
    let found: BTreeMap<u32, Value> = match workers {
        None => missing
            .iter()
            .map(|i| Ok((*i, own(*i)?)))
            .collect::<Result<_, Failure>>()?,
        Some(workers) => workers.pieces(
            Task::Points,
            &all.scenes,
            &missing,
            &own,
            &|point, bytes| kept(claimed(point)?, bytes),
        )?,
    };
    drop(bar);
    for (point, summary) in found {
        summaries[point as usize] = Some(summary);
    }
    let points = all.points.iter().zip(names).zip(summaries);
    points
        .map(|((point, folder), summary)| {
            Ok(PointResult {
                point: point.clone(),
                folder,
                summary: summary.ok_or_else(|| Failure::cannot_run("a point was not run"))?,
            })
        })
        .collect()
}

/// Writes the files of a point from the bytes of [`SweepPoints::run`]; returns its summary.
fn kept(mut results: Results, point: &[u8]) -> Result<Value, Failure> {
    let files = files(point)?;
    let (summary, others) = files
        .split_first()
        .ok_or_else(|| Failure::cannot_run("a point has no summary"))?;
    for (name, bytes) in others {
        results.write(name, bytes)?;
    }
    let mut summary: Value = serde_json::from_slice(summary.1).map_err(Failure::cannot_run)?;
    results.finish(|files| {
        summary["files"] = json!(files);
        json(&summary)
    })?;
    Ok(summary)
}

/// The folders of the points. The function checks that these folders are inside the folder
/// of the sweep.
fn folders(
    request: &SweepRequest,
    folder: &Path,
    all: &SweepPoints,
) -> Result<Vec<String>, Failure> {
    let name = |(scene, point): (&Scene, &SweepPoint)| {
        let name = format!("points/{}", name_of(scene, point, request));
        below(folder, &name).map(|_| name)
    };
    all.scenes.iter().zip(&all.points).map(name).collect()
}

/// The name of a point. It consists of the values of the point, and of a hash of its scene
/// and method.
fn name_of(scene: &Scene, point: &SweepPoint, request: &SweepRequest) -> String {
    /// Maximum length of the values in a name.
    const MAX_VALUES: usize = 48;
    let values = point
        .iter()
        .map(|(path, x)| format!("{}={}_", short(path), tidy(*x)));
    let mut name: String = values.collect();
    if name.len() > MAX_VALUES {
        name.clear();
    }
    let what = format!("{} {}", scene.hash(), request.method.words());
    name + &blake3::hash(what.as_bytes()).to_hex()[..16]
}

/// The content of `sweep.json`, except for the hashes of the files.
#[derive(Debug, Serialize)]
struct SweepIndex<'a> {
    scene: &'a str,
    version: &'a str,
    /// The scene without the swept fields.
    scene_file: &'a SceneFile,
    /// Whether the fields vary together, value by value.
    together: bool,
    sweeps: BTreeMap<&'a str, &'a [f64]>,
    /// Folders of the points, in the order of the table.
    points: Vec<&'a str>,
    files: &'a BTreeMap<String, String>,
}

impl TracedSweep<'_> {
    /// Writes the table, the pictures and further files.
    pub(crate) fn finish(
        self,
        files: Vec<(String, Vec<u8>)>,
        reporter: &dyn Reporter,
    ) -> Result<FinishedSweep, Failure> {
        let Self {
            request,
            points,
            folder,
            found,
            mut results,
        } = self;
        let SweepPoints { base, sweeps, .. } = points;
        for (name, bytes) in files {
            results.write(&name, &bytes)?;
        }
        let paths: Vec<String> = sweeps.iter().map(|sweep| sweep.path.clone()).collect();
        results.write(TABLE, &table::csv(&paths, &found)?)?;
        let differences = match request.common_seed {
            true => PointDifferences::read(folder, (&found, &points.scenes), request.together)?,
            false => PointDifferences::default(),
        };
        let stage = reporter.begin(Work::Stage("writing results"));
        let figures = pictures::drawn(&base.name, &found, request.together, &differences)?;
        if request.common_seed {
            results.write(DIFFERENCES, &differences.csv()?)?;
        }
        let has_curves = !figures.is_empty();
        for (name, figure) in pictures::NAMES.iter().zip(figures) {
            PictureFiles::new((*name).to_owned(), figure)?.write(&mut results)?;
        }
        let finished = results.finish(|files| {
            json(&SweepIndex {
                scene: &base.name,
                version: VERSION,
                scene_file: &base.file,
                together: request.together,
                sweeps: sweeps
                    .iter()
                    .map(|s| (s.path.as_str(), s.values.as_slice()))
                    .collect(),
                points: found.iter().map(|at| at.folder.as_str()).collect(),
                files,
            })
        })?;
        drop(stage);
        if let Some(message) = finished.replaced_message() {
            reporter.note(&message);
        }
        let count = |verdict: &str| {
            found
                .iter()
                .filter(|at| at.summary["verdict"] == verdict)
                .count()
        };
        Ok(FinishedSweep {
            folder: finished.folder,
            rows: rows(&paths, &found),
            has_curves,
            verdicts: ["pass", "fail", "undecided"].map(count),
            undecided: found.iter().flat_map(undecided).collect(),
        })
    }
}

/// The reasons why planes of a point are undecided.
fn undecided(at: &PointResult) -> Vec<String> {
    let reasons = at.planes().filter_map(|plane| {
        let [name, reason] = ["name", "undecided"].map(|key| plane[key].as_str());
        Some(format!("{}, {}: {}", at.folder, name?, reason?))
    });
    reasons.collect()
}

/// The table for the terminal: a row for each plane at each point.
fn rows(paths: &[String], found: &[PointResult]) -> Vec<Vec<String>> {
    let shown = [
        (BANDWIDTHS[0], "95 % bandwidth in ρ [cycles/m]"),
        (BANDWIDTHS[1], "95 % bandwidth in ν [cycles/slope]"),
        (SLOPE, "shear slope [m]"),
    ];
    let mut header = paths.to_vec();
    header.extend(["plane", "verdict", "p"].map(str::to_owned));
    header.extend(
        shown
            .iter()
            .flat_map(|(_, name)| [(*name).to_owned(), "predicted".to_owned()]),
    );
    let row = |at: &PointResult, plane: &Value| {
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
