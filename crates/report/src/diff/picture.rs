//! Draws the difference of two results at one plane.

use super::difference::Diff;
use super::planes::PlaneDiff;
use super::stored::StoredSlices;
use crate::pictures::{DECIBEL, image, power_axes, spectrum_quantity};
use crate::table::spaced;
use etendue_compare::Residuals;
use etendue_field::{Orientation, SliceGrid, Slices, percent};
use etendue_figures::{Comparison, comparison};
use etendue_store::Failure;
use ndarray::{Array2, Array3, Axis};
use std::path::Path;

/// The radial power of two results, [ρ, ν], and their difference.
#[derive(Debug)]
pub(super) struct RadialDiff {
    grid: SliceGrid,
    orientation: Orientation,
    /// The power of the first and of the second result, without shot noise.
    powers: [Array2<f64>; 2],
    /// The power of the second minus that of the first result, divided by its standard deviation if
    /// both measure the same light.
    z: Array2<f64>,
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
        let mut z = &powers[1] - &powers[0];
        z.zip_mut_with(&sigma, |z, s| *z = if *s > 0.0 { *z / s } else { f64::NAN });
        Self {
            grid,
            orientation,
            powers,
            z,
        }
    }
}

impl Diff {
    /// The picture of the plane that differs most, for a file at `path`: the power of both results,
    /// and their difference.
    ///
    /// # Errors
    /// When the path ends neither in .png nor in .svg, or when no plane is compared.
    pub fn drawn(&self, path: &Path) -> Result<Vec<u8>, Failure> {
        let compared = self.planes.iter().filter_map(PlaneDiff::named);
        let size = |(_, plane): &(&String, &super::planes::Compared)| {
            plane.test.chi2_per_dof.unwrap_or(0.0)
        };
        let (name, plane) = compared
            .max_by(|a, b| size(a).total_cmp(&size(b)))
            .ok_or_else(|| Failure::bad_input("no plane is compared, so none can be drawn"))?;
        let radial = &plane.radial;
        let [x, y] = power_axes(radial.orientation, &radial.grid);
        let [of_a, of_b] = &radial.powers;
        let test = &plane.test;
        let figure = comparison(&Comparison {
            title: &format!("{}: power spectra of two results", spaced(name)),
            note: &format!(
                "A: {}, B: {}; they differ by {}, and noise alone is {}",
                self.results[0].folder.display(),
                self.results[1].folder.display(),
                percent(test.difference, 3),
                percent(test.noise, 3)
            ),
            x,
            y,
            quantity: spectrum_quantity(),
            scale: DECIBEL,
            sides: ["B", "A"],
            measured: of_b.view(),
            predicted: of_a.view(),
            z: radial.z.view(),
            finer: None,
        });
        image(&figure.map_err(Failure::cannot_run)?, path)
    }
}
