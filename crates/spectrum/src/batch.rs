//! Defines the measurement of one batch of photons, and the sum of the first parts of a batch.

use crate::ray_moments::RayMoments;
use etendue_field::{Ledger, PlaneTally, Projection, Slices};

/// The measurement of one batch of photons at one plane.
///
/// The slices and the projection are sums over the batch, divided by the number of photons that the
/// batch emitted. Each batch therefore gives an unbiased estimate.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneBatch {
    /// Number of photons that crossed the plane, inside and outside its window.
    pub tally: PlaneTally,
    /// The slices of the windowed field.
    pub slices: Slices,
    /// The windowed field projected onto (x, u).
    pub projection: Projection,
    /// Second moments of the windowed field, per emitted photon.
    pub moments: RayMoments,
}

impl PlaneBatch {
    /// Adds the measurement of another part of the same batch at this plane.
    fn add(&mut self, other: &Self) {
        self.tally.add(&other.tally);
        self.slices.half += &other.slices.half;
        self.projection.values += &other.projection.values;
        let sums = self.moments.0.iter_mut().zip(other.moments.0);
        sums.for_each(|(sum, other)| *sum += other);
    }
}

impl Batch {
    /// Adds the measurement of another part of the same batch at all planes.
    pub(crate) fn add(&mut self, other: &Self) {
        self.ledger.add(&other.ledger);
        let planes = self.planes.iter_mut().zip(&other.planes);
        planes.for_each(|(plane, other)| plane.add(other));
    }
}

/// The measurement of one batch of photons, which is independent of all other batches.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// Number of the batch.
    pub index: u32,
    /// Number of photons emitted, including those that end with zero weight.
    pub emitted: u64,
    /// The ledger of the emitted photons' flux.
    pub ledger: Ledger,
    /// One entry for each virtual plane, in the order of the measurement's planes.
    pub planes: Vec<PlaneBatch>,
}

/// The sum of the first parts of a batch, added in order. A measurement that continues from this
/// sum gives bitwise the same result as an uninterrupted measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct PartialBatch {
    /// The number of the batch.
    pub index: u32,
    /// The number of parts of the batch that the sum contains.
    pub parts: u32,
    /// The sum of the parts, or `None` if there are no parts. The sum is divided by the number of
    /// photons of the complete batch, like the sums in [`PlaneBatch`].
    pub sum: Option<Batch>,
}

impl PartialBatch {
    /// A batch without any parts.
    #[must_use]
    pub fn new(index: u32) -> Self {
        Self {
            index,
            parts: 0,
            sum: None,
        }
    }

    /// Adds the next part of the batch.
    pub(crate) fn add(&mut self, part: Batch) {
        self.parts += 1;
        match &mut self.sum {
            Some(sum) => sum.add(&part),
            sum => *sum = Some(part),
        }
    }
}
