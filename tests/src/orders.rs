//! Compares the orders of convergence that `etendue converge` finds with the known orders.

use crate::report::Bound::{AtLeast, AtMost, Below};
use crate::report::{Check, ReportSection, Row, worse};
use crate::scenes::{read, sound};
use KnownOrder::{Exact, First, Misprint, NoOrder, Second};
use etendue_predict::{Applicability, Convergence, converge_to};
use etendue_scene::Scene;

/// Maximum deviation of a fitted order from the known order.
pub(crate) const ORDER: f64 = 0.15;
/// Maximum error of a chain that leaves nothing out. The quadrature of each of the two predictions
/// is accurate to 10⁻⁴.
const QUADRATURE: f64 = 2e-4;
/// Minimum ratio of the error of a misprinted chain in the smallest neighbourhood to its error in
/// the largest neighbourhood.
const REMAINS: f64 = 0.8;
/// Maximum value of this ratio where the error falls and its order is not known. At first order, the
/// ratio is 1/16.
const FALLS: f64 = 0.125;

/// Checks that the order fitted to decreasing errors equals the known order.
pub(crate) fn check(fitted: f64, known: f64) -> Check {
    let off = (fitted - known).abs();
    Check::new("order", off, AtMost(ORDER)).because("error of a fit to few sizes")
}

/// The slope of the least-squares line.
pub(crate) fn slope(points: &[[f64; 2]]) -> f64 {
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|p| p[axis]).sum::<f64>() / count;
    let [a, b] = [mean(0), mean(1)];
    let both: f64 = points.iter().map(|p| (p[0] - a) * (p[1] - b)).sum();
    let own: f64 = points.iter().map(|p| (p[0] - a).powi(2)).sum();
    both / own
}

/// What is known in advance of the chain to a plane (docs/theory.md, section 7).
#[derive(Clone, Copy, Debug)]
enum KnownOrder {
    /// The chain leaves nothing out. The path has only travel and plane mirrors, and the plane is
    /// perpendicular to the central ray.
    Exact,
    /// The central ray meets some surface at an angle, and the chain omits a term of second order
    /// in the distance from this ray. Relative to the width of the light, this is first order.
    First,
    /// The central ray meets every surface along its normal. Reversing all coordinates reverses the
    /// rays, so the omitted terms are of third order.
    Second,
    /// The chain has a misprint, which changes terms of first order.
    Misprint,
    /// No order is known, or none can be computed, for a reason.
    NoOrder(&'static str),
}

const NOISE: KnownOrder =
    NoOrder("none: edges of the light cross the window, and noise hides the error");
const LIST: KnownOrder = NoOrder("none: the list f(θ) does not shrink with the light");
const DIFFUSE: KnownOrder =
    NoOrder("none: neither the environment nor the Lambertian lobe can shrink");

/// The scenes of `scenes/table1/`, with the known order at each plane of the file.
const SCENES: [(&str, &[KnownOrder]); 38] = [
    ("travel", &[Exact; 3]),
    ("incidence", &[Exact, First, First, Exact]),
    ("incidence_grazing", &[Exact, First, First, Exact]),
    ("convex_normal", &[Second; 4]),
    ("convex_oblique", &[First; 4]),
    ("convex_grazing", &[First; 4]),
    ("concave_normal", &[Second; 4]),
    ("concave_oblique", &[First; 6]),
    ("concave_grazing", &[First; 4]),
    ("cylinder", &[First; 4]),
    ("paraboloid", &[First; 4]),
    ("twist", &[First; 4]),
    ("solar_oven", &[First; 6]),
    ("two_mirrors", &[First; 5]),
    ("lens", &[Second; 3]),
    ("ball_lens", &[Second; 5]),
    ("refraction_in", &[First; 5]),
    ("refraction_out", &[First; 6]),
    ("mesh_mirror", &[First; 3]),
    ("ggx_sphere", &[First; 7]),
    ("twisted_glossy", &[First; 4]),
    ("fresnel_grazing", &[First; 3]),
    ("fresnel_diamond", &[First; 3]),
    ("fresnel_aluminium", &[First; 3]),
    ("factor_incoming", &[NOISE, LIST, LIST]),
    ("factor_outgoing", &[NOISE, LIST, LIST]),
    ("glossy", &[First]),
    ("textured_glossy", &[First; 4]),
    ("checkerboard", &[First; 2]),
    ("tiles", &[First; 2]),
    ("weighted", &[First; 4]),
    ("semi_convolution", &[First; 2]),
    ("sum", &[First; 3]),
    ("environment", &[DIFFUSE; 4]),
    ("printed_incidence", &[Misprint]),
    ("printed_outgoing", &[Misprint]),
    ("printed_curvature", &[Misprint; 2]),
    ("printed_sagittal", &[Misprint; 2]),
];

/// Scenes in whose chain a curvature is 5 % too large.
const PLANTED: [(&str, &str, KnownOrder); 3] = [
    ("convex_normal", "Sphere(0.525)", Second),
    ("concave_oblique", "Sphere(-0.525)", First),
    ("ggx_sphere", "Sphere(0.525)", First),
];

/// The section.
pub(crate) fn orders() -> ReportSection {
    let mut rows = Vec::new();
    for (name, known) in SCENES {
        let scene = stored(name, &[]);
        assert_eq!(scene.planes.len(), known.len(), "planes of {name}");
        let planes = scene.planes.iter().zip(known);
        rows.extend(planes.map(|(plane, known)| {
            let found = found(&scene, &plane.name, None);
            let check = known.check(found.as_ref());
            row([name, &plane.name], found.as_ref(), known.words(), check)
        }));
    }
    for (name, form, known) in PLANTED {
        let scene = stored(name, &[]);
        let faulty = stored(name, &[("surfaces.0.form", form.to_owned())]);
        rows.extend(["curvature", "outgoing"].map(|plane| {
            let found = found(&scene, plane, Some(&faulty));
            let rejected = !known.check(found.as_ref()).passes();
            let check = Check::fact("rejected", rejected, "a fault is planted");
            let known = format!("{}; planted: curvature + 5 %", known.words());
            row([name, plane], found.as_ref(), &known, check)
        }));
    }
    ReportSection::new(
        "Orders of convergence",
        format!(
            "The errors of first-order chains are those that `etendue converge \
             scenes/table1/SCENE.ron` prints: all widths are multiplied by e, and all frequencies \
             are divided by e. No photons are traced. *Floor* is what the error may be if the \
             chain is exact: the error of the quadrature, or what noise may leave. *Order* is \
             fitted to the last three errors above five floors. *Known* is the order known in \
             advance: 1 where the central ray meets a surface at an angle, and 2 where it meets \
             all surfaces along their normals; *exact* where the path has only travel and plane \
             mirrors, so that no step is linearised; *remains* where the chain of the scene is \
             misprinted; *none* where there is no order, with the reason. Visibility, textures and \
             weights multiply, and lobes convolve; none of these is linearised, so they leave the \
             order as it is. In the last rows, the curvature in the chain is 5 % larger than that \
             of the surface. Required: the order is within {ORDER} of the known order. Exact \
             chains have errors below {QUADRATURE}. The error of a misprinted chain at e = 1/16 is \
             at least {REMAINS} of its error at e = 1. Where there is no order, the command shows \
             none, or this ratio is at most {FALLS}. The planted fault is rejected: the order is \
             not the known order."
        ),
        "scene | plane | error, e = 1 | error, e = 1/16 | floor | order | known | verdict",
        rows,
    )
    .with_checks(vec![Check::none("scenes without rows", left_out())])
}

fn stored(name: &str, fields: &[(&str, String)]) -> Scene {
    sound(name, read(&format!("table1/{name}"), fields))
}

/// The number of scene files of Table 1 that are not in the list.
///
/// # Panics
/// Panics if the folder of the scenes cannot be read.
fn left_out() -> usize {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/table1");
    let files = std::fs::read_dir(folder).expect("the folder of the scenes");
    let paths = files.map(|file| file.expect("a file").path());
    let is_known = |path: &std::path::Path| {
        let mut names = SCENES.iter().map(|(name, _)| *name);
        names.any(|name| path.file_stem().is_some_and(|stem| stem == name))
    };
    paths.filter(|path| !is_known(path)).count()
}

/// The errors of the chain to a plane; of the chain of another scene, if there is one.
fn found(scene: &Scene, plane: &str, chain: Option<&Scene>) -> Option<Convergence> {
    let plane = scene.planes.iter().find(|p| p.name == plane)?;
    converge_to(scene, plane, &Applicability::new(scene, plane), chain)
}

impl KnownOrder {
    const fn words(self) -> &'static str {
        match self {
            Exact => "exact",
            First => "1",
            Second => "2",
            Misprint => "remains",
            NoOrder(reason) => reason,
        }
    }

    /// Checks the errors of a chain; a missing order or a missing error fails.
    fn check(self, found: Option<&Convergence>) -> Check {
        let order = found.and_then(|found| found.order).unwrap_or(f64::NAN);
        let errors = found.into_iter().flat_map(|found| &found.steps);
        let errors: Vec<f64> = errors.map(|step| step.error).collect();
        let ends = errors.first().zip(errors.last());
        let ratio = ends.map_or(f64::NAN, |(first, last)| last / first);
        match self {
            First => check(order, 1.0),
            Second => check(order, 2.0),
            Exact => {
                let none = if errors.is_empty() { f64::NAN } else { 0.0 };
                let largest = errors.into_iter().fold(none, worse);
                let reason = "difference of two quadratures";
                Check::new("error", largest, Below(QUADRATURE)).because(reason)
            }
            Misprint => {
                let reason = "the error of a correct chain falls with the size";
                Check::new("remains", ratio, AtLeast(REMAINS)).because(reason)
            }
            NoOrder(reason) => Check::fact("falls", order.is_nan() || ratio <= FALLS, reason),
        }
    }
}

fn row([scene, plane]: [&str; 2], found: Option<&Convergence>, known: &str, check: Check) -> Row {
    let steps = found.and_then(|found| Some([found.steps.first()?, found.steps.last()?]));
    let number = |x: Option<f64>| {
        let finite = x.filter(|x| x.is_finite());
        finite.map_or("–".to_owned(), |x| format!("{x:.2e}"))
    };
    let order = found.and_then(|found| found.order);
    let cells = vec![
        scene.to_owned(),
        plane.to_owned(),
        number(steps.map(|[first, _]| first.error)),
        number(steps.map(|[_, last]| last.error)),
        number(steps.map(|[_, last]| last.floor)),
        order.map_or("–".to_owned(), |order| format!("{order:.3}")),
        known.to_owned(),
    ];
    Row::new(cells, vec![check])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_order_fails() {
        let scene = stored("concave_oblique", &[]);
        let curvature = found(&scene, "curvature", None);
        assert!(First.check(curvature.as_ref()).passes());
        for wrong in [Exact, Second, Misprint] {
            assert!(!wrong.check(curvature.as_ref()).passes(), "{wrong:?}");
        }
        for known in [Exact, First, Second, Misprint] {
            assert!(!known.check(None).passes(), "{known:?}");
        }
    }

    #[test]
    fn a_curvature_off_by_five_per_cent_fails() {
        let scene = stored("concave_oblique", &[]);
        let faulty = stored(
            "concave_oblique",
            &[("surfaces.0.form", "Sphere(-0.525)".to_owned())],
        );
        let planted = found(&scene, "curvature", Some(&faulty));
        assert!(!First.check(planted.as_ref()).passes(), "{planted:?}");
    }

    /// Masks do not shrink, so a disc on the central ray covers all light of a small neighbourhood.
    #[test]
    fn a_covered_light_has_no_order() {
        let disc = "[Shapes(name: \"disc\", center: (0, 0, 0.2), shapes: [Disc(center: (0, 0), radius: 0.02)])]";
        let scene = stored("concave_oblique", &[("blockers", disc.to_owned())]);
        let found = found(&scene, "curvature", None).unwrap();
        assert!(found.order.is_none() && found.steps[4].is_dark());
    }

    #[test]
    fn every_scene_of_the_table_has_rows() {
        assert_eq!(left_out(), 0);
    }
}
