//! What one batch of photons measured, whole or in part.

use crate::ray_moments::RayMoments;
use etendue_field::{Ledger, PlaneTally, Projection, Slices};

/// What one batch of photons measured at one plane.
///
/// Slices and projection are means per emitted photon of the batch: each is by itself an unbiased estimate.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneBatch {
    /// Photons that crossed the plane, in and out of its window.
    pub tally: PlaneTally,
    /// The slices of the windowed field.
    pub slices: Slices,
    /// The windowed field over (x, u).
    pub projection: Projection,
    /// Its second moments, likewise.
    pub moments: RayMoments,
}

impl PlaneBatch {
    /// Adds what another part of the batch measured.
    fn add(&mut self, other: &Self) {
        self.tally.add(&other.tally);
        self.slices.half += &other.slices.half;
        self.projection.values += &other.projection.values;
        let sums = self.moments.0.iter_mut().zip(other.moments.0);
        sums.for_each(|(sum, other)| *sum += other);
    }
}

impl Batch {
    /// Adds what another part of the batch measured.
    pub(crate) fn add(&mut self, other: &Self) {
        self.ledger.add(&other.ledger);
        let planes = self.planes.iter_mut().zip(&other.planes);
        planes.for_each(|(plane, other)| plane.add(other));
    }
}

/// What one batch of photons measured: a replicate, independent of all others.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// Its number.
    pub index: u32,
    /// Photons emitted, those that end with zero weight included.
    pub emitted: u64,
    /// What became of their flux.
    pub ledger: Ledger,
    /// One entry for each virtual plane, in the order of the measurement's planes.
    pub planes: Vec<PlaneBatch>,
}

/// The first parts of a batch, summed in order: its measurement goes on from them, and ends with the same bits as if it had not stopped.
#[derive(Clone, Debug, PartialEq)]
pub struct PartialBatch {
    /// The number of the batch.
    pub index: u32,
    /// How many parts are summed.
    pub parts: u32,
    /// Their sum; `None` of no parts. Like all sums it is per photon of the whole batch.
    pub sum: Option<Batch>,
}

impl PartialBatch {
    /// A batch that is not begun.
    #[must_use]
    pub fn new(index: u32) -> Self {
        Self {
            index,
            parts: 0,
            sum: None,
        }
    }

    /// Adds the next part.
    pub(crate) fn add(&mut self, part: Batch) {
        self.parts += 1;
        match &mut self.sum {
            Some(sum) => sum.add(&part),
            sum => *sum = Some(part),
        }
    }
}
