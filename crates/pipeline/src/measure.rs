//! Measures all planes of a scene, and holds the measurement with its predictions.

use crate::method::source;
use crate::reporter::{Reporter, Work};
use etendue_compare::Prediction;
use etendue_field::PhotonSource;
use etendue_predict::Applicability;
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_store::{Failure, Method};
use std::ops::Range;

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

/// Measures some batches of a scene at all its planes.
pub fn measured(
    scene: &Scene,
    method: Method,
    batches: Range<u32>,
    reporter: &dyn Reporter,
) -> Result<Measurement, Failure> {
    Ok(measured_by(
        &*source(scene, method)?,
        scene,
        batches,
        reporter,
    ))
}

/// Measures some batches of the light of `source` at all planes of a scene.
pub(crate) fn measured_by(
    source: &dyn PhotonSource,
    scene: &Scene,
    batches: Range<u32>,
    reporter: &dyn Reporter,
) -> Measurement {
    let photons = batches.clone().map(|batch| source.emitted(batch)).sum();
    let bar = reporter.begin(Work::Photons(photons));
    etendue_spectrum::measure(source, &scene.planes, batches, &|photons| {
        bar.advance(photons);
    })
}
