//! `etendue bandwidth`: how finely a glossy reflection must be sampled.

use crate::args::BandwidthArgs;
use crate::print::{deliver, say};
use crate::progress;
use crate::progress::Terminal;
use crate::threads::on_threads;
use etendue_compare::{Applicability, Theory, criterion, exact_bandwidth, measured_bandwidth};
use etendue_field::{Term, VirtualPlane};
use etendue_pipeline::measured;
use etendue_pipeline::table::aligned;
use etendue_pipeline::{limits, load, method};
use etendue_scene::Scene;
use etendue_store::Failure;
use etendue_store::output::OutputFile;
use etendue_sweep::scene_at;
use etendue_sweep::values::{SweepPoint, message_at, points, shown};
use etendue_theory::shading::Criterion;
use std::path::PathBuf;

/// `etendue bandwidth`: returns the exit code.
pub(crate) fn bandwidth(args: &BandwidthArgs) -> Result<u8, Failure> {
    let points = points(&args.sweep, true)?;
    let at = |point| scene_at(&args.scene.source(), point, |run| args.photons.set(run));
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
    let csv = args.csv.as_ref().map(claim).transpose()?;
    let rows = on_threads(&args.work.threads, || {
        let is_long = args.measure && scenes.len() > 1;
        let bar = progress::steps(
            "measuring",
            scenes.len(),
            "scenes",
            args.work.quiet || !is_long,
        );
        let each = scenes.iter().zip(&points).map(|(scene, point)| {
            bar.set_message(shown(point));
            let rows = of(args, scene, point, args.work.quiet || is_long);
            bar.inc(1);
            rows
        });
        let rows: Result<Vec<_>, Failure> = each.collect();
        bar.finish_and_clear();
        rows.map(|rows| rows.concat())
    })?;
    if rows.is_empty() {
        return Err(Failure::bad_input(
            "no plane of this scene is orthogonal to its ray and sees light that leaves a smooth surface with a BRDF",
        ));
    }
    let header = header(args);
    if let Some(file) = csv {
        file.write(&csv_of(&header, &rows)?)?;
    }
    let mut warnings: Vec<&String> = rows.iter().flat_map(|row| &row.warnings).collect();
    warnings.dedup();
    let cells = rows.iter().map(BandwidthRow::cells);
    let table: Vec<Vec<String>> = std::iter::once(header).chain(cells).collect();
    say(
        "A bandwidth is the frequency below which 95 % of the energy lies: in cycles per radian for the lobe, and otherwise in cycles per unit slope at a fixed point of the plane.",
    );
    say(
        "B, B': Durand et al. 2005, Eqs. 20 and 21, corrected; the columns beside them use the equations as printed.\n",
    );
    deliver(&aligned(table).join("\n"))?;
    for warning in warnings {
        say(&format!("warning: {warning}"));
    }
    Ok(0)
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

/// The numbers of one plane at one point of the sweep.
#[derive(Clone, Debug)]
struct BandwidthRow {
    /// The values swept.
    point: Vec<f64>,
    plane: String,
    /// Returns the numbers in the order of the header; `None` stands for a missing number.
    numbers: Vec<Option<f64>>,
    warnings: Vec<String>,
}

impl BandwidthRow {
    fn cells(&self) -> Vec<String> {
        let mut cells: Vec<String> = self.point.iter().map(|x| number(*x)).collect();
        cells.push(self.plane.clone());
        let numbers = self.numbers.iter();
        cells.extend(numbers.map(|x| x.map_or("–".to_owned(), number)));
        cells
    }

    /// Returns the row with all digits; fields without a number are empty.
    fn record(&self) -> Vec<String> {
        let digits = |x: &f64| format!("{x:?}");
        let mut cells: Vec<String> = self.point.iter().map(digits).collect();
        cells.push(self.plane.clone());
        let numbers = self.numbers.iter();
        cells.extend(numbers.map(|x| x.as_ref().map_or(String::new(), digits)));
        cells
    }
}

/// The table as CSV.
fn csv_of(header: &[String], rows: &[BandwidthRow]) -> Result<Vec<u8>, Failure> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let lines = rows.iter().map(BandwidthRow::record);
    for line in std::iter::once(header.to_vec()).chain(lines) {
        writer.write_record(line).map_err(Failure::cannot_run)?;
    }
    writer.into_inner().map_err(Failure::cannot_run)
}

/// Returns a row for each plane with a criterion.
fn of(
    args: &BandwidthArgs,
    scene: &Scene,
    point: &SweepPoint,
    quiet: bool,
) -> Result<Vec<BandwidthRow>, Failure> {
    let theories = Applicability::of_planes(scene);
    let all = scene.planes.iter().zip(&theories).enumerate();
    let planes: Vec<(usize, Criterion)> = all
        .filter_map(|(i, (plane, theory))| Some((i, criterion(scene, plane, theory)?)))
        .collect();
    let measurement = if args.measure && !planes.is_empty() {
        let batches = 0..scene.run.batches;
        Some(measured(
            scene,
            args.photons.method,
            batches,
            &Terminal::new(quiet),
        )?)
    } else {
        None
    };
    let row = |(i, c): (usize, Criterion)| {
        let (plane, theory) = (&scene.planes[i], &theories[i]);
        let edge = |value: f64| c.blocker_distance.map(|_| value);
        let mut row = BandwidthRow {
            point: point.iter().map(|(_, value)| *value).collect(),
            plane: plane.name.clone(),
            numbers: vec![
                Some(c.curvature),
                Some(c.incidence.to_degrees()),
                Some(c.outgoing.to_degrees()),
                Some(c.distance),
                c.blocker_distance,
                Some(c.lobe_cutoff),
                Some(c.environment()),
                Some(c.printed_environment()),
                edge(c.blocker()),
                edge(c.printed_blocker()),
            ],
            warnings: beyond_criteria(plane, theory),
        };
        if let Some(measurement) = &measurement {
            let stage = progress::stage("predicting", quiet);
            let exact = exact_bandwidth(scene, plane, theory);
            stage.finish_and_clear();
            let found = measured_bandwidth(measurement, i).map_err(Failure::cannot_run)?;
            let (value, error) = (found.map(|f| f.value), found.map(|f| f.error));
            row.numbers.extend([exact, value, error]);
            let most = exact.into_iter().chain(value).fold(0.0, f64::max);
            row.warnings
                .extend(warning(plane, most).map(|text| message_at(point, text)));
        }
        Ok(row)
    };
    planes.into_iter().map(row).collect()
}

/// Returns warnings about effects that the criteria do not cover.
fn beyond_criteria(plane: &VirtualPlane, applicability: &Applicability) -> Vec<String> {
    let Theory::Scattering(view) = &applicability.theory else {
        return Vec::new();
    };
    let (name, reflectance) = (&view.system.name, &view.system.reflectance);
    let mut warnings = Vec::new();
    if !reflectance.is_uniform() {
        warnings.push(format!(
            "{}: the BRDF of {name} varies over the surface; the criteria use its sharpest lobe only",
            plane.name
        ));
    }
    let is_about_normal = |term: &Term| !term.brdf.lobe.is_about_mirror();
    if reflectance.terms.iter().any(is_about_normal) {
        warnings.push(format!(
            "{}: a lobe of {name} is centred on the normal; the criteria assume lobes about the mirror direction",
            plane.name
        ));
    }
    warnings
}

/// Returns a warning if a bandwidth is at the end of the frequency grid, because the grid then
/// limits it. The bandwidth of a spectrum that is flat over the grid is 95 % of the frequency at
/// which the last cell ends, half a step beyond the largest frequency.
fn warning(plane: &VirtualPlane, bandwidth: f64) -> Option<String> {
    const NEAR: f64 = 0.9;
    let nu = plane.grid.nu;
    let end = (NEAR * nu.max()).min(nu.max() - nu.spacing);
    (bandwidth >= end).then(|| {
        format!(
            "{}: a bandwidth of {} is at the end of the frequency range, and the spectrum may extend beyond it; frequencies.nu.max is {}",
            plane.name,
            number(bandwidth),
            nu.max()
        )
    })
}

fn number(x: f64) -> String {
    format!("{x:.3}")
}
