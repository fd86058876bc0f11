//! The variance really made: means over many sets of points.

use crate::variance::points::{points, shift};
use crate::variance::radiance::WindowRadiance;
use crate::variance::sampler::Sampler;
use etendue_spectrum::Uncertain;
use rayon::prelude::*;

/// The allowed numbers of sets of points with which a variance is found.
pub const SETS: std::ops::RangeInclusive<u32> = 10..=1_000_000;

/// The default number of sets of points.
pub const DEFAULT_SETS: u32 = 200;

/// A family of sets of points, which gives each set its own random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetFamily {
    /// The seed.
    pub seed: u64,
    /// Number of the family, below 2¹⁶.
    pub family: u64,
    /// Number of sets, below 2³².
    pub sets: u32,
    /// Whether each set is shifted on the torus.
    pub is_shifted: bool,
}

impl SetFamily {
    /// The mean of the radiance over each set of `count` points; `None` if the sampler has
    /// no such sets. `progress` is called with 1 after each set.
    #[must_use]
    pub fn means(
        &self,
        radiance: &WindowRadiance<'_>,
        sampler: &Sampler,
        count: usize,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Option<Vec<f64>> {
        let mean = |i: u32| {
            let set = (self.family << 32) | u64::from(i);
            let mut rays = points(sampler, count, self.seed, set)?;
            if self.is_shifted {
                shift(&mut rays, self.seed, set);
            }
            let mean = radiance.mean(&rays, set);
            progress(1);
            Some(mean)
        };
        (0..self.sets).into_par_iter().map(mean).collect()
    }
}

/// The variance of independent numbers, and its standard error from their fourth moment.
#[must_use]
pub fn variance_of(values: &[f64]) -> Uncertain {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let moment = |power: i32| values.iter().map(|v| (v - mean).powi(power)).sum::<f64>() / n;
    let value = moment(2) * n / (n - 1.0);
    let of_variance = (moment(4) - value * value * (n - 3.0) / (n - 1.0)) / n;
    Uncertain {
        value,
        error: of_variance.max(0.0).sqrt(),
    }
}
