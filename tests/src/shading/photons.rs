//! Every plane of the scenes of shading: photons, the exact prediction, the first-order chain and backward rays.

use super::scenes;
use crate::report::Section;
use crate::scenes::{compared, predicted, referred, traced, traced_backwards};
use etendue_compare::{PlaneComparison, Verdict, sidak};
use etendue_field::{Lobe, Orientation, Quantity, VirtualPlane};
use etendue_scene::{Event, Object, Scene};

/// Share of true sections that may be rejected, over all planes.
const ALPHA: f64 = 0.01;
/// Flux that rounding may lose of what is emitted.
const LEDGER: f64 = 1e-12;

/// A scene, run.
struct Outcome {
    scene: Scene,
    planes: Vec<PlaneComparison>,
    /// p of photons against backward rays; `None` where there are none.
    backward: Vec<Option<f64>>,
    imbalance: f64,
}

/// The section, with the photons of the files or with `photons` for each scene.
pub(super) fn photons(photons: Option<u64>) -> Section {
    let all = scenes::all(photons);
    let planes = all.iter().map(|scene| scene.planes.len()).sum();
    let level = sidak(ALPHA, planes);
    let mut rows = Vec::new();
    let mut passed = true;
    let mut whole = String::new();
    for scene in all {
        let outcome = run(scene, level);
        let mut failed = 0;
        for index in 0..outcome.planes.len() {
            let (row, well) = row(&outcome, index, level);
            failed += usize::from(!well);
            rows.push(row);
        }
        passed &= failed == 0;
        if outcome.scene.name == "fig10" {
            let agree = outcome.planes.len() - failed;
            whole = format!(
                "The whole chain of Fig. 10, seven steps that are seven planes: onto the surface, into its local normals, times the cosine, turned about the normal, \
                 convolved with the lobe, back to one frame, and off the surface; {agree} of {} pass.",
                outcome.planes.len()
            );
        }
    }
    Section {
        title:
            "Shading in 4D: photons against the exact prediction and against the first-order chain"
                .to_owned(),
        text: format!(
            "Photons and seeds as in the files. The exact prediction is a quadrature of rays through the real geometry; the chain is affine maps onto the surface and off it, \
             the clamped cosine and the lobe that the central ray meets. Error: of the chain, computed from the exact prediction. Excess: its disagreement with the photons \
             beyond noise, and the upper 95 % bound of it. Resolvable: the excess that noise lets one see. Backward: against rays followed from the plane to the light, where \
             that has an area or is an environment. Required beforehand of every plane: light; p exact ≥ {level:.6}, α = {ALPHA} over all {planes} planes; bound ≤ 1.1 errors \
             or 1 %; p backward ≥ the same level; and that what the scene emits is what it absorbs, stops and lets go, to {LEDGER:.0e}. {whole}"
        ),
        header: vec![
            "scene",
            "plane",
            "operator",
            "in window",
            "noise",
            "p exact",
            "error",
            "excess",
            "bound",
            "resolvable",
            "p backward",
            "ledger",
            "verdict",
        ],
        rows,
        passed,
    }
}

fn run(scene: Scene, level: f64) -> Outcome {
    let measurement = traced(&scene);
    let reference = traced_backwards(&scene);
    let predictions = predicted(&scene, reference.as_ref());
    let at = |i: usize| compared(&scene, &measurement, i, &predictions[i], level);
    let against = |i: usize| {
        let reference = referred(&scene, i, reference.as_ref()?);
        compared(&scene, &measurement, i, &reference, level)
            .report
            .p_value
    };
    let planes = 0..scene.planes.len();
    Outcome {
        planes: planes.clone().map(at).collect(),
        backward: planes.map(against).collect(),
        imbalance: measurement.ledger().imbalance(),
        scene,
    }
}

fn row(outcome: &Outcome, index: usize, level: f64) -> (Vec<String>, bool) {
    let Outcome {
        scene, imbalance, ..
    } = outcome;
    let report = &outcome.planes[index].report;
    let backward = outcome.backward[index];
    let first = report.first_order.as_ref();
    let mut failures = Vec::new();
    let mut require = |what: &str, holds: bool| {
        if !holds {
            failures.push(what.to_owned());
        }
    };
    require("dark", report.in_window > 0);
    require("exact", report.p_value.is_some_and(|p| p >= level));
    let excess = first.map(|f| f.verdict);
    require("first order", excess != Some(Verdict::Fail));
    let enough = report.photons_needed.unwrap_or_default();
    let undecided = format!("undecided, {enough:.1e} photons would tell");
    require(&undecided, excess != Some(Verdict::Undecided));
    require("no first order", excess.is_some());
    require("backward", backward.is_none_or(|p| p >= level));
    require("ledger", imbalance.abs() < LEDGER);
    let percent = |x: Option<f64>| x.map_or("–".to_owned(), |x| format!("{:.3} %", 100.0 * x));
    let number = |x: Option<f64>| x.map_or("–".to_owned(), |x| format!("{x:.5}"));
    let passed = failures.is_empty();
    let cells = vec![
        scene.name.clone(),
        report.name.clone(),
        operator(scene, &scene.planes[index]),
        report.in_window.to_string(),
        percent(report.noise_limit),
        number(report.p_value),
        percent(first.map(|f| f.chain.error)),
        percent(first.and_then(|f| f.excess)),
        percent(first.and_then(|f| f.excess_bound)),
        percent(first.and_then(|f| f.resolvable)),
        number(backward),
        format!("{:.0e}", imbalance.abs()),
        if passed {
            "pass".to_owned()
        } else {
            format!("FAIL: {}", failures.join(", "))
        },
    ];
    (cells, passed)
}

/// The last step on the way to a plane.
fn operator(scene: &Scene, plane: &VirtualPlane) -> String {
    let word = match (plane.leg, plane.orientation, plane.quantity) {
        (0, Orientation::Tangent, _) => "incidence",
        (0, Orientation::LocalNormals, Quantity::Radiance) => "curvature",
        (0, Orientation::LocalNormals, Quantity::DifferentialIrradiance) => "cosine",
        (0, Orientation::Mirrored, _) => "mirror",
        (_, Orientation::Tangent, _) => "back",
        (_, Orientation::Orthogonal, _) if scene.path.along(plane) > 1e-9 => "travel",
        (_, Orientation::Orthogonal, _) => "outgoing",
        (_, Orientation::LocalNormals | Orientation::Mirrored, _) => return reflection(scene),
    };
    word.to_owned()
}

/// The BRDF that light leaves the first surface by.
fn reflection(scene: &Scene) -> String {
    let hit = scene.path.legs[1].leaves.map(|hit| hit.object);
    let Some(Object::Patch(i)) = hit else {
        return "–".to_owned();
    };
    let Event::Reflects(reflectance) = &scene.patches[i].event else {
        return "–".to_owned();
    };
    let lobe = match reflectance.brdf.lobe {
        Lobe::Lambertian => "Lambertian",
        Lobe::Phong { .. } => "Phong",
        Lobe::Beckmann { .. } => "Beckmann",
        Lobe::Ggx { .. } => "GGX",
    };
    let varied = [
        (reflectance.texture.is_some(), ", texture"),
        (reflectance.blend.is_some(), ", blended"),
    ];
    let varied = varied.iter().filter(|(is, _)| *is).map(|(_, word)| *word);
    std::iter::once(lobe).chain(varied).collect()
}
