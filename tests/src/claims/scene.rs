//! Traces and predicts small scenes that test the paper's statements.

use super::number::{Batches, ClaimNumber, jackknife};
use crate::scenes::{predicted, traced};
use etendue_compare::Prediction;
use etendue_field::Slices;
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_spectrum::Measurement;

/// Light, blockers and a floor, all perpendicular to the central ray.
pub(super) struct ClaimBench<'a> {
    pub(super) light: &'a str,
    /// The blockers, written as in a scene file; they are 1 m from the light.
    pub(super) blockers: &'a str,
    /// Distance from the light to the floor, metres.
    pub(super) floor: f64,
    pub(super) planes: &'a str,
}

/// A square light of 0.2 m.
pub(super) const LIGHT: &str = "Rectangle(center: (0, 0, 0), size: (0.2, 0.2))";

impl ClaimBench<'_> {
    pub(super) fn seen(&self, photons: u64) -> SeenScene {
        let Self {
            light,
            blockers,
            floor,
            planes,
        } = self;
        SeenScene::of(scene(
            &format!(
                "light: {light}, blockers: [{blockers}],
                surfaces: [Rectangle(name: \"floor\", center: (0, 0, {floor}), size: (20, 20), albedo: 1)],
                path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [\"floor\"]), planes: [{planes}]"
            ),
            photons,
        ))
    }
}

/// Returns the scene-file text of an array of squares 1 m from the light; the squares are
/// jittered only if `rest` specifies a jitter.
pub(super) fn squares(count: [u32; 2], pitch: f64, rest: &str) -> String {
    let [x, y] = count;
    format!(
        "JitteredSquares(name: \"blockers\", center: (0, 0, 1), count: ({x}, {y}), pitch: {pitch}, {rest})"
    )
}

/// Returns the scene-file text of a plane with a window and frequencies of its own.
pub(super) fn plane(at: &str, window: &str, frequencies: &str) -> String {
    format!(
        "(name: \"plane\", at: {at}, window: ({window}), frequencies: (azimuths: 1, {frequencies})),"
    )
}

/// Reads a scene from a text, to which a window and settings of the run are added.
///
/// # Panics
/// Panics if the scene is invalid.
pub(super) fn scene(text: &str, photons: u64) -> Scene {
    let text = format!(
        "({text}, window: (x: Hann(0.5), u: Hann(0.5)), frequencies: (azimuths: 1, rho: (max: 16), nu: (max: 4)),
        run: (photons: {photons}, seed: 1, batches: 64))"
    );
    let file = SceneFile::parse(&text).expect("a scene file");
    resolve("claim", file, ".".as_ref(), u64::MAX).expect("a sound scene")
}

/// A scene, measured and predicted.
pub(super) struct SeenScene {
    pub(super) measurement: Measurement,
    pub(super) predictions: Vec<Prediction>,
}

impl SeenScene {
    /// # Panics
    /// Panics if no theory applies to a plane.
    pub(super) fn of(scene: Scene) -> Self {
        Self {
            measurement: traced(&scene),
            predictions: predicted(&scene, None),
        }
    }

    /// Returns a number computed from one plane.
    pub(super) fn number(&self, plane: usize, of: impl Fn(&Slices) -> f64) -> ClaimNumber {
        number(&[(self, plane)], &|slices| of(&slices[0]))
    }

    fn batches(&self, plane: usize) -> Vec<Slices> {
        let batches = self.measurement.at_plane(plane);
        batches.map(|batch| batch.slices.clone()).collect()
    }
}

/// Computes a number, batch by batch, from several planes, which may belong to different scenes.
pub(super) fn number(planes: &[(&SeenScene, usize)], of: &dyn Fn(&[Slices]) -> f64) -> ClaimNumber {
    let each = planes.iter();
    let batches: Batches = each.clone().map(|(seen, i)| seen.batches(*i)).collect();
    let [value, noise] = jackknife(&batches, of);
    let said = each.map(|(seen, i)| &seen.predictions[*i]);
    let replicates: Batches = said.clone().map(|p| p.replicates.clone()).collect();
    let count = replicates[0].len();
    // A closed form has no replicates, so its error is 0.
    let [predicted, error] = if count > 0 && replicates.iter().all(|r| r.len() == count) {
        jackknife(&replicates, of)
    } else {
        let slices: Vec<Slices> = said.map(|p| p.slices.clone()).collect();
        [of(&slices), 0.0]
    };
    ClaimNumber {
        value,
        error: noise.hypot(error),
        predicted,
    }
}
