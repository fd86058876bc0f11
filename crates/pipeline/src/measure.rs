//! Measures all planes of a scene.

use crate::method::source;
use crate::reporter::{Reporter, Work};
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_store::{Failure, Method};
use std::ops::Range;

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
    let measurement = etendue_spectrum::measure(&*source, &scene.planes, batches, &|photons| {
        bar.advance(photons);
    });
    drop(bar);
    Ok(measurement)
}
