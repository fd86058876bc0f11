//! Computes the radial power of two results, and its difference.

use super::stored::StoredSlices;
use etendue_compare::Residuals;
use etendue_field::{Orientation, SliceGrid, Slices};
use etendue_store::arrays::z;
use ndarray::{Array2, Array3, Axis};

/// The radial power of two results, [ρ, ν], and their difference.
#[derive(Debug)]
pub(super) struct RadialDiff {
    pub(super) grid: SliceGrid,
    pub(super) orientation: Orientation,
    /// The power of the first and of the second result, without shot noise.
    pub(super) powers: [Array2<f64>; 2],
    /// The power of the second minus that of the first result, divided by its standard deviation if
    /// both measure the same light.
    pub(super) z: Array2<f64>,
}

impl RadialDiff {
    /// `differences` holds B_b − A_b of each batch if the results are pairs.
    pub(super) fn new(
        [a, b]: [&StoredSlices; 2],
        differences: Option<&Residuals>,
        orientation: Orientation,
    ) -> Self {
        let grid = a.grid;
        let mean = |values: &Array3<f64>| {
            grid.unfold_radial((values.sum_axis(Axis(0)) / grid.azimuths as f64).view())
        };
        let noise = [a, b].map(|of| of.sample.sigma.mapv(|sigma| sigma * sigma));
        let power = [a, b].map(|of| of.sample.mean.mapv(|value| value.norm_sqr()));
        let sigma = differences.map_or_else(
            || {
                // As in `Residuals::radial_sigma`, for noise that is independent between azimuths.
                let variance = |i: usize| &noise[i] * &(&power[i] * 2.0 + &noise[i]);
                (mean(&(variance(0) + variance(1))) / grid.azimuths as f64).mapv(f64::sqrt)
            },
            |differences| {
                let half = a.sample.mean.clone();
                differences.radial_sigma(&Slices { grid, half }, &differences.variance())
            },
        );
        let powers = [0, 1].map(|i| mean(&(&power[i] - &noise[i])));
        Self {
            grid,
            orientation,
            z: z(&powers[1], &powers[0], &sigma),
            powers,
        }
    }
}
