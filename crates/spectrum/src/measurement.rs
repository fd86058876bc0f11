//! Defines measurements: batches of photons at virtual planes.

use crate::batch::{Batch, PlaneBatch};
use crate::variation::WindowedMean;
use etendue_field::{Ledger, PlaneTally, Projection, Slices, VirtualPlane};
use std::collections::BTreeMap;

/// A complete or partial measurement: some batches of photons at some virtual planes.
///
/// A measurement records the numbers of its batches, so partial results of one experiment can be
/// computed on different machines and merged in any order. Sums over batches are always in the
/// order of the batches' numbers, so results are bitwise identical.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    planes: Vec<VirtualPlane>,
    batches: BTreeMap<u32, Batch>,
}

/// The reason why a batch or a partial result cannot be added to a measurement.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// A batch is in both results, so its photons would count twice.
    #[error("batch {0} is in both results")]
    BatchTwice(u32),
    /// The two results were measured at different planes.
    #[error("the results are of different planes: [{}] and [{}]", .0.join(", "), .1.join(", "))]
    Planes(Vec<String>, Vec<String>),
    /// The shape of a batch's slices does not match the planes.
    #[error("batch {batch} does not hold the slices of planes [{}]", .planes.join(", "))]
    Shape {
        /// The batch.
        batch: u32,
        /// The planes of the measurement.
        planes: Vec<String>,
    },
}

impl Measurement {
    /// A measurement at `planes` that has no batches yet.
    #[must_use]
    pub fn new(planes: Vec<VirtualPlane>) -> Self {
        Self {
            planes,
            batches: BTreeMap::new(),
        }
    }

    /// The measurement with `batches`. The batches must have distinct numbers and slices
    /// that match `planes`.
    pub(crate) fn of(planes: &[VirtualPlane], batches: impl Iterator<Item = Batch>) -> Self {
        Self {
            planes: planes.to_vec(),
            batches: batches.map(|batch| (batch.index, batch)).collect(),
        }
    }

    /// The virtual planes of the measurement.
    #[must_use]
    pub fn planes(&self) -> &[VirtualPlane] {
        &self.planes
    }

    /// The batches, in ascending order of their numbers.
    pub fn batches(&self) -> impl ExactSizeIterator<Item = &Batch> {
        self.batches.values()
    }

    /// Checks whether the measurement contains batch `index`.
    #[must_use]
    pub fn contains(&self, index: u32) -> bool {
        self.batches.contains_key(&index)
    }

    /// The measurement of each batch at plane `plane`, in ascending order of the batches'
    /// numbers.
    ///
    /// # Panics
    ///
    /// If the measurement has no such plane, the use of the iterator panics.
    pub fn at_plane(&self, plane: usize) -> impl ExactSizeIterator<Item = &PlaneBatch> {
        self.batches.values().map(move |batch| &batch.planes[plane])
    }

    /// The slices of each batch at plane `plane` minus the mean of the light in the
    /// window (see [`WindowedMean`]).
    ///
    /// # Panics
    ///
    /// Panics if the measurement has no such plane.
    #[must_use]
    pub fn without_mean(&self, plane: usize) -> Vec<Slices> {
        let VirtualPlane { window, grid, .. } = &self.planes[plane];
        let batches = self.at_plane(plane).map(|batch| &batch.slices);
        WindowedMean::new(window, grid).removed_from_all(batches)
    }

    /// The number of photons emitted in all batches.
    #[must_use]
    pub fn emitted(&self) -> u64 {
        self.batches.values().map(|batch| batch.emitted).sum()
    }

    /// The ledger of the photons' flux, summed over batches.
    #[must_use]
    pub fn ledger(&self) -> Ledger {
        let mut sum = Ledger::default();
        for batch in self.batches.values() {
            sum.add(&batch.ledger);
        }
        sum
    }

    /// The numbers of photons inside and outside the window of plane `plane`, summed over
    /// batches.
    #[must_use]
    pub fn tally(&self, plane: usize) -> PlaneTally {
        let mut sum = PlaneTally::default();
        for batch in self.at_plane(plane) {
            sum.add(&batch.tally);
        }
        sum
    }

    /// Adds a batch.
    ///
    /// # Errors
    ///
    /// Fails if the measurement already contains the batch, or if the batch's slices do not match
    /// the planes.
    pub fn insert(&mut self, batch: Batch) -> Result<(), MergeError> {
        if self.contains(batch.index) {
            return Err(MergeError::BatchTwice(batch.index));
        }
        let grids = self.planes.iter().map(|plane| plane.grid);
        if !batch.planes.iter().map(|p| p.slices.grid).eq(grids) {
            return Err(MergeError::Shape {
                batch: batch.index,
                planes: self.names(),
            });
        }
        self.batches.insert(batch.index, batch);
        Ok(())
    }

    /// Merges this result with another partial result of the same experiment.
    ///
    /// # Errors
    ///
    /// Fails if the planes of the two results differ, or if a batch is in both results.
    pub fn merge(mut self, other: Self) -> Result<Self, MergeError> {
        if self.planes != other.planes {
            return Err(MergeError::Planes(self.names(), other.names()));
        }
        for batch in other.batches.into_values() {
            self.insert(batch)?;
        }
        Ok(self)
    }

    /// The measurement of a scene by its difference from another one: the slices and the projection of
    /// each batch become B_b − A_b + F. The first half of the planes holds B_b, the second A_b, and
    /// `known` the expected slices and projection F of A at each plane. If both use the same random
    /// numbers, most of their noise cancels. Tallies, ledger and moments remain those of B.
    ///
    /// # Panics
    ///
    /// Panics if the planes of A have other frequencies than those of B, or than `known`.
    #[must_use]
    pub fn difference(mut self, known: &[(&Slices, &Projection)]) -> Self {
        self.planes.truncate(known.len());
        for batch in self.batches.values_mut() {
            let of_a = batch.planes.split_off(known.len());
            let planes = batch.planes.iter_mut().zip(of_a);
            for ((b, a), (slices, projection)) in planes.zip(known) {
                // In this order, equal batches give exactly F.
                b.slices.half -= &a.slices.half;
                b.slices.half += &slices.half;
                b.projection.values -= &a.projection.values;
                b.projection.values += &projection.values;
            }
        }
        self
    }

    fn names(&self) -> Vec<String> {
        self.planes.iter().map(|plane| plane.name.clone()).collect()
    }
}
