//! Traces and predicts the scenes of `scenes/words/`, which test the paper's statements.

use super::number::{Batches, ClaimNumber, jackknife};
use crate::SEED;
use crate::scenes::{emit, predicted, read, sound, traced};
use clap::Args;
use etendue_compare::Prediction;
use etendue_field::Slices;
use etendue_scene::Scene;
use etendue_spectrum::Measurement;

/// The options of all scenes.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct ClaimRun {
    /// Photons of each scene, instead of those in its file; if given, nothing is written.
    #[arg(long)]
    pub(crate) photons: Option<u64>,
    /// Seed of the photons of every scene. Blockers do not change. Nothing is written for another
    /// seed than the default.
    #[arg(long, default_value_t = SEED)]
    pub(crate) seed: u64,
}

impl ClaimRun {
    /// Reads a scene of `scenes/words/`, and sets fields of its file, as `--set` does.
    ///
    /// # Panics
    /// Panics if there is no such scene, or if it is invalid.
    pub(super) fn scene(&self, name: &str, fields: &[(&str, String)]) -> Scene {
        let mut file = read(&format!("words/{name}"), fields);
        emit(&mut file.run, self.photons);
        file.run.seed = self.seed;
        sound(name, file)
    }

    /// Measures and predicts a scene of `scenes/words/`.
    pub(super) fn seen(&self, name: &str, fields: &[(&str, String)]) -> SeenScene {
        SeenScene::of(self.scene(name, fields))
    }
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

    /// A number computed from one plane.
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
