//! Sampling of items in proportion to their weights.

/// Weights of items, as cumulative sums; each sum includes the weight of its own item.
#[derive(Clone, Debug)]
pub struct DiscreteDistribution {
    sums: Vec<f64>,
}

impl DiscreteDistribution {
    /// A distribution with these weights, which must not be negative.
    #[must_use]
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Self {
        let mut sum = 0.0;
        let sums = weights.into_iter().map(|weight| {
            sum += weight;
            sum
        });
        Self {
            sums: sums.collect(),
        }
    }

    /// The sum of all weights.
    #[inline]
    #[must_use]
    pub fn total(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// Samples the index of an item with a weight above 0. Returns 0 if there is no such item.
    #[inline]
    #[must_use]
    pub fn sample(&self, r: f64) -> usize {
        let wanted = r * self.total();
        self.sums.partition_point(|sum| *sum < wanted)
    }
}
