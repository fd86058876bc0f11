//! Compares photons at every plane of the shading scenes with the exact prediction, with the
//! first-order chain and with backward rays.

use super::scenes;
use crate::report::Bound::{AtLeast, Below};
use crate::report::{Check, ReportSection, Row, number, plane_cells};
use crate::rows::Line;
use crate::scenes::ComparedScene;
use etendue_compare::{TESTS, Verdict, sidak};
use etendue_field::{Lobe, Orientation, Quantity, VirtualPlane};
use etendue_scene::{Event, Object, Scene};

/// False rejection rate over all planes.
const ALPHA: f64 = 0.01;
/// Maximum rounding error of the flux balance relative to the emitted flux.
const LEDGER: f64 = 1e-12;

/// The section on all planes. Each scene is traced with `photons` photons. If `photons` is
/// `None`, each scene is traced with the number of photons in its file.
pub(super) fn photons(photons: Option<u64>) -> ReportSection {
    let all = scenes::all(photons);
    let planes: usize = all.iter().map(|scene| scene.planes.len()).sum();
    let level = sidak(ALPHA, TESTS * planes);
    let mut rows: Vec<Row> = Vec::new();
    let mut whole = String::new();
    for scene in all {
        let outcome = ComparedScene::new(scene, level);
        let before = rows.len();
        rows.extend((0..outcome.planes.len()).map(|index| row(&outcome, index, level)));
        if outcome.scene.name == "fig10" {
            let agree = rows[before..].iter().filter(|row| row.passes()).count();
            whole = format!(
                "The whole chain of Fig. 10 has seven steps, with a plane after each: onto the \
                surface, into its local normals, times the cosine, turned about the normal, \
                convolved with the lobe, back to one frame, and off the surface; {agree} of {} \
                pass.",
                outcome.planes.len()
            );
        }
    }
    ReportSection::new(
        "Shading in 4D: photons against the exact prediction and against the first-order chain",
        format!(
            "Photons and seeds are those of the files. Photons are compared with an exact \
             prediction and with a first-order chain. The exact prediction is a quadrature of rays \
             through the real geometry. The chain consists of the affine maps onto the surface and \
             off it, the clamped cosine, and the lobe that the central ray meets. *Error* is the \
             error of the chain, computed from the exact prediction. *Excess* is the disagreement \
             of the chain with the photons beyond noise, and *bound* is the upper 95 % bound of \
             the excess. *Resolvable* is the smallest excess that can be detected above the noise. \
             *p backward* compares photons with rays followed from the plane to the light, where \
             the light has an area or is an environment. *Ledger* is the relative difference \
             between the flux that the scene emits and the flux that it absorbs, stops and lets \
             go. Required of every plane: light arrives. *p exact* is at least {level:.6}, unless \
             the stated error of the prediction may explain the whole difference; this level is α \
             = {ALPHA} over all {planes} planes. The bound is at most 1.1 errors or 1 %. *p \
             backward* is at least the same level. The ledger is balanced to {LEDGER:.0e}. \
             {whole}"
        ),
        "scene | plane | operator | in window | noise | p exact | error | excess | bound | \
         resolvable | p backward | ledger | verdict",
        rows,
    )
}

fn row(outcome: &ComparedScene, index: usize, level: f64) -> Row {
    let scene = &outcome.scene;
    let imbalance = outcome.measurement.ledger().imbalance();
    let place = &scene.planes[index];
    let report = &outcome.planes[index].report;
    let backward = outcome.backward[index];
    let first = report.first_order.as_ref();
    let agrees = first.is_some_and(|f| f.verdict == Verdict::Pass);
    let mut checks = vec![
        Check::light(report),
        Check::exact(report, level),
        Check::fact("first order", agrees, "by the rule for first-order chains"),
        Check::new("ledger", imbalance.abs(), Below(LEDGER)).because("rounding"),
    ];
    if first.is_some_and(|f| f.verdict == Verdict::Undecided) {
        let enough = AtLeast(report.photons_needed.unwrap_or(f64::INFINITY));
        let photons = scene.run.photons as f64;
        checks
            .push(Check::new("photons", photons, enough).because("this many photons would decide"));
    }
    checks.extend(backward.map(|p| Check::p("backward", Some(p), level)));
    let (word, mut lines) = operator(scene, place);
    let is_separable = scene.name.starts_with("fresnel") || scene.name.starts_with("factor");
    lines.extend(is_separable.then_some(Line::Separable));
    lines.extend((scene.name == "environment").then_some(Line::Environment));
    lines.extend((place.name == "1_incidence").then_some(Line::Visibility));
    let mut cells = vec![scene.name.clone(), report.name.clone(), word];
    cells.extend(plane_cells(report));
    cells.extend([number(backward), format!("{:.0e}", imbalance.abs())]);
    Row::new(cells, checks).of(lines)
}

/// The name of the last step before a plane, and the rows of the paper's Table 1 that
/// describe this step.
fn operator(scene: &Scene, plane: &VirtualPlane) -> (String, Vec<Line>) {
    let (word, line) = match (plane.leg, plane.orientation, plane.quantity) {
        (0, Orientation::Tangent, _) => ("incidence", Line::Incidence),
        (0, Orientation::LocalNormals, Quantity::Radiance) => ("curvature", Line::Curvature),
        (0, Orientation::LocalNormals, Quantity::DifferentialIrradiance) => {
            ("cosine", Line::Cosine)
        }
        (0, Orientation::Mirrored, _) => ("mirror", Line::Mirror),
        (_, Orientation::Tangent, _) => ("back", Line::Curvature),
        (_, Orientation::Orthogonal, _) if scene.path.along(plane) > 1e-9 => {
            ("travel", Line::Travel)
        }
        (_, Orientation::Orthogonal, _) => ("outgoing", Line::Outgoing),
        (_, Orientation::LocalNormals | Orientation::Mirrored, _) => return reflection(scene),
    };
    (word.to_owned(), vec![line])
}

/// The BRDF of the first surface in a scene.
fn reflection(scene: &Scene) -> (String, Vec<Line>) {
    let hit = scene.path.legs[1].leaves.map(|hit| hit.object);
    let Some(Object::Patch(i)) = hit else {
        return ("–".to_owned(), Vec::new());
    };
    let Event::Reflects(reflectance) = &scene.patches[i].event else {
        return ("–".to_owned(), Vec::new());
    };
    let lobe = match reflectance.first().lobe {
        Lobe::Lambertian => "Lambertian",
        Lobe::Phong { .. } => "Phong",
        Lobe::Beckmann { .. } => "Beckmann",
        Lobe::Ggx { .. } => "GGX",
    };
    match (reflectance.texture.is_some(), reflectance.only().is_none()) {
        (false, false) if lobe == "Lambertian" => (lobe.to_owned(), Vec::new()),
        (false, false) => (lobe.to_owned(), vec![Line::Brdf]),
        (true, false) => (format!("{lobe}, texture"), vec![Line::Texture]),
        (false, true) => (format!("{lobe}, blended"), vec![Line::SpaceVarying]),
        (true, true) => (format!("{lobe}, texture, blended"), Vec::new()),
    }
}
