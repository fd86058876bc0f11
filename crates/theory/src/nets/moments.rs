//! Moments of the rays of nets.

use crate::geometry::{self, Matrix};

/// Three sums over rays: of the weights, of the weights times z, and of the weights times z zᵀ,
/// where z is a ray.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WeightedMoments {
    total: f64,
    first: [f64; 4],
    second: Matrix<4>,
}

impl WeightedMoments {
    pub(super) fn add(&mut self, z: [f64; 4], weight: f64) {
        self.total += weight;
        for (i, row) in self.second.iter_mut().enumerate() {
            let share = weight * z[i];
            self.first[i] += share;
            for (sum, z) in row.iter_mut().zip(z) {
                *sum += share * z;
            }
        }
    }

    pub(super) fn join(&mut self, other: &Self) {
        self.total += other.total;
        self.first = std::array::from_fn(|i| self.first[i] + other.first[i]);
        self.second = geometry::sum(&self.second, &other.second);
    }

    pub(super) fn central(&self) -> Option<Matrix<4>> {
        let mean = self.first.map(|sum| sum / self.total);
        let entry =
            |i: usize, j: usize| self.second[i.min(j)][i.max(j)] / self.total - mean[i] * mean[j];
        (self.total > 0.0).then(|| geometry::from_fn(entry))
    }
}
