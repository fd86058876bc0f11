//! Tests the paper's misprints, one at a time, together with the corrected formulas.

use super::TableRun;
use super::bench::MirrorBench;
use super::steps::Steps;
use crate::report::Bound::{AtLeast, Below};
use crate::report::{Check, ReportSection, Row, number, percent, word};
use etendue_compare::{FirstOrderReport, Verdict};
use etendue_theory::geometry::{AffineMap, Edition, Matrix};
use std::f64::consts::TAU;

/// Maximum permitted difference between a chain composed of single steps and the chain derived
/// from the scene.
const SAME: f64 = 1e-8;

/// A function that modifies the steps of a mirror, given θ₀ and the shape operator.
type StepMisprint = Box<dyn Fn(&mut Steps, f64, Matrix<2>)>;

fn all() -> Vec<(&'static str, &'static str, StepMisprint)> {
    let of = |print: Edition, which: fn(&mut Steps, Steps)| -> StepMisprint {
        Box::new(move |steps, theta0, shape| {
            let printed = Steps {
                incidence: print.incidence_4d(theta0),
                curvature: print.curvature_4d(shape, theta0),
                back: print.back_4d(shape, -theta0),
                outgoing: print.outgoing_4d(-theta0),
                ..steps.clone()
            };
            which(steps, printed);
        })
    };
    let cosine = |cosine: fn(f64) -> f64, sign: f64| -> StepMisprint {
        Box::new(move |steps, theta0, shape| {
            // With longitude 0, the shear has no cosines and equals M. The sign of this shear is
            // correct if `sign` is 1.
            let (longitude, shape) = (cosine(theta0), shape.map(|r| r.map(|m| sign * m)));
            steps.curvature = AffineMap::<4>::curvature(shape, longitude).spectrum_map();
            steps.back = AffineMap::<4>::back(shape, longitude).spectrum_map();
        })
    };
    vec![
        (
            "Eq. 9 as printed",
            "incidence",
            of(Edition::Equations, |s, p| s.incidence = p.incidence),
        ),
        (
            "Eq. 9, scale: ℓ̂(−c₀ Ωx) instead of ℓ̂(−Ωx/c₀)",
            "incidence",
            Box::new(|s, theta0, _| {
                let (c, row) = (theta0.cos(), &mut s.incidence.matrix[0]);
                row[0] *= c * c;
            }),
        ),
        (
            "Eq. 9, factor: c₀ instead of 1/c₀",
            "incidence",
            Box::new(|s, theta0, _| s.incidence.factor *= theta0.cos().powi(2)),
        ),
        (
            "Eq. 9, phase: without 2π",
            "incidence",
            Box::new(|s, _, _| s.incidence.phase = s.incidence.phase.map(|t| t / TAU)),
        ),
        (
            "Table 1, incidence",
            "incidence",
            of(Edition::Table, |s, p| s.incidence = p.incidence),
        ),
        (
            "Eq. 10 as printed",
            "outgoing",
            of(Edition::Equations, |s, p| s.outgoing = p.outgoing),
        ),
        (
            "Eq. 10, scale: ℓ̂(Ωx/c₁) instead of ℓ̂(c₁ Ωx)",
            "outgoing",
            Box::new(|s, theta0, _| s.outgoing.matrix[0][0] /= theta0.cos().powi(2)),
        ),
        (
            "Eq. 10, phase: without 2π",
            "outgoing",
            Box::new(|s, _, _| s.outgoing.phase = s.outgoing.phase.map(|t| t / TAU)),
        ),
        (
            "Table 1, outgoing",
            "outgoing",
            of(Edition::Table, |s, p| s.outgoing = p.outgoing),
        ),
        (
            "Eq. 11, wrong sign",
            "curvature",
            cosine(|theta0| theta0, -1.0),
        ),
        (
            "Eq. 19, M without cosine, before",
            "curvature",
            cosine(|_| 0.0, 1.0),
        ),
        (
            "Eq. 19, M without cosine, after",
            "outgoing",
            cosine(|_| 0.0, 1.0),
        ),
        (
            "Eqs. 9, 11, 10, 19 as printed",
            "outgoing",
            of(Edition::Equations, |s, p| *s = p),
        ),
        (
            "Table 1 as printed",
            "outgoing",
            of(Edition::Table, |s, p| *s = p),
        ),
    ]
}

/// One table row for each single misprint. All misprints are tested on a hollow sphere.
/// Misprints that concern plane mirrors are also tested on a plane mirror.
fn rows(outcome: &TableRun) -> Vec<Row> {
    let bench = MirrorBench::new(outcome);
    let mut rows = Vec::new();
    let flat = bench.shape[0][0] == 0.0;
    for (name, plane, misprint) in all() {
        if flat && (plane == "curvature" || name.contains("19")) {
            continue;
        }
        let index = outcome.plane(plane);
        let Some(sound) = &outcome.planes[index].report.first_order else {
            continue;
        };
        let mut steps = bench.sound();
        misprint(&mut steps, bench.theta0, bench.shape);
        let printed = bench.judged(index, &steps);
        // On a plane mirror the two scales of Table 1 cancel each other, and so do the two phases
        // (docs/theory.md, section 7).
        let hidden = flat && name == "Table 1 as printed";
        let due = if hidden { Verdict::Pass } else { Verdict::Fail };
        let is_due = printed.verdict == due;
        let is_sound = sound.verdict == Verdict::Pass;
        let checks = vec![
            Check::fact(
                "printed",
                is_due,
                "the formula is wrong, unless its errors cancel",
            ),
            Check::fact("corrected", is_sound, "it is right"),
            Check::new("chain", bench.apart(index), Below(SAME)).because("rounding"),
        ];
        let cells = vec![
            outcome.scene.name.clone(),
            plane.to_owned(),
            name.to_owned(),
            percent_or_dark(&printed),
            number(printed.p_value),
            word(printed.verdict).to_owned(),
            percent(sound.excess),
            percent(sound.excess_bound),
            percent(Some(sound.chain.error)),
            word(sound.verdict).to_owned(),
        ];
        rows.push(Row::new(cells, checks));
    }
    rows
}

/// The section on the misprints, tested on the hollow mirror and on the plane mirror.
pub(super) fn misprints(sphere: &TableRun, flat: &TableRun) -> ReportSection {
    ReportSection::new(
        "Errata: each misprint alone",
        "In each row, one step of the chain is as the paper prints it, and all other steps are \
         correct. This printed chain and the corrected chain are compared with the photons of the \
         file, by the rule for first-order chains. *Excess* is the disagreement with the photons \
         beyond noise, relative to the prediction. Where a missing 2π moves all light out of the \
         window, no light is predicted. Required: the printed chain is rejected, except for all of \
         Table 1 on a plane mirror, where its errors cancel. The corrected chain is accepted, and \
         it equals the chain that theory derives from the scene.",
        "scene | plane | misprint | printed: excess | printed: p | the printed chain is | \
         corrected: excess | corrected: bound | corrected: error | the corrected chain is",
        [sphere, flat].into_iter().flat_map(rows),
    )
}

/// The section on scene files that request the printed formulas. Such scenes must disagree,
/// as `--expect disagreement` requires.
pub(super) fn as_printed(outcomes: &[&TableRun], level: f64) -> ReportSection {
    let mut rows = Vec::new();
    let mut checks = Vec::new();
    for outcome in outcomes {
        let mut rejected = 0.0;
        for plane in &outcome.planes {
            let report = &plane.report;
            let Some(first) = &report.first_order else {
                continue;
            };
            rejected += f64::from(first.verdict == Verdict::Fail);
            let cells = vec![
                outcome.scene.name.clone(),
                report.name.clone(),
                number(report.p_value),
                percent_or_dark(first),
                number(first.p_value),
                word(first.verdict).to_owned(),
            ];
            rows.push(Row::new(cells, vec![Check::exact(report, level)]));
        }
        let reason = "some plane of each scene shows the misprint";
        checks.push(Check::new("rejected", rejected, AtLeast(1.0)).because(reason));
    }
    ReportSection::new(
        "Scenes predicted as printed",
        format!(
            "The files of these scenes ask for the printed formulas, and `etendue run --expect \
             disagreement` makes these comparisons. Required: the first-order chain is rejected on \
             some plane of each scene. The exact prediction is rejected on no plane (p ≥ \
             {level:.6}, unless its stated error may explain the whole difference)."
        ),
        "scene | plane | p exact | printed: excess | printed: p | the printed chain is",
        rows,
    )
    .with_checks(checks)
}

pub(super) fn percent_or_dark(report: &FirstOrderReport) -> String {
    let shown = report.excess.filter(|e| e.is_finite() && *e < 1e3);
    shown.map_or("no light predicted".to_owned(), |e| percent(Some(e)))
}
