//! Measures χ², p and the noise floor for increasing numbers of photons.

use crate::SEED;
use crate::report::Bound::Below;
use crate::report::{Check, ReportSection, Row};
use crate::scenes::{compared, fig9b, predicted, receiver, sampled, traced, words};
use etendue_compare::{PlaneReport, Verdict};
use etendue_field::tidy;
use etendue_predict::test_of;
use etendue_scene::{Sampling, Scene};
use etendue_spectrum::estimate;
use ndarray::Array3;

/// The section on every plane at one number of photons.
pub(crate) fn planes(photons: u64, seed: u64) -> ReportSection {
    let scene = fig9b(photons, seed);
    let row = |report: &PlaneReport| row(&scene, report);
    ReportSection::new(
        format!("Every plane at {:.0e} photons", photons as f64),
        "The measured spectrum of every plane is compared with its prediction. *Relative error* is \
         the difference of the two relative to the prediction, and *noise limit* is its value from \
         noise alone. *Noise floor* is the mean variance relative to the largest power. Required: \
         p is at least the level that α = 1 % gives for all planes together (after Šidák).",
        HEADER,
        reports(&scene).iter().map(row),
    )
}

/// The section on the score tests of every plane at one number of photons.
pub(crate) fn parameters(photons: u64, seed: u64) -> ReportSection {
    let reports = reports(&fig9b(photons, seed));
    let mut rows = Vec::new();
    // With a probability of 1 %, at least one of ten normal numbers exceeds 3.29 in magnitude
    // (Šidák: 0.1 % for each number).
    let bound = 3.29;
    for plane in &reports {
        for p in &plane.parameters {
            let off = (p.measured - p.scene) / p.error;
            let cells = vec![
                plane.name.clone(),
                p.name.clone(),
                tidy(p.scene),
                format!("{:.7}", p.measured),
                format!("{:.7}", p.error),
                format!("{off:+.2}"),
                format!("{:.4} %", 100.0 * p.detectable / p.scene.abs()),
            ];
            let reason = "1 % for the largest of ten normal numbers";
            let check = Check::new("off by", off.abs(), Below(bound)).because(reason);
            rows.push(Row::new(cells, vec![check]));
        }
    }
    ReportSection::new(
        format!("Parameters recovered at {:.0e} photons", photons as f64),
        format!(
            "Parameters of the scene are estimated from the photons of each plane. *Error* is the \
             standard error of the measured value, and *off by* is the difference from the scene \
             in units of this error. *Smallest detectable change* is the change that is detected \
             at level 1 % nine times in ten. Required: every parameter is within {bound} errors of \
             the value in the scene (the largest of {} is beyond this by chance in about 1 % of \
             all runs).",
            rows.len()
        ),
        "plane | parameter | scene | measured | error | off by (errors) | smallest detectable \
         change",
        rows,
    )
}

/// The noise of photons from nets or lattices divided by the noise of photons from random
/// numbers, over all frequencies of a plane.
pub(crate) fn gain(sampling: Sampling, photons: u64, batches: u32) -> ReportSection {
    let kind = words(sampling);
    let variances = |sampling: Sampling| {
        let mut scene = sampled(fig9b(photons, SEED), sampling);
        scene.run.batches = batches;
        let measured = traced(&scene);
        let of = |plane| {
            estimate::slices(&measured, plane)
                .expect("enough batches")
                .variance
        };
        let planes = scene.planes.iter().enumerate();
        let named = planes.map(|(i, plane)| (plane.name.clone(), of(i)));
        named.collect::<Vec<_>>()
    };
    let decibels = |ratio: f64| 10.0 * ratio.log10();
    let [found, random] = [sampling, Sampling::Random].map(variances);
    type Plane = (String, Array3<f64>);
    let row = |((name, found), (_, random)): (&Plane, &Plane)| {
        let mut cells: Vec<f64> = found
            .iter()
            .zip(random)
            .map(|(n, r)| decibels(n / r))
            .collect();
        cells.sort_by(f64::total_cmp);
        let at = |part: usize, of: usize| cells[part * (cells.len() - 1) / of];
        let total = decibels(found.sum() / random.sum());
        let worse = cells.iter().filter(|cell| **cell > 0.5).count() as f64 / cells.len() as f64;
        let mut row: Vec<String> = [total, at(1, 2), at(0, 1), at(99, 100), at(1, 1)]
            .map(|value| format!("{value:.2}"))
            .to_vec();
        row.insert(0, name.clone());
        row.push(format!("{:.2} %", 100.0 * worse));
        // With 1000 independent frequencies and 64 batches, the total noise is accurate to 0.03
        // dB.
        let check =
            Check::new("total", total, Below(-0.1)).because("three errors of this ratio, in dB");
        Row::new(row, vec![check])
    };
    ReportSection::new(
        format!("Noise of {kind}, {photons} photons in {batches} batches"),
        format!(
            "The variance σ² of the slices with photons from {kind} is compared with the variance \
             with photons from random numbers. All numbers except the last are ratios of the two \
             in dB, and a negative ratio means that {kind} have less noise. *Total* compares the \
             sums over all frequencies of a plane. The next four columns describe the ratios at \
             the single frequencies, and the last column is the share of frequencies with a ratio \
             above 0.5 dB. The ratio at one frequency has a standard error of {:.2} dB, so the \
             largest ratio says little with few batches. Required: the total with {kind} is \
             smaller by more than 0.1 dB.",
            10.0 / 10f64.ln() * (2.0 / f64::from(batches - 1)).sqrt()
        ),
        "plane | total | median | smallest | 99 % are below | largest | share above 0.5 dB",
        found.iter().zip(&random).map(row),
    )
}

/// The section on the noise at the receiver plane for increasing numbers of photons.
pub(crate) fn floor(photons: &[u64], seed: u64) -> ReportSection {
    let mut rows: Vec<Row> = Vec::new();
    let mut before = None;
    for n in photons {
        let mut floors = [f64::NAN; 2];
        for (floor, sampling) in floors.iter_mut().zip([Sampling::Random, Sampling::Lattice]) {
            let scene = sampled(receiver(*n, seed), sampling);
            let report = &reports(&scene)[0];
            let mut row = row(&scene, report);
            row.cells[1] = words(sampling).to_owned();
            *floor = report.noise_floor_db.unwrap_or(f64::NAN);
            rows.push(row);
        }
        let [random, lattice] = floors;
        let last = rows.len() - 1;
        // With 64 batches and about 1000 uncorrelated frequencies, a mean σ² is accurate to 0.4 %,
        // or 0.017 dB.
        let reason = "four errors of a difference, in dB";
        let off = lattice - random;
        rows[last]
            .checks
            .push(Check::new("lattice", off, Below(0.1)).because(reason));
        if let Some((fewer, higher)) = before.replace((*n, random)) {
            let expected = 10.0 * (*n as f64 / fewer as f64).log10();
            let off = (higher - random - expected).abs();
            let check = Check::new("fall", off, Below(0.1)).because(reason);
            rows[last - 1].checks.push(check);
        }
    }
    ReportSection::new(
        "Noise floor of the receiver plane",
        "Photons at the receiver plane are drawn from random numbers or from nets, in increasing \
         numbers, and their spectrum is compared with the prediction. Required: p is at least α = \
         1 %. The noise floor of random numbers falls by 10 dB per decade of photons, within 0.1 \
         dB. The noise floor of lattices is at most 0.1 dB above the floor of random numbers.",
        HEADER,
        rows,
    )
}

const HEADER: &str = "photons | plane or kind of numbers | photons in window | χ²/dof | p | relative \
    error | noise limit | noise floor (dB below peak)";

fn row(scene: &Scene, report: &PlaneReport) -> Row {
    let show = |value: Option<f64>, digits: usize| {
        value.map_or("–".to_owned(), |v| format!("{v:.digits$}"))
    };
    let cells = vec![
        format!("{:.0e}", scene.run.photons as f64),
        report.name.clone(),
        report.in_window.to_string(),
        show(report.chi2_per_dof, 4),
        show(report.p_value, 4),
        show(report.relative_error, 6),
        show(report.noise_limit, 6),
        show(report.noise_floor_db, 2),
    ];
    let passes = report.verdict == Verdict::Pass;
    let checks = vec![
        Check::exact(report, test_of(scene).level),
        Check::fact("verdict", passes, "judged as in a run"),
    ];
    Row::new(cells, checks)
}

/// Measures and compares all planes of a scene.
///
/// # Panics
/// Panics if the scene has too few batches. Every resolved scene has enough batches.
fn reports(scene: &Scene) -> Vec<PlaneReport> {
    let measurement = traced(scene);
    let level = test_of(scene).level;
    let predictions = predicted(scene, None);
    let planes = predictions.iter().enumerate();
    let report = |(i, prediction)| compared(scene, &measurement, i, prediction, level).report;
    planes.map(report).collect()
}
