//! What is known of a scene when all is measured and predicted.

use crate::measure::measured;
use crate::predict::predicted;
use crate::reporter::Reporter;
use etendue_compare::{Applicability, Prediction};
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_store::Failure;
use etendue_store::Method;

/// A scene, and all that was measured and predicted of it.
#[derive(Debug)]
pub struct MeasuredScene {
    /// The scene.
    pub scene: Scene,
    /// What theory says of each plane.
    pub theories: Vec<Applicability>,
    /// How it was measured.
    pub method: Method,
    /// All planes, measured.
    pub measurement: Measurement,
    /// One for each plane, in their order.
    pub predictions: Vec<Prediction>,
}

impl MeasuredScene {
    /// Measures a scene and predicts it.
    pub fn of(
        scene: Scene,
        theories: Vec<Applicability>,
        method: Method,
        reporter: &dyn Reporter,
    ) -> Result<Self, Failure> {
        let measurement = measured(&scene, method, 0..scene.run.batches, reporter)?;
        let predictions = predicted(&scene, &theories, method, None, reporter)?;
        Ok(Self {
            scene,
            theories,
            method,
            measurement,
            predictions,
        })
    }
}
