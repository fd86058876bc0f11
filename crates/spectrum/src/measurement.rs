//! Measurements: batches of photons at virtual planes.

use crate::batch::{Batch, PlaneBatch};
use etendue_field::{Ledger, PlaneTally, VirtualPlane};
use std::collections::BTreeMap;

/// A measurement, whole or partial: some batches of photons at some virtual planes.
///
/// It knows which batches it holds, so partial results of one experiment can be computed anywhere and
/// merged in any order; every number is then summed in the order of the batches, to the same bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    planes: Vec<VirtualPlane>,
    batches: BTreeMap<u32, Batch>,
}

/// Why a batch or a partial result cannot be added to a measurement.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// The same batch twice: its photons would count twice.
    #[error("batch {0} is in both results")]
    BatchTwice(u32),
    /// The two results were measured at different planes.
    #[error("the results are of different planes: [{}] and [{}]", .0.join(", "), .1.join(", "))]
    Planes(Vec<String>, Vec<String>),
    /// A batch whose slices are not those the planes ask for.
    #[error("batch {batch} does not hold the slices of planes [{}]", .planes.join(", "))]
    Shape {
        /// The batch.
        batch: u32,
        /// The planes of the measurement.
        planes: Vec<String>,
    },
}

impl Measurement {
    /// A measurement at `planes` that holds no batch yet.
    #[must_use]
    pub fn new(planes: Vec<VirtualPlane>) -> Self {
        Self {
            planes,
            batches: BTreeMap::new(),
        }
    }

    /// The measurement made of `batches`, whose numbers are distinct and whose slices are those of `planes`.
    pub(crate) fn of(planes: &[VirtualPlane], batches: impl Iterator<Item = Batch>) -> Self {
        Self {
            planes: planes.to_vec(),
            batches: batches.map(|batch| (batch.index, batch)).collect(),
        }
    }

    /// The virtual planes.
    #[must_use]
    pub fn planes(&self) -> &[VirtualPlane] {
        &self.planes
    }

    /// The batches, by ascending number.
    pub fn batches(&self) -> impl ExactSizeIterator<Item = &Batch> {
        self.batches.values()
    }

    /// Whether it holds batch `index`.
    #[must_use]
    pub fn contains(&self, index: u32) -> bool {
        self.batches.contains_key(&index)
    }

    /// What each batch measured at plane `plane`, by ascending number of the batch.
    ///
    /// # Panics
    ///
    /// When there is no such plane and the iterator is used.
    pub fn at_plane(&self, plane: usize) -> impl ExactSizeIterator<Item = &PlaneBatch> {
        self.batches.values().map(move |batch| &batch.planes[plane])
    }

    /// Photons emitted in all batches.
    #[must_use]
    pub fn emitted(&self) -> u64 {
        self.batches.values().map(|batch| batch.emitted).sum()
    }

    /// What became of their flux, summed over batches.
    #[must_use]
    pub fn ledger(&self) -> Ledger {
        let mut sum = Ledger::default();
        for batch in self.batches.values() {
            sum.add(&batch.ledger);
        }
        sum
    }

    /// The photons of all batches that crossed plane `plane`.
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
    /// When the batch is already here, or its slices are not those of the planes.
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

    /// This and another partial result of the same experiment in one.
    ///
    /// # Errors
    ///
    /// When the planes differ or a batch is in both.
    pub fn merge(mut self, other: Self) -> Result<Self, MergeError> {
        if self.planes != other.planes {
            return Err(MergeError::Planes(self.names(), other.names()));
        }
        for batch in other.batches.into_values() {
            self.insert(batch)?;
        }
        Ok(self)
    }

    fn names(&self) -> Vec<String> {
        self.planes.iter().map(|plane| plane.name.clone()).collect()
    }
}
