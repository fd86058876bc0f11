//! Computes sums over the first samples of each object. To each of them, a small share of the sums
//! over all objects is added.

use std::collections::BTreeMap;

/// The mean over all objects is added to the sums of each object as if it were this number of
/// samples. The ratios of an object with few samples are therefore close to the ratios of all
/// objects.
const SHARED: f64 = 4.0;

/// Sums of `N` numbers for each object and for all objects together.
#[derive(Debug)]
pub(crate) struct ObjectSums<const N: usize> {
    count: f64,
    /// The sums over all objects.
    pub(crate) all: [f64; N],
    objects: BTreeMap<usize, [f64; N]>,
}

impl<const N: usize> Default for ObjectSums<N> {
    fn default() -> Self {
        Self {
            count: 0.0,
            all: [0.0; N],
            objects: BTreeMap::new(),
        }
    }
}

impl<const N: usize> ObjectSums<N> {
    /// Adds the numbers of a sample on an object.
    pub(crate) fn add(&mut self, object: usize, numbers: [f64; N]) {
        self.count += 1.0;
        let own = self.objects.entry(object).or_insert([0.0; N]);
        for (i, number) in numbers.into_iter().enumerate() {
            own[i] += number;
            self.all[i] += number;
        }
    }

    /// The sums of an object, with the mean over all objects added as [`SHARED`] samples.
    pub(crate) fn of(&self, object: usize) -> [f64; N] {
        let own = self.objects.get(&object).copied().unwrap_or([0.0; N]);
        let shared = SHARED / self.count.max(1.0);
        std::array::from_fn(|i| own[i] + shared * self.all[i])
    }
}
