//! Faults planted in the predictions, which the photons must reject.

use super::TableRun;
use super::bench::MirrorBench;
use super::errata::percent_or_dark;
use super::steps::Steps;
use crate::predicted;
use crate::report::Bound::{AtLeast, Below};
use crate::report::{Check, ReportSection, Row, word};
use etendue_compare::{FirstOrderReport, Residuals, Verdict};
use etendue_field::Specular;
use etendue_theory::geometry::{AffineMap, SpectrumMap};
use etendue_theory::path::Interaction;
use etendue_theory::{Model, Observed, Parameter};

type MirrorChange = fn(&mut Steps, &MirrorBench<'_>);

fn turned(map: &mut SpectrumMap<4>, row: usize) {
    map.matrix[row] = map.matrix[row].map(|x| -x);
}

/// Multiplies a scale of 1/cos by a squared cosine, so that the scale becomes cos.
fn cosine(map: &mut SpectrumMap<4>, at: usize, by: f64) {
    map.matrix[at] = map.matrix[at].map(|x| x * by);
}

fn faults() -> Vec<(&'static str, MirrorChange)> {
    vec![
        ("none", |_, _| ()),
        ("travel: wrong sign", |s, _| s.distance = -s.distance),
        ("incidence: wrong sign of x", |s, _| {
            turned(&mut s.incidence, 0);
        }),
        ("incidence: φ not flipped", |s, _| {
            turned(&mut s.incidence, 3);
        }),
        ("incidence: wrong sign of θ₀", |s, _| {
            s.incidence.phase[2] = -s.incidence.phase[2];
        }),
        ("curvature: wrong sign", |s, b| {
            s.curvature = AffineMap::<4>::back(b.shape, b.theta0).spectrum_map();
        }),
        ("back: wrong sign, so that the shears cancel", |s, b| {
            s.back = AffineMap::<4>::curvature(b.shape, -b.theta0).spectrum_map();
        }),
        ("mirror: θ not turned", |s, _| turned(&mut s.mirror, 2)),
        ("mirror: φ not turned", |s, _| turned(&mut s.mirror, 3)),
        ("outgoing: wrong sign of θ₁", |s, _| {
            s.outgoing.phase[2] = -s.outgoing.phase[2];
        }),
        ("incidence: cos instead of 1/cos beside x", |s, b| {
            cosine(&mut s.incidence, 0, b.theta0.cos().powi(2));
        }),
        ("incidence: cos instead of 1/cos in front", |s, b| {
            s.incidence.factor *= b.theta0.cos().powi(2);
        }),
        ("outgoing: 1/cos instead of cos beside x", |s, b| {
            cosine(&mut s.outgoing, 0, b.theta0.cos().powi(-2));
        }),
        ("outgoing: 1/cos instead of cos in front", |s, b| {
            s.outgoing.factor *= b.theta0.cos().powi(-2);
        }),
        ("mirror: times cos θ₀", |s, b| {
            s.mirror.factor *= b.theta0.cos();
        }),
        ("curvature: cos θ₀ in the row of θ", |s, b| {
            // Replaces diag(1, c₀) M by diag(c₀, 1) M.
            s.curvature = swapped(b, -1.0).spectrum_map();
            s.back = swapped(b, 1.0).spectrum_map();
        }),
        ("curvature: M without its cosine", |s, b| {
            s.curvature = AffineMap::<4>::curvature(b.shape, 0.0).spectrum_map();
            s.back = AffineMap::<4>::back(b.shape, 0.0).spectrum_map();
        }),
    ]
}

fn swapped(bench: &MirrorBench<'_>, sign: f64) -> AffineMap<4> {
    let k = sign * bench.shape[0][0];
    let mut map = AffineMap::<4>::identity();
    map.matrix[2][0] = k * bench.theta0.cos();
    map.matrix[3][1] = k;
    map
}

/// The section on faults of the affine maps, which are judged by the rule for first-order
/// chains.
pub(super) fn first_order(oblique: &TableRun, normal: &TableRun) -> ReportSection {
    let mut rows = Vec::new();
    for outcome in [oblique, normal] {
        let bench = MirrorBench::new(outcome);
        let straight = bench.theta0.abs() < 1e-6;
        for (name, fault) in faults() {
            if straight && (name.contains("cos") || name.contains('θ') && name.contains("sign")) {
                // At normal incidence these faults have no effect.
                continue;
            }
            let mut steps = bench.sound();
            fault(&mut steps, &bench);
            let touched = |i: &usize| {
                let place = &outcome.scene.planes[*i];
                name == "none" || steps.chain(place) != bench.sound().chain(place)
            };
            let planes = (0..outcome.planes.len()).filter(touched);
            let judged: Vec<_> = planes.map(|i| (i, bench.judged(i, &steps))).collect();
            let failed = judged.iter().filter(|(_, r)| r.verdict == Verdict::Fail);
            let count = failed.count();
            let accepted = judged.iter().all(|(_, r)| r.verdict == Verdict::Pass);
            let check = match name {
                "none" => Check::fact("accepted", accepted, "nothing is wrong"),
                _ => {
                    Check::new("rejected", count as f64, AtLeast(1.0)).because("a fault is planted")
                }
            };
            let defect = |(_, report): &&(usize, FirstOrderReport)| report.chain.defect;
            let decisive = judged.iter().max_by(|a, b| defect(a).total_cmp(&defect(b)));
            let of_decisive = |of: &dyn Fn(usize, &FirstOrderReport) -> String| {
                decisive.map_or("–".to_owned(), |(plane, report)| of(*plane, report))
            };
            let cells = vec![
                outcome.scene.name.clone(),
                name.to_owned(),
                of_decisive(&|plane, _| outcome.planes[plane].report.name.clone()),
                of_decisive(&|_, report| percent_or_dark(report)),
                of_decisive(&|_, report| format!("{:.1e}", report.chain.defect)),
                format!("{count} of {}", judged.len()),
                match name {
                    "none" if accepted => "accepted".to_owned(),
                    "none" => "not accepted".to_owned(),
                    _ => of_decisive(&|_, report| word(report.verdict).to_owned()),
                },
            ];
            rows.push(Row::new(cells, vec![check]));
        }
    }
    ReportSection::new(
        "Faults planted in the affine maps",
        "Each fault changes the affine maps of the chain. The chain is judged as in a run: it is \
         rejected when a part of its error above 10⁻⁵ remains as the neighbourhood of the central \
         ray shrinks. Each row names the plane on which the largest part remains, the excess of \
         this plane over the photons of the file, the part that remains, and how many of the \
         planes that the fault touches reject it. Required: the chain is rejected with every \
         fault, and accepted without a fault.",
        "scene | fault | plane | excess | error that remains | planes that reject it | run is",
        rows,
    )
}

type Tamper = fn(&Observed) -> Option<Observed>;

fn numbers() -> Vec<(&'static str, Tamper)> {
    fn scaled(view: &Observed, p: Parameter, by: f64) -> Option<Observed> {
        view.with(p, by * view.value(p)?)
    }
    fn turned(view: &Observed, degrees: f64) -> Option<Observed> {
        let p = Parameter::Incidence(0);
        view.with(p, view.value(p)? + degrees.to_radians())
    }
    vec![
        ("none", |v| Some(v.clone())),
        ("k + 2 %", |v| scaled(v, Parameter::Curvature(0, 0), 1.02)),
        ("k − 2 %", |v| scaled(v, Parameter::Curvature(0, 0), 0.98)),
        ("θ₀ + 1°", |v| turned(v, 1.0)),
        ("θ₀ − 1°", |v| turned(v, -1.0)),
        ("indices of the two sides swapped", |v| {
            let mut view = v.clone();
            let surface = &mut view.system.surfaces[0];
            let Interaction::Specular(Specular::Refraction { front, back }) =
                &mut surface.interaction
            else {
                return None;
            };
            std::mem::swap(front, back);
            Some(view)
        }),
        ("index + 2 %", |v| scaled(v, Parameter::Index(0), 1.02)),
    ]
}

/// The section on wrong numbers in the exact prediction, which the p-value must reject.
pub(super) fn exact(outcomes: &[&TableRun], level: f64) -> ReportSection {
    let mut rows = Vec::new();
    for outcome in outcomes {
        for (name, tamper) in numbers() {
            let p_value = |i: usize| {
                let view = outcome.system(i);
                if view.plane.is_arriving() {
                    return None;
                }
                let view = tamper(&view)?;
                let place = &outcome.scene.planes[i];
                let said = predicted::traced(&view, &place.window, &place.grid).slices;
                let error = outcome.planes[i].report.quadrature_error.unwrap_or(0.0);
                let residuals =
                    Residuals::new(&outcome.measurement, i, &said).within_error(&said, error);
                Some((residuals.p_value(outcome.scene.run.seed)?, i))
            };
            let found: Vec<(f64, usize)> = (0..outcome.planes.len()).filter_map(p_value).collect();
            let Some(&(least, at)) = found.iter().min_by(|a, b| a.0.total_cmp(&b.0)) else {
                continue;
            };
            let rejected = least < level;
            let check = match name {
                "none" => Check::p("accepted", Some(least), level),
                _ => Check::new("rejected", least, Below(level)).because("a number is wrong"),
            };
            let cells = vec![
                outcome.scene.name.clone(),
                name.to_owned(),
                outcome.planes[at].report.name.clone(),
                format!("{least:.5}"),
                format!(
                    "{} of {}",
                    found.iter().filter(|(p, _)| *p < level).count(),
                    found.len()
                ),
                if rejected { "rejected" } else { "accepted" }.to_owned(),
            ];
            rows.push(Row::new(cells, vec![check]));
        }
    }
    ReportSection::new(
        "Wrong numbers in the exact prediction",
        format!(
            "Each fault is a wrong number in the exact prediction. The prediction is judged by the \
             smallest p of the planes after the surface, with the photons of the file: it is \
             rejected if this p is below {level:.6}. Here p counts only what is beyond the stated \
             error of the prediction, and the smallest possible p is 0.00005. Required: the \
             prediction is rejected with every wrong number, and accepted without one."
        ),
        "scene | fault | plane | smallest p | planes that reject it | run is",
        rows,
    )
}
