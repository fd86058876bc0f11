//! A scene with its measurement and predictions.

use etendue_compare::Prediction;
use etendue_predict::Applicability;
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
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
