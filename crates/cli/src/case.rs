//! What is known of a scene when all is measured and predicted.

use etendue_compare::{Applicability, Prediction};
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_store::Method;

/// A scene, and all that was measured and predicted of it.
#[derive(Debug)]
pub(crate) struct Case {
    pub(crate) scene: Scene,
    /// What theory says of each plane.
    pub(crate) theories: Vec<Applicability>,
    pub(crate) method: Method,
    pub(crate) measurement: Measurement,
    /// One for each plane, in their order.
    pub(crate) predictions: Vec<Prediction>,
}
