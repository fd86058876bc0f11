//! χ², p and the noise floor as the photons grow.

use crate::report::Section;
use crate::scenes::{fig9b, predicted, receiver, traced};
use etendue_compare::{PlaneReport, Test, Verdict, compare};
use etendue_scene::Scene;

/// Every plane at one number of photons.
pub(crate) fn planes(photons: u64, seed: u64) -> Section {
    let reports = reports(&fig9b(photons, seed));
    Section {
        title: format!("Every plane at {:.0e} photons", photons as f64),
        text: "Required: p at least α = 1 % after Šidák over the planes.".to_owned(),
        header: HEADER.to_vec(),
        passed: reports.iter().all(passes),
        rows: reports.iter().map(|r| row(photons, r)).collect(),
    }
}

/// The score tests of every plane at one number of photons.
pub(crate) fn parameters(photons: u64, seed: u64) -> Section {
    let reports = reports(&fig9b(photons, seed));
    let mut rows = Vec::new();
    let mut worst: f64 = 0.0;
    for plane in &reports {
        for p in &plane.parameters {
            let off = (p.measured - p.scene) / p.error;
            worst = worst.max(off.abs());
            rows.push(vec![
                plane.name.clone(),
                p.name.clone(),
                p.scene.to_string(),
                format!("{:.7}", p.measured),
                format!("{:.7}", p.error),
                format!("{off:+.2}"),
                format!("{:.4} %", 100.0 * p.detectable / p.scene),
            ]);
        }
    }
    // Two-sided 1 % for the largest of ten normal numbers, Šidák: level 0.1 %, quantile 3.29.
    let bound = 3.29;
    Section {
        title: format!("Parameters recovered at {:.0e} photons", photons as f64),
        text: format!(
            "Required: every parameter within {bound} errors of the scene's (1 % for the largest of {}).",
            rows.len()
        ),
        header: vec![
            "plane",
            "parameter",
            "scene",
            "measured",
            "error",
            "off by (errors)",
            "smallest detectable change",
        ],
        passed: worst < bound,
        rows,
    }
}

/// The receiver plane at growing numbers of photons.
pub(crate) fn floor(photons: &[u64], seed: u64) -> Section {
    let reports: Vec<PlaneReport> = photons
        .iter()
        .flat_map(|n| reports(&receiver(*n, seed)))
        .collect();
    let falls = reports.windows(2).zip(photons.windows(2)).all(|(pair, n)| {
        let (Some(before), Some(after)) = (pair[0].noise_floor_db, pair[1].noise_floor_db) else {
            return false;
        };
        let expected = 10.0 * (n[1] as f64 / n[0] as f64).log10();
        // 64 batches at about 1000 uncorrelated frequencies tell a mean σ² to 0.4 %, 0.017 dB: four of the
        // errors of a difference.
        (before - after - expected).abs() < 0.1
    });
    Section {
        title: "Noise floor of the receiver plane".to_owned(),
        text:
            "Required: p at least α = 1 %, and a floor that falls 10 dB per decade within 0.1 dB."
                .to_owned(),
        header: HEADER.to_vec(),
        passed: falls && reports.iter().all(passes),
        rows: reports
            .iter()
            .zip(photons)
            .map(|(r, n)| row(*n, r))
            .collect(),
    }
}

const HEADER: [&str; 8] = [
    "photons",
    "plane",
    "in window",
    "χ²/dof",
    "p",
    "relative error",
    "noise limit",
    "noise floor (dB below peak)",
];

fn row(photons: u64, report: &PlaneReport) -> Vec<String> {
    let show = |value: Option<f64>, digits: usize| {
        value.map_or("–".to_owned(), |v| format!("{v:.digits$}"))
    };
    vec![
        format!("{:.0e}", photons as f64),
        report.name.clone(),
        report.in_window.to_string(),
        show(report.chi2_per_dof, 4),
        show(report.p_value, 4),
        show(report.relative_error, 6),
        show(report.noise_limit, 6),
        show(report.noise_floor_db, 2),
    ]
}

fn passes(report: &PlaneReport) -> bool {
    report.verdict == Verdict::Pass
}

/// All planes of a scene, measured and compared.
///
/// # Panics
/// When the scene has too few batches, which resolving excludes.
fn reports(scene: &Scene) -> Vec<PlaneReport> {
    let measurement = traced(scene);
    let test = Test::of(scene);
    predicted(scene, None)
        .iter()
        .enumerate()
        .map(|(i, prediction)| {
            compare(&measurement, i, prediction, &test)
                .expect("a resolved scene has enough batches")
                .report
        })
        .collect()
}
