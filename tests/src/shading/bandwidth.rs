//! Compares the sampling criteria of section 6.2 with traced rays.

use super::eye::EyeScene;
use crate::report::Bound::Below;
use crate::report::{Check, ReportSection, Row};
use etendue_theory::shading::Criterion;
use etendue_theory::shading::PlanarLobe::{Beckmann, Gaussian, Ggx, Phong};

/// The relative tolerance, which corresponds to six digits.
const DIGITS: f64 = 1e-6;
/// The tolerance for bandwidths of images; an image is a thousand times narrower than the radius
/// of the circle.
const IMAGE: f64 = 0.01;

/// The scene from which the sweeps start.
pub(super) fn criterion(curvature: f64, angle: f64, distance: f64, blocker: f64) -> Criterion {
    Criterion {
        curvature,
        incidence: angle,
        outgoing: -angle,
        distance,
        blocker_distance: Some(blocker),
        lobe_cutoff: 4.0,
        environment_cutoff: 1.5,
    }
}

fn sweeps() -> Vec<(&'static str, Criterion)> {
    let mut all = Vec::new();
    for k in [0.5, -0.3, 0.05, -0.05, 2.0, -1.2] {
        all.push(("curvature", criterion(k, 0.6, 3.0, 0.8)));
    }
    for angle in [0.0, 0.3, 1.2] {
        all.push(("view angle", criterion(0.5, angle, 3.0, 0.8)));
    }
    for distance in [0.1, 0.4, 1.0, 30.0] {
        all.push(("distance", criterion(0.5, 0.6, distance, 0.8)));
    }
    for blocker in [0.1, 0.4, 3.0, 20.0] {
        all.push(("blocker", criterion(-0.3, 0.6, 3.0, blocker)));
    }
    let base = criterion(0.5, 0.6, 3.0, 0.8);
    for (name, lobe) in [
        ("lobe, Gaussian σ = 0.05", Gaussian { deviation: 0.05 }),
        ("lobe, Phong n = 50", Phong { exponent: 50.0 }),
        ("lobe, Phong n = 1000", Phong { exponent: 1000.0 }),
        ("lobe, Beckmann α = 0.1", Beckmann { roughness: 0.1 }),
        ("lobe, GGX α = 0.1", Ggx { roughness: 0.1 }),
    ] {
        let lobe_cutoff = lobe.cutoff(0.99);
        let criterion = Criterion {
            lobe_cutoff,
            ..base
        };
        all.push((name, criterion));
    }
    for (incidence, outgoing) in [(0.6, -0.3), (0.2, -1.1), (-0.4, -0.2)] {
        let aside = Criterion {
            incidence,
            outgoing,
            ..base
        };
        all.push(("aside", aside));
    }
    all.push((
        "more convex",
        Criterion {
            lobe_cutoff: 6.0,
            ..criterion(1.5, 0.3, 0.4, 2.0)
        },
    ));
    all.push((
        "environment cut off",
        Criterion {
            environment_cutoff: 9.0,
            ..base
        },
    ));
    all
}

/// The section.
pub(super) fn bandwidths() -> ReportSection {
    let mut rows = Vec::new();
    for (name, criterion) in sweeps() {
        let scene = EyeScene { criterion };
        let [b, edge, both] = scene.traced();
        let off = |said: f64, traced: f64| (said / traced - 1.0).abs();
        let (said, said_edge) = (criterion.environment(), criterion.blocker());
        let images = [scene.image(false, said), scene.image(true, said_edge)];
        let bound = criterion.combined();
        // The sum of two terms equals the bound if both terms have the same sign.
        let reached =
            1.0 + 2.0 * criterion.curvature * criterion.distance / criterion.outgoing.cos() > 0.0;
        let digits = |id, figure| Check::new(id, figure, Below(DIGITS)).because("six digits");
        let image = |image: f64| {
            let reason = "images a thousand times narrower than the radius";
            Check::new("image", (image - 1.0).abs(), Below(IMAGE)).because(reason)
        };
        let mut checks = vec![
            digits("B", off(said, b)),
            digits("B'", off(said_edge, edge)),
            digits("B'' beyond its bound", both / bound - 1.0),
        ];
        checks.extend(reached.then(|| digits("B''", off(bound, both))));
        checks.extend(images.map(image));
        let six = |x: f64| format!("{x:.5}");
        let cells = vec![
            name.to_owned(),
            criterion.curvature.to_string(),
            criterion.incidence.to_string(),
            criterion.outgoing.to_string(),
            criterion.distance.to_string(),
            criterion
                .blocker_distance
                .map_or("–".to_owned(), |d| d.to_string()),
            format!("{:.3}", criterion.lobe_cutoff),
            six(said),
            six(b),
            six(criterion.printed_environment()),
            six(said_edge),
            six(edge),
            six(criterion.printed_blocker()),
            six(bound),
            six(both),
            format!("{:.4}, {:.4}", images[0], images[1]),
        ];
        rows.push(Row::new(cells, checks));
    }
    ReportSection::new(
        "Sampling criteria against traced rays (section 6.2)",
        format!(
            "No photons are traced here. B, B' and B'' are bandwidths in slope at an eye that sees \
             a glossy circle from the distance d in the mirror direction (beside it in the rows \
             `aside`). B is for an environment, B' is for a blocker at d', and B'' is for both, \
             with an environment cut off at Ω_e = 1.5 (9 in the last row). For the columns \
             *traced*, rays of the eye are followed back off the circle. The phase of a wave in \
             the environment, at the blocker, or of both at once is differentiated along these \
             rays, and along the lobe at one point, where it may change by Ω_ρ. *Images* has two \
             ratios for a lobe of 10⁻⁴ rad: the 99 % cutoff of the traced image of a distant point \
             over B, and the cutoff of the derivative of the image of an edge over B'. Required: B \
             and B' agree with the traced values to {DIGITS:.0e}. B'' is never below the traced \
             value, and equals it where 1 + 2kd/cos θ₁ > 0. The images are within {IMAGE} of 1. \
             The printed formulas, Eq. 20 and Eq. 21, are only shown here; the errata above \
             compare them with rays."
        ),
        "sweep | k | θ₀ | θ₁ | d | d' | Ω_ρ | B | traced | Eq. 20 | B' | traced | Eq. 21 | B'' \
         bound | traced | images | verdict",
        rows,
    )
}
