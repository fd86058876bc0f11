//! Compares photons with the prediction and with backward rays, for every scene of the repository.

use crate::report::Bound::{Above, AtLeast, AtMost, Below};
use crate::report::{Check, ReportSection, Row, percent};
use crate::scenes::{ComparedScene, SUITE, named};
use etendue_compare::{PlaneReport, TESTS, Verdict, sidak};
use etendue_field::Complex;
use etendue_scene::Scene;
use std::f64::consts::{FRAC_PI_2, TAU};

/// False rejection rate over all planes of the suite.
const ALPHA: f64 = 0.01;

/// Runs all scenes of the suite, each with `photons` photons. If `photons` is `None`, each scene
/// has the number of photons in its file.
pub(crate) fn suite(photons: Option<u64>) -> Vec<ReportSection> {
    let scenes: Vec<Scene> = SUITE
        .split(' ')
        .map(|name| named(name, photons, None))
        .collect();
    let planes: usize = scenes.iter().map(|scene| scene.planes.len()).sum();
    let level = sidak(ALPHA, TESTS * planes);
    let each = scenes.into_iter();
    let outcomes: Vec<_> = each.map(|scene| ComparedScene::new(scene, level)).collect();
    vec![
        table(&outcomes, planes, level),
        occluders(&outcomes),
        high_frequencies(&outcomes),
        furnace(&outcomes),
    ]
}

fn table(outcomes: &[ComparedScene], planes: usize, level: f64) -> ReportSection {
    let rows = outcomes.iter().flat_map(|outcome| {
        let planes = outcome.planes.iter().zip(&outcome.backward);
        planes.map(|(plane, p)| row(&outcome.scene, &plane.report, *p, level))
    });
    ReportSection::new(
        format!("The suite: {} scenes, {planes} planes", outcomes.len()),
        format!(
            "Every plane of every scene is measured with the photons and the seed of its file, and \
             compared with its prediction. *Class* is the kind of prediction, and *p backward* is \
             the p-value of the comparison of photons with backward rays. Required: every plane \
             passes in its class, and photons agree with backward rays wherever both exist. Both \
             are tested at α = {ALPHA} over all planes: p ≥ {level:.6}."
        ),
        "scene | plane | class | photons | in window | rel. error | noise | quadrature | χ²/dof | \
         p | p backward | verdict",
        rows,
    )
}

fn row(scene: &Scene, report: &PlaneReport, backward: Option<f64>, level: f64) -> Row {
    let number = |x: Option<f64>| x.map_or("–".to_owned(), |x| format!("{x:.4}"));
    let cells = vec![
        scene.name.clone(),
        report.name.clone(),
        report.class.to_string(),
        format!("{:.0e}", scene.run.photons as f64),
        report.in_window.to_string(),
        percent(report.relative_error),
        percent(report.noise_limit),
        percent(report.quadrature_error),
        number(report.chi2_per_dof),
        number(report.p_value),
        number(backward),
    ];
    let agrees = report.verdict != Verdict::Fail;
    let decided = report.verdict != Verdict::Undecided;
    let mut checks = vec![
        Check::fact("agrees", agrees, "judged as in a run"),
        Check::fact("decided", decided, "judged as in a run"),
    ];
    checks.extend(backward.map(|p| Check::p("backward", Some(p), level)));
    Row::new(cells, checks)
}

fn outcome<'a>(outcomes: &'a [ComparedScene], name: &str) -> Option<&'a ComparedScene> {
    outcomes.iter().find(|o| o.scene.name == name)
}

/// Checks two occluders that together block all light, although each of them blocks little light
/// (Durand et al. 2005, Fig. 7).
fn occluders(outcomes: &[ComparedScene]) -> ReportSection {
    let mut rows = Vec::new();
    let at = |name: &str| {
        outcome(outcomes, name)?
            .planes
            .iter()
            .find(|p| p.report.name == "receiver")
    };
    for (name, least, most) in [
        ("fig7_one", 1_000_000, f64::INFINITY),
        ("fig7_other", 1_000_000, f64::INFINITY),
        ("fig7_two", 0, 0.0),
    ] {
        let through = at(name).map_or(0, |plane| plane.report.crossed);
        // At least `least` photons must pass each single occluder. If a short suite traces too few
        // photons for this, a quarter of all photons must pass.
        let wanted = outcome(outcomes, name)
            .map_or(0, |o| o.scene.run.photons / 4)
            .min(least);
        let cells = vec![format!("{name}: photons through"), through.to_string()];
        let reason = "much light passes one occluder, and none passes both";
        let check = |bound| Check::new("through", through as f64, bound).because(reason);
        let checks = vec![check(AtLeast(wanted as f64)), check(AtMost(most))];
        rows.push(Row::new(cells, checks));
    }
    let (sum, blind) = match (
        at("fig7_one"),
        at("fig7_other"),
        outcome(outcomes, "fig7_two"),
    ) {
        (Some(one), Some(other), Some(both)) => {
            // The light without occluders, minus the light that each of the two occluders blocks,
            // is F − (F − F₁) − (F − F₂) = F₁ + F₂ − F.
            let open = etendue_predict::chain(&both.scene, &both.scene.planes[2]);
            let open = etendue_theory::Chain {
                operators: open.operators.into_iter().filter(travels).collect(),
                ..open
            };
            let plane = &both.scene.planes[2];
            let open = etendue_theory::slices(&open, &plane.window, &plane.grid);
            let norm = |of: fn([&Complex; 3]) -> f64| {
                let pairs = one.predicted.half.iter().zip(&other.predicted.half);
                let all = open.half.iter().zip(pairs);
                all.map(|(f, (a, b))| of([f, a, b]).powi(2))
                    .sum::<f64>()
                    .sqrt()
            };
            let whole = norm(|[f, ..]| f.norm());
            let sum = norm(|[f, a, b]| (a + b - f).norm());
            let blind = norm(|[f, a, b]| a.norm() + b.norm() - f.norm());
            (sum / whole, blind / whole)
        }
        _ => (f64::NAN, f64::NAN),
    };
    rows.push(Row::new(
        vec![
            "F₁ + F₂ − F, predicted with phases, relative to F".to_owned(),
            format!("{sum:.1e}"),
        ],
        vec![Check::new("sum", sum, Below(1e-12)).because("rounding")],
    ));
    rows.push(Row::new(
        vec![
            "the same with moduli, without phases".to_owned(),
            format!("{blind:.3}"),
        ],
        vec![
            Check::new("moduli", blind, Above(1e-2))
                .because("without phases, the spectra do not cancel"),
        ],
    ));
    ReportSection::new(
        "Two occluders (Fig. 7)",
        "Each of two occluders lets light pass, but both together block all of it. F is the \
         spectrum of the open light, and F₁ and F₂ are the spectra behind one occluder alone. \
         Required: at least a million photons pass each occluder, and no photon passes both. The \
         sum of spectra F₁ + F₂ − F is below 10⁻¹² of F, and the same sum of their moduli is not.",
        "quantity | number",
        rows,
    )
}

fn travels(operator: &etendue_theory::Operator) -> bool {
    matches!(operator, etendue_theory::Operator::Travel { .. })
}

/// Checks H of the light that leaves the receiver behind blockers of three sizes (Durand et al.
/// 2005, Fig. 9).
fn high_frequencies(outcomes: &[ComparedScene]) -> ReportSection {
    let shares = |name: &str| {
        let leaving = outcome(outcomes, name)?
            .planes
            .iter()
            .find(|p| p.report.name == "leaving")?;
        Some(leaving.report.high_frequency_share.clone())
    };
    let mut rows = Vec::new();
    let [a, b, c] = ["fig9a", "fig9b", "fig9c"].map(|name| shares(name).unwrap_or_default());
    for ((a, b), c) in a.iter().zip(&b).zip(&c) {
        let numbers = [a, b, c].map(|h| {
            let numbers = [h.share.measured, h.share.predicted, h.share.error];
            numbers.map(|x| x.unwrap_or(f64::NAN))
        });
        let ratios = |i: usize| {
            let [a, b, c] = numbers.map(|of| of[i]);
            [b / a, b / c]
        };
        let [measured, predicted] = [0, 1].map(ratios);
        let pull = |[m, p, e]: [f64; 3]| {
            Check::new("pull", ((m - p) / e).abs(), AtMost(4.0)).because("four standard errors")
        };
        let reason = "H is far larger than for blockers of the other sizes";
        let checks = [measured, predicted].map(|[to_a, to_c]| {
            [
                Check::new("b/a", to_a, AtLeast(5.0)).because(reason),
                Check::new("b/c", to_c.abs(), AtLeast(10.0)).because(reason),
            ]
        });
        let mut row = vec![format!("{:.2}", a.cut)];
        row.extend(numbers.map(|[m, p, e]| format!("{m:.3e} ± {e:.0e}; {p:.3e}")));
        row.push(format!("{:.0}, {:.0}", measured[0], measured[1]));
        rows.push(Row::new(
            row,
            [checks.concat(), numbers.map(pull).to_vec()].concat(),
        ));
    }
    let cuts = Check::fact("cuts", rows.len() == 2, "the scenes have two cuts");
    ReportSection::new(
        "High frequencies of a shadow (Fig. 9)",
        "H is the share of the energy above a cut in the spectrum of the windowed irradiance, for \
         the light that leaves the receiver. Each cell has the measured H ± its error, and after \
         the semicolon the predicted H. The window's main lobe ends at 1/half-width; the first cut \
         is twice that, and the second cut is 1.5 times the first. Required: each H is within four \
         errors of its prediction. At both cuts, H of fig9b is at least 5 times H of fig9a and at \
         least 10 times H of fig9c.",
        "cut [cycles/m] | H of fig9a | H of fig9b | H of fig9c | measured ratios b/a, b/c",
        rows,
    )
    .with_checks(vec![cuts])
}

/// Checks the white furnace against its closed form: radiance times the configuration factor of
/// the light.
fn furnace(outcomes: &[ComparedScene]) -> ReportSection {
    let mut rows = Vec::new();
    if let Some(outcome) = outcome(outcomes, "furnace") {
        let (plane, compared) = (&outcome.scene.planes[0], &outcome.planes[0]);
        let half = plane.window.x.half_width();
        let nodes = 400;
        let at = |i: i32| half * ((f64::from(i) + 0.5) / f64::from(nodes) * 2.0 - 1.0);
        let hann = |t: f64| (FRAC_PI_2 * t / half).cos().powi(2);
        let mut known = 0.0;
        for i in 0..nodes {
            for j in 0..nodes {
                let (x, y) = (at(i), at(j));
                let factor: f64 = [
                    (4.0 - x, 4.0 - y),
                    (4.0 + x, 4.0 - y),
                    (4.0 - x, 4.0 + y),
                    (4.0 + x, 4.0 + y),
                ]
                .map(|(a, b)| corner(a / 0.5, b / 0.5))
                .iter()
                .sum();
                known += factor * hann(x) * hann(y);
            }
        }
        // The integral over the window is the sum over cells of the position window times the
        // integral of the slope window, (half-width)².
        known *= (2.0 * half / f64::from(nodes)).powi(2) * plane.window.u.half_width().powi(2);
        let zero = [0, 0, plane.grid.nu.half];
        let (measured, error) = (compared.measured.half[zero].re, compared.sigma[zero]);
        let predicted = compared.predicted.half[zero].re;
        let (off, wrong) = ((measured - known).abs(), (predicted / known - 1.0).abs());
        let checks = vec![
            Check::new("measured", off, Below(4.0 * error)).because("four standard errors"),
            Check::new("theory", wrong, Below(1e-4)).because("error of the quadrature"),
        ];
        let cells = vec![
            format!("{known:.6}"),
            format!("{measured:.6} ± {error:.6}"),
            format!("{predicted:.6}"),
        ];
        rows.push(Row::new(cells, checks));
    }
    let lit = Check::fact("furnace", !rows.is_empty(), "the suite has this scene");
    ReportSection::new(
        "White furnace",
        "The integral ∫ L W over a white receiver 0.5 m from a light of 8 m × 8 m is known: it is \
         the radiance times a configuration factor, by the closed form for a rectangle and a \
         parallel element (Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*, \
         B-3). Required: the measured value is within four standard errors of the known one, and \
         the predicted value is within 10⁻⁴ of it.",
        "known | measured | predicted",
        rows,
    )
    .with_checks(vec![lit])
}

/// The configuration factor of a rectangle for a parallel element below a corner of the
/// rectangle. The sides x and y are in units of the distance to the element.
fn corner(x: f64, y: f64) -> f64 {
    let (p, q) = (x.hypot(1.0), y.hypot(1.0));
    (x / p * (y / p).atan() + y / q * (x / q).atan()) / TAU
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_light_all_around_fills_the_hemisphere() {
        assert!((4.0 * corner(1e9, 1e9) - 1.0).abs() < 1e-8); // 1 − O(1/x)
        assert!((corner(1e-4, 1e-4) - 1e-8 / PI).abs() < 1e-15); // area/π to O(x⁴)
    }
}
