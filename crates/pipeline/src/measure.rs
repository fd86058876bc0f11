//! Measures all planes of a scene, and holds the measurement with its predictions.

use crate::method::source;
use crate::reporter::{Reporter, Work};
use etendue_compare::Prediction;
use etendue_predict::Applicability;
use etendue_scene::Scene;
use etendue_spectrum::{Measurement, measure};
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
    let source = source(scene, method)?;
    let photons = batches.clone().map(|batch| source.emitted(batch)).sum();
    let bar = reporter.begin(Work::Photons(photons));
    let planes = method.recorded_planes(scene);
    Ok(measure(&*source, &planes, batches, &|photons| {
        bar.advance(photons);
    }))
}
