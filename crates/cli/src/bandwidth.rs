//! Implements `etendue bandwidth`, which computes how densely a glossy reflection must be sampled.

use crate::args::BandwidthArgs;
use crate::print::{deliver, say};
use crate::progress;
use crate::progress::Terminal;
use crate::threads::on_threads;
use etendue_pipeline::{limits, load, method};
use etendue_predict::Applicability;
use etendue_report::table::{aligned, csv};
use etendue_scene::Scene;
use etendue_store::Failure;
use etendue_store::output::OutputFile;
use etendue_studies::sweep::values::{SweepPoint, points, shown};
use etendue_studies::sweep::{BandwidthRow, bandwidths, scene_at};
use std::path::PathBuf;

/// The scene at a point of the sweep, which must have one light.
fn one_light(args: &BandwidthArgs, point: &SweepPoint) -> Result<Scene, Failure> {
    let scene = scene_at(&args.scene.source(), point, |run| args.photons.set(run))?;
    limits::check_one_light(&scene, "this command").map(|()| scene)
}

/// Runs `etendue bandwidth`; returns the exit code.
pub(crate) fn bandwidth(args: &BandwidthArgs) -> Result<u8, Failure> {
    let points = points(&args.sweep, true)?;
    let at = |point: &SweepPoint| one_light(args, point);
    let scenes: Vec<Scene> = points.iter().map(at).collect::<Result<_, _>>()?;
    if args.measure {
        for scene in &scenes {
            let theories = Applicability::of_planes(scene);
            method::check(scene, args.photons.method)?;
            limits::check_work(scene, &theories)?;
        }
    }
    let inputs: Vec<_> = scenes
        .iter()
        .flat_map(|scene| load::inputs(&args.scene.source(), scene))
        .collect();
    let claim = |path: &PathBuf| OutputFile::claim(path, args.work.force.force, &inputs);
    let file = args.csv.as_ref().map(claim).transpose()?;
    let rows = on_threads(&args.work.threads, || measured_rows(args, &scenes, &points))?;
    if rows.is_empty() {
        return Err(Failure::bad_input(
            "no plane of this scene can be used; allowed: planes orthogonal to the central ray, for light that leaves a smooth surface with a BRDF",
        ));
    }
    let header = header(args);
    if let Some(file) = file {
        let digits = rows.iter().map(|row| cells(row, |x| format!("{x:?}"), ""));
        file.write(&csv(&header, digits)?)?;
    }
    let mut warnings: Vec<&String> = rows.iter().flat_map(|row| &row.warnings).collect();
    warnings.dedup();
    let cells = rows
        .iter()
        .map(|row| cells(row, |x| format!("{x:.3}"), "–"));
    let table: Vec<Vec<String>> = std::iter::once(header).chain(cells).collect();
    say(
        "A bandwidth is the frequency below which 95 % of the energy lies. The bandwidth of the lobe is in cycles per radian. All other bandwidths are at a fixed point of the plane, in cycles per unit slope.",
    );
    say(
        "B and B' are Eqs. 20 and 21 of Durand et al. 2005, corrected; the columns beside them use the equations as printed.\n",
    );
    deliver(&aligned(table).join("\n"))?;
    for warning in warnings {
        say(&format!("warning: {warning}"));
    }
    Ok(0)
}

/// The rows of all scenes; progress is shown scene by scene if there are several.
fn measured_rows(
    args: &BandwidthArgs,
    scenes: &[Scene],
    points: &[SweepPoint],
) -> Result<Vec<BandwidthRow>, Failure> {
    let measuring = args.measure.then_some(args.photons.method);
    let is_long = args.measure && scenes.len() > 1;
    let bar = progress::steps(
        "measuring",
        scenes.len(),
        "scenes",
        args.work.quiet || !is_long,
    );
    let each = scenes.iter().zip(points).map(|(scene, point)| {
        bar.set_message(shown(point));
        let terminal = Terminal::new(args.work.quiet || is_long);
        let rows = bandwidths(scene, point, measuring, &terminal);
        bar.inc(1);
        rows
    });
    let rows: Result<Vec<_>, Failure> = each.collect();
    bar.finish_and_clear();
    rows.map(|rows| rows.concat())
}

fn header(args: &BandwidthArgs) -> Vec<String> {
    let mut header: Vec<String> = args.sweep.iter().map(|sweep| sweep.path.clone()).collect();
    let numbers = [
        "plane",
        "k [1/m]",
        "θ0 [°]",
        "θ1 [°]",
        "d [m]",
        "d' [m]",
        "lobe",
        "B (Eq. 20)",
        "Eq. 20 as printed",
        "B' (Eq. 21)",
        "Eq. 21 as printed",
    ];
    header.extend(numbers.map(str::to_owned));
    if args.measure {
        header.extend(["exact", "measured", "error"].map(str::to_owned));
    }
    header
}

/// A row of the table; cells without a number have the text `none`.
fn cells(row: &BandwidthRow, shown: fn(f64) -> String, none: &str) -> Vec<String> {
    let mut cells: Vec<String> = row.point.iter().map(|x| shown(*x)).collect();
    cells.push(row.plane.clone());
    let numbers = row.numbers.iter();
    cells.extend(numbers.map(|x| x.map_or(none.to_owned(), shown)));
    cells
}
