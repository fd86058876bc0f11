//! Estimates means over batches with their standard errors.

use crate::measurement::Measurement;
use etendue_field::{Complex, Projection, Slices};
use ndarray::{Array2, Array3};

/// The measured slices of a plane.
///
/// The mean over batches is unweighted. This mean is unbiased because each batch is unbiased, even
/// if the batches differ in size. The numbers of emitted photons of any two batches differ by at
/// most one, so weights would gain nothing.
#[derive(Clone, Debug)]
pub struct SliceEstimate {
    /// The number R of batches.
    pub batches: usize,
    /// The mean S̄ of the slices S_r of the batches.
    pub mean: Slices,
    /// The variance σ² = E|S̄ − E S̄|² of the mean, [azimuth, ρ ≥ 0, ν]. The estimate Σ|S_r −
    /// S̄|²/(R(R−1)) of σ² is unbiased even if the batches differ in size (docs/theory.md (12)).
    pub variance: Array3<f64>,
}

/// A measured projection.
#[derive(Clone, Debug)]
pub struct ProjectionEstimate {
    /// The mean projection over batches.
    pub mean: Projection,
    /// The standard error of the mean in each cell, [x, u].
    pub standard_error: Array2<f64>,
}

/// The error that is returned if there are too few batches to estimate a standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{have} batches are too few for an error: at least {need} are needed")]
pub struct TooFewBatches {
    /// Number of batches available.
    pub have: usize,
    /// Number of batches needed.
    pub need: usize,
}

impl TooFewBatches {
    /// Fails if a measurement has fewer than `need` batches.
    pub(crate) fn check(measurement: &Measurement, need: usize) -> Result<(), Self> {
        let have = measurement.batches().len();
        if have < need {
            return Err(Self { have, need });
        }
        Ok(())
    }
}

/// The mean slices at plane `plane` with their variance.
///
/// # Errors
///
/// Fails if there are fewer than two batches.
pub fn slices(measurement: &Measurement, plane: usize) -> Result<SliceEstimate, TooFewBatches> {
    TooFewBatches::check(measurement, 2)?;
    let batches = measurement.batches().len();
    let each = || measurement.at_plane(plane).map(|batch| &batch.slices.half);
    let grid = measurement.planes()[plane].grid;

    let mut mean = Slices::zeros(grid);
    for half in each() {
        mean.half += half;
    }
    mean.half /= Complex::from(batches as f64);

    let mut variance = Array3::zeros(grid.half_shape());
    for half in each() {
        ndarray::Zip::from(&mut variance)
            .and(half)
            .and(&mean.half)
            .for_each(|sum: &mut f64, s, m| *sum += (s - m).norm_sqr());
    }
    variance /= (batches * (batches - 1)) as f64;
    Ok(SliceEstimate {
        batches,
        mean,
        variance,
    })
}

/// The relative noise of the slices at plane `plane`: √(Σσ²/(Σ|S̄|² − Σσ²)), over
/// independent frequencies. Returns `None` if no photon arrived, or if the estimated noise Σσ²
/// exceeds the power Σ|S̄|².
///
/// # Errors
///
/// Fails if there are fewer than two batches.
pub fn noise(measurement: &Measurement, plane: usize) -> Result<Option<f64>, TooFewBatches> {
    let SliceEstimate { mean, variance, .. } = slices(measurement, plane)?;
    let (mut noise, mut both) = (0.0, 0.0);
    for (((_, m, n), variance), value) in variance.indexed_iter().zip(&mean.half) {
        if mean.grid.is_independent(m, n) {
            noise += variance;
            both += value.norm_sqr();
        }
    }
    let light = both - noise;
    Ok((light > 0.0).then(|| (noise / light).sqrt()))
}

/// The mean projection at plane `plane` with its standard error.
///
/// # Errors
///
/// Fails if there are fewer than two batches.
pub fn projection(
    measurement: &Measurement,
    plane: usize,
) -> Result<ProjectionEstimate, TooFewBatches> {
    TooFewBatches::check(measurement, 2)?;
    let batches = measurement.batches().len();
    let each = || measurement.at_plane(plane).map(|batch| &batch.projection);
    let grid = each().next().map(|projection| projection.grid);
    let Some(grid) = grid else {
        return Err(TooFewBatches { have: 0, need: 2 });
    };

    let mut mean = Array2::<f64>::zeros((grid.bins, grid.bins));
    for projection in each() {
        mean += &projection.values;
    }
    mean /= batches as f64;

    let mut squares = Array2::<f64>::zeros(mean.raw_dim());
    for projection in each() {
        squares += &(&projection.values - &mean).mapv(|d| d * d);
    }
    Ok(ProjectionEstimate {
        standard_error: (squares / (batches * (batches - 1)) as f64).mapv(f64::sqrt),
        mean: Projection { grid, values: mean },
    })
}
