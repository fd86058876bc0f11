use crate::args::{Expect, Save};
use crate::case::Case;
use crate::inquiry::inquire;
use crate::measure::measured;
use crate::predict::predicted;
use crate::report::explorer;
use crate::say_replaced;
use crate::summary::{Stopwatch, Summary};
use crate::{aimed, field, photons, pictures, progress, report, say, table, target};
use etendue_compare::{Applicability, PlaneComparison, PlaneReport, Test, Verdict, compare};
use etendue_field::VirtualPlane;
use etendue_scene::Scene;
use etendue_store::Failure;
use etendue_store::Method;
use etendue_store::arrays;
use etendue_store::{Finished, Plan, Results, SUMMARY, TIMING};
use std::path::PathBuf;

impl Case {
    /// Measures a scene and predicts it.
    pub(crate) fn of(
        scene: Scene,
        theories: Vec<Applicability>,
        method: Method,
        quiet: bool,
    ) -> Result<Self, Failure> {
        let measurement = measured(&scene, method, 0..scene.run.batches, quiet)?;
        let predictions = predicted(&scene, &theories, method, None, quiet)?;
        Ok(Self {
            scene,
            theories,
            method,
            measurement,
            predictions,
        })
    }
}

/// What the user wants beside the result.
#[derive(Debug)]
pub(crate) struct Ending<'a> {
    pub(crate) save: &'a [Save],
    pub(crate) expect: Option<Expect>,
    /// Without the files that pictures and arrays already say.
    pub(crate) compact: bool,
    pub(crate) quiet: bool,
}

/// Ends of names of files that a compact result does without: `report.html` has what is drawn, arrays have the numbers.
const NOT_COMPACT: &[&str] = &[".csv", ".svg"];

/// What a comparison of a scene writes.
pub(crate) fn plan(scene: &Scene, save: &[Save], inputs: Vec<PathBuf>, force: bool) -> Plan {
    let of_plane = |plane: &VirtualPlane| {
        let mut names = [arrays::NAMES.as_slice(), pictures::NAMES.as_slice()].concat();
        names.extend(save.iter().flat_map(|save| photons::names(*save)));
        if save.contains(&Save::Field) {
            names.extend(field::NAMES);
        }
        let names = names.into_iter();
        let names = names.map(|name| format!("{}/{name}", plane.name));
        names.collect::<Vec<_>>()
    };
    let beside = pictures::PATH_NAMES
        .into_iter()
        .chain([TIMING, report::NAME])
        .chain(explorer::fragment(&scene.file).map(|_| explorer::NAME));
    Plan {
        index: SUMMARY,
        files: scene
            .planes
            .iter()
            .flat_map(of_plane)
            .chain(beside.map(str::to_owned))
            .collect(),
        inputs,
        force,
    }
}

/// Compares, draws and writes the result; returns the exit code.
pub(crate) fn conclude(
    case: &Case,
    ending: &Ending<'_>,
    mut results: Results,
    mut watch: Stopwatch,
) -> Result<u8, Failure> {
    let fields = ending.save.contains(&Save::Field);
    let judged = Judged::of(case, fields.then_some(&mut results), ending.quiet)?;
    watch.lap("compare");
    let stage = progress::stage("writing results", ending.quiet);
    let seconds = watch.seconds("trace");
    let finished = written(case, ending, results, &judged, watch)?;
    stage.finish_and_clear();
    say_replaced(&finished, ending.quiet);
    let summary = judged.summary;
    if !ending.quiet {
        table::print(&summary, &finished.folder);
        if let Some(outlook) = seconds.and_then(|s| target::outlook(&summary.planes, s)) {
            say(&outlook);
        }
        let mut gone = finished.gone;
        gone.retain(|name| name.ends_with(".npy"));
        if !gone.is_empty() {
            let names = gone.join(", ");
            say(&format!(
                "removed with the earlier result, not saved again: {names}"
            ));
        }
    }
    Ok(exit_code(ending.expect, &summary))
}

/// What a case comes to.
#[derive(Debug)]
pub(crate) struct Judged {
    pub(crate) planes: Vec<PlaneComparison>,
    pub(crate) summary: Summary,
}

impl Judged {
    /// Compares all planes, and looks into those that fail. The light fields of the planes are compared too where they
    /// are saved to a result.
    pub(crate) fn of(
        case: &Case,
        fields: Option<&mut Results>,
        quiet: bool,
    ) -> Result<Self, Failure> {
        let stage = progress::stage("comparing", quiet);
        let tests = if fields.is_some() { field::TESTS } else { 1 };
        let mut planes = judged(case, &Test::each(&case.scene, tests))?;
        if let Some(results) = fields {
            stage.suspend(|| field::compare(Some(results), case, &mut planes, quiet))?;
        }
        let inquiries = stage.suspend(|| inquire(case, &planes, quiet))?;
        stage.finish_and_clear();
        let summary = Summary::new(case, &planes, inquiries);
        Ok(Self { planes, summary })
    }
}

/// What is expected is that photons agree with every exact prediction, and that a first-order chain
/// has a wrong map.
fn exit_code(expect: Option<Expect>, summary: &Summary) -> u8 {
    let is_wrong = |plane: &PlaneReport| {
        let chain = plane.first_order.as_ref();
        chain.is_some_and(|chain| chain.verdict == Verdict::Fail)
    };
    let verdict = match expect {
        None => summary.verdict,
        Some(Expect::Disagreement) => {
            let exact = summary.planes.iter().map(PlaneReport::exact_verdict);
            match exact.fold(Verdict::Pass, Verdict::and) {
                Verdict::Pass if !summary.planes.iter().any(is_wrong) => Verdict::Fail,
                verdict => verdict,
            }
        }
    };
    code_of(verdict)
}

/// The exit code that a verdict has.
pub(crate) fn code_of(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::Pass => 0,
        Verdict::Fail => 1,
        Verdict::Undecided => 4,
    }
}

/// Each plane compared, with its verdict.
pub(crate) fn judged(case: &Case, test: &Test) -> Result<Vec<PlaneComparison>, Failure> {
    let each = case.predictions.iter().enumerate();
    let compared = each.map(|(i, prediction)| {
        compare(&case.measurement, i, prediction, test).map_err(Failure::cannot_run)
    });
    let mut planes = compared.collect::<Result<Vec<_>, _>>()?;
    aimed::leave_open(case, &mut planes);
    Ok(planes)
}

/// Writes everything; the summary last.
pub(crate) fn written(
    case: &Case,
    ending: &Ending<'_>,
    mut results: Results,
    Judged { planes, summary }: &Judged,
    mut watch: Stopwatch,
) -> Result<Finished, Failure> {
    if ending.compact {
        results.leave_out(NOT_COMPACT);
    }
    let each = case.predictions.iter().zip(planes);
    for ((prediction, plane), at) in each.zip(&case.scene.planes) {
        arrays::write(&mut results, summary.made_from(), plane)?;
        pictures::plane(
            &mut results,
            &pictures::made_from(summary),
            prediction,
            at,
            plane,
        )?;
    }
    let path = pictures::path(&mut results, case, planes)?;
    let explorer = explorer::fragment(&summary.scene_file).filter(|_| !ending.compact);
    let data = report::data(case, summary, planes, (&path, explorer.as_deref()));
    results.write(
        report::NAME,
        report::page(&case.scene.name, &[(String::new(), data)]).as_bytes(),
    )?;
    if explorer.is_some() {
        results.write(explorer::NAME, explorer::PAGE)?;
    }
    for save in ending.save {
        photons::save(&mut results, case, *save)?;
    }
    watch.lap("write");
    results.write_unlisted(TIMING, &watch.json(summary.photons))?;
    results.finish(|files| summary.json(files))
}
