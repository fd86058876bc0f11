//! χ², p and the noise floor as the photons grow.

use crate::report::Bound::Below;
use crate::report::{Check, EXACT, Row, Section};
use crate::rows::Line;
use crate::scenes::{fig9b, predicted, receiver, traced};
use etendue_compare::{PlaneReport, Test, Verdict, compare};
use etendue_scene::Scene;

/// Every plane at one number of photons.
pub(crate) fn planes(photons: u64, seed: u64) -> Section {
    let scene = fig9b(photons, seed);
    let row = |report: &PlaneReport| {
        let line = match report.name.as_str() {
            "before_blockers" => Some(Line::Travel),
            "after_blockers" | "receiver" => Some(Line::Visibility),
            _ => None,
        };
        row(&scene, report).of(line)
    };
    Section {
        title: format!("Every plane at {:.0e} photons", photons as f64),
        text: "Required: p at least α = 1 % after Šidák over the planes.".to_owned(),
        header: HEADER.to_vec(),
        rows: reports(&scene).iter().map(row).collect(),
        checks: Vec::new(),
    }
}

/// The score tests of every plane at one number of photons.
pub(crate) fn parameters(photons: u64, seed: u64) -> Section {
    let reports = reports(&fig9b(photons, seed));
    let mut rows = Vec::new();
    // Two-sided 1 % for the largest of ten normal numbers, Šidák: level 0.1 %, quantile 3.29.
    let bound = 3.29;
    for plane in &reports {
        for p in &plane.parameters {
            let off = (p.measured - p.scene) / p.error;
            let cells = vec![
                plane.name.clone(),
                p.name.clone(),
                p.scene.to_string(),
                format!("{:.7}", p.measured),
                format!("{:.7}", p.error),
                format!("{off:+.2}"),
                format!("{:.4} %", 100.0 * p.detectable / p.scene),
            ];
            let reason = "1 % for the largest of ten normal numbers";
            let check = Check::new("off by", off.abs(), Below(bound), reason);
            rows.push(Row::new(cells, vec![check]));
        }
    }
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
        rows,
        checks: Vec::new(),
    }
}

/// The receiver plane at growing numbers of photons.
pub(crate) fn floor(photons: &[u64], seed: u64) -> Section {
    let mut rows: Vec<Row> = Vec::new();
    let mut before = None;
    for n in photons {
        let scene = receiver(*n, seed);
        for report in reports(&scene) {
            let mut row = row(&scene, &report);
            let floor = report.noise_floor_db.unwrap_or(f64::NAN);
            if let Some((fewer, higher)) = before.replace((*n, floor)) {
                let expected = 10.0 * (*n as f64 / fewer as f64).log10();
                let off = (higher - floor - expected).abs();
                // 64 batches at about 1000 uncorrelated frequencies tell a mean σ² to 0.4 %, 0.017 dB.
                let reason = "four of the errors of a difference, dB";
                row.checks.push(Check::new("fall", off, Below(0.1), reason));
            }
            rows.push(row);
        }
    }
    Section {
        title: "Noise floor of the receiver plane".to_owned(),
        text:
            "Required: p at least α = 1 %, and a floor that falls 10 dB per decade within 0.1 dB."
                .to_owned(),
        header: HEADER.to_vec(),
        rows,
        checks: Vec::new(),
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
        Check::p(EXACT, report.p_value, Test::of(scene).level),
        Check::fact("verdict", passes, "as a run judges"),
    ];
    Row::new(cells, checks)
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
