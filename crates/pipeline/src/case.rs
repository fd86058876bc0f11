//! A scene with its measurement and predictions.

use crate::measure::measured;
use crate::predict::predicted;
use crate::reporter::Reporter;
use etendue_compare::{Applicability, Prediction};
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_store::Failure;
use etendue_store::Method;

/// A scene with its measurement and predictions.
#[derive(Debug)]
pub struct MeasuredScene {
    /// The scene.
    pub scene: Scene,
    /// The theory that applies to each plane.
    pub theories: Vec<Applicability>,
    /// The method of measurement.
    pub method: Method,
    /// The measurement of all planes.
    pub measurement: Measurement,
    /// A prediction for each plane, in the order of the planes.
    pub predictions: Vec<Prediction>,
}

impl MeasuredScene {
    /// Measures and predicts a scene.
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
