//! Tests Table 1 of Durand et al. 2005, row by row. In 2D, theory is compared with quadrature; in
//! 4D, photons are compared with theory.

mod bench;
mod errata;
mod foci;
mod operators;
mod path;
mod planar;
mod planted;
mod quadrature;
mod steps;
mod volume;

pub(crate) use path::on_circle;
pub(crate) use quadrature::{apart, content};

use crate::report::ReportSection;
use crate::scenes::{compared, named, predicted, traced};
use etendue_compare::{PlaneComparison, Prediction, TESTS, sidak};
use etendue_predict::path;
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_theory::Observed;

/// False rejection rate over all planes.
const ALPHA: f64 = 0.01;

/// The scenes that test Table 1.
const SCENES: &str = "travel incidence incidence_grazing convex_normal convex_oblique \
    convex_grazing concave_normal concave_oblique concave_grazing cylinder paraboloid twist \
    solar_oven two_mirrors lens ball_lens refraction_in refraction_out mesh_mirror \
    printed_incidence printed_outgoing printed_curvature printed_sagittal";

/// The results for one scene that tests Table 1.
struct TableRun {
    scene: Scene,
    measurement: Measurement,
    predictions: Vec<Prediction>,
    planes: Vec<PlaneComparison>,
}

impl TableRun {
    /// The specular system before a plane.
    ///
    /// # Panics
    /// Panics if theory does not trace rays to the plane.
    fn system(&self, plane: usize) -> Observed {
        path(&self.scene, &self.scene.planes[plane]).expect("a scene of free specular surfaces")
    }

    /// The index of a plane.
    ///
    /// # Panics
    /// Panics if there is no plane of that name.
    fn plane(&self, name: &str) -> usize {
        let planes = &self.scene.planes;
        let found = planes.iter().position(|p| p.name == name);
        found.expect("a plane of the scene")
    }
}

/// All sections on Table 1. Each scene is traced with `photons` photons. If `photons` is
/// `None`, each scene is traced with the number of photons in its file.
pub(crate) fn table1(photons: Option<u64>) -> Vec<ReportSection> {
    let scene = |name| named(&format!("table1/{name}"), photons, None);
    let all: Vec<Scene> = SCENES.split(' ').map(scene).collect();
    let planes: usize = all.iter().map(|scene| scene.planes.len()).sum();
    let level = sidak(ALPHA, TESTS * planes);
    let outcomes: Vec<TableRun> = all.into_iter().map(|scene| run(scene, level)).collect();
    let named = |name: &str| {
        let found = outcomes.iter().find(|o| o.scene.name == name);
        found.expect("a scene of the table")
    };
    let (sound, printed): (Vec<&TableRun>, Vec<&TableRun>) =
        outcomes.iter().partition(|o| !o.scene.file.as_printed);
    let exact = "concave_oblique solar_oven refraction_in refraction_out".split(' ');
    let exact: Vec<&TableRun> = exact.map(named).collect();
    vec![
        planar::planar(),
        operators::operators(&sound, planes, level),
        errata::misprints(named("concave_oblique"), named("incidence")),
        errata::as_printed(&printed, level),
        foci::foci(named("solar_oven")),
        planted::first_order(named("concave_oblique"), named("convex_normal")),
        planted::exact(&exact, level),
        volume::volume(&sound),
    ]
}

fn run(scene: Scene, level: f64) -> TableRun {
    let measurement = traced(&scene);
    let predictions = predicted(&scene, None);
    let each = predictions.iter().enumerate();
    let planes = each.map(|(i, p)| compared(&scene, &measurement, i, p, level));
    TableRun {
        planes: planes.collect(),
        scene,
        measurement,
        predictions,
    }
}
