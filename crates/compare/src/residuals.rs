//! Computes measured minus predicted slices, batch by batch, and tests these differences.

use crate::signs::{LANES, p_of_signs};
use etendue_field::{Complex, SliceGrid, Slices, modulus};
use etendue_spectrum::Measurement;
use ndarray::{Array, Array2, Array3, ArrayView3, Axis, Dimension};
use std::slice;

/// Measured minus predicted slices, in independent parts.
///
/// If the prediction has no statistical error, each batch has a residual, r_b = S_b − F. If the
/// prediction has replicates, neighbouring batches and replicates are combined into groups. The
/// number of groups is the number of batches or the number of replicates, whichever is smaller
/// (docs/theory.md, section 6). If the prediction is true, each residual is an independent draw
/// with mean zero. The mean of the residuals is S − F.
#[derive(Clone, Debug)]
pub struct Residuals {
    grid: SliceGrid,
    /// A residual for each batch or group, [azimuth, ρ ≥ 0, ν].
    parts: Vec<Array3<Complex>>,
}

/// The smallest number of pairs that must differ, so that the spread of their differences gives an
/// error. If a change concerns few photons, most batches are equal in both results.
pub const MIN_DIFFERING: usize = 24;
/// Error of the fast transform of photons, as a share of the largest value: at most 2·10⁻⁷ with
/// full precision, and 2.6·10⁻⁷ in the scenes of results/performance.md with reduced precision.
const TRANSFORM: f64 = 3e-7;
/// Rounding error in the sum of shares that should add up to one.
const ROUNDING: f64 = 1e-9;

/// Returns by how much the error of the fast transform may change each power, at most.
pub(crate) fn of_transform<D: Dimension>(power: &Array<f64, D>) -> Array<f64, D> {
    let peak = power.iter().copied().fold(0.0, f64::max);
    power.mapv(|p| 2.0 * TRANSFORM * (p.max(0.0) * peak).sqrt())
}

impl Residuals {
    /// Returns residuals that were computed elsewhere, each an independent draw, [azimuth, ρ ≥ 0,
    /// ν].
    #[must_use]
    pub fn of(grid: SliceGrid, parts: Vec<Array3<Complex>>) -> Self {
        Self { grid, parts }
    }

    /// The differences B_b − A_b of the batches of two measurements that use the same random numbers,
    /// each [azimuth, ρ ≥ 0, ν].
    #[must_use]
    pub fn of_pairs<'a>(
        grid: SliceGrid,
        a: impl IntoIterator<Item = ArrayView3<'a, Complex>>,
        b: impl IntoIterator<Item = ArrayView3<'a, Complex>>,
    ) -> Self {
        let pairs = a.into_iter().zip(b);
        Self::of(grid, pairs.map(|(a, b)| &b - &a).collect())
    }

    /// The differences between plane `plane` of a measurement and slices without
    /// statistical error.
    ///
    /// # Panics
    /// Panics if the frequencies of the plane differ from the frequencies of the prediction.
    #[must_use]
    pub fn new(measurement: &Measurement, plane: usize, prediction: &Slices) -> Self {
        Self::between(measurement, plane, prediction, &[])
    }

    /// The differences between a measurement and slices that are the mean of replicates.
    /// The slices are exact if there are no replicates.
    ///
    /// There are n = min(B, R) groups. Each group g holds a share of the B batches and of the R
    /// replicates, and r_g = n/B Σ_b (S_b − F) − n/R Σ_j (F_j − F). If all groups hold the same
    /// number of batches and the same number of replicates, r_g does not depend on F.
    ///
    /// # Panics
    /// Panics if the frequencies of the plane differ from the frequencies of the prediction.
    #[must_use]
    pub fn between(
        measurement: &Measurement,
        plane: usize,
        prediction: &Slices,
        replicates: &[Slices],
    ) -> Self {
        let batches: Vec<&Slices> = measurement.at_plane(plane).map(|b| &b.slices).collect();
        Self::between_samples(&batches, prediction, replicates)
    }

    /// As [`Self::between`], for batches of slices.
    ///
    /// # Panics
    /// Panics if the frequencies of the batches differ from the frequencies of the prediction.
    #[must_use]
    pub fn between_samples(
        batches: &[&Slices],
        prediction: &Slices,
        replicates: &[Slices],
    ) -> Self {
        let grid = prediction.grid;
        if replicates.is_empty() {
            let residual = |batch: &&Slices| {
                check(batch, prediction);
                &batch.half - &prediction.half
            };
            let parts = batches.iter().map(residual).collect();
            return Self { grid, parts };
        }
        let groups = batches.len().min(replicates.len());
        let mut parts = vec![Array3::zeros(prediction.grid.half_shape()); groups];
        // The coefficient of F itself in each group.
        let mut left = vec![0.0; groups];
        let samples: [(f64, Vec<&Slices>); 2] =
            [(1.0, batches.to_vec()), (-1.0, replicates.iter().collect())];
        for (sign, sample) in samples {
            let share = groups as f64 / sample.len() as f64;
            for (i, slices) in sample.iter().enumerate() {
                check(slices, prediction);
                let group = i * groups / sample.len();
                parts[group].scaled_add(Complex::from(sign * share), &slices.half);
                left[group] -= sign * share;
            }
        }
        for (part, left) in parts.iter_mut().zip(left) {
            if f64::abs(left) > ROUNDING {
                part.scaled_add(Complex::from(left), &prediction.half);
            }
        }
        Self { grid, parts }
    }

    /// The residuals combined into `groups` groups of neighbours, whose mean is the same.
    #[must_use]
    pub fn grouped(self, groups: usize) -> Self {
        let count = self.count();
        if groups == count {
            return self;
        }
        let mut parts = vec![Array3::zeros(self.grid.half_shape()); groups];
        for (i, part) in self.parts.iter().enumerate() {
            let share = Complex::from(groups as f64 / count as f64);
            parts[i * groups / count].scaled_add(share, part);
        }
        Self { parts, ..self }
    }

    /// The differences between the measurement and the closest spectrum near the
    /// prediction. At each frequency, this spectrum differs from F by at most `error`|F| plus the
    /// error of the fast transform, which is relative to the largest F.
    #[must_use]
    pub fn within_error(&self, prediction: &Slices, error: f64) -> Self {
        self.without(&self.forgiven(prediction, error))
    }

    /// The differences of two measurements without what the error of the fast transform may cause;
    /// `measured` is one of them, with the same axes.
    #[must_use]
    pub fn within_error_of(&self, measured: &Array3<Complex>) -> Self {
        let (grid, half) = (self.grid, measured.clone());
        self.within_error(&Slices { grid, half }, 0.0)
    }

    /// The residuals with a part of their mean subtracted from each.
    #[must_use]
    pub fn without(&self, part: &Array3<Complex>) -> Self {
        let parts = self.parts.iter().map(|residual| residual - part);
        Self {
            grid: self.grid,
            parts: parts.collect(),
        }
    }

    /// The part of the mean residual that [`Self::forgiving`] removes.
    pub(crate) fn forgiven(&self, prediction: &Slices, error: f64) -> Array3<Complex> {
        let mut moved = self.mean();
        let of_transform = TRANSFORM * largest(&prediction.half);
        moved.zip_mut_with(&prediction.half, |mean, f| {
            let distance = modulus(*mean);
            if distance > 0.0 {
                *mean *= ((error * modulus(*f)).max(of_transform) / distance).min(1.0);
            }
        });
        moved
    }

    /// The residuals times a number.
    #[must_use]
    pub fn scaled(mut self, by: f64) -> Self {
        for part in &mut self.parts {
            part.mapv_inplace(|value| value * by);
        }
        self
    }

    /// The differences to other residuals of the same photons.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        let [a, b] = [other, self].map(|of| of.parts.iter().map(|part| part.view()));
        Self::of_pairs(self.grid, a, b)
    }

    /// Each residual as slices.
    #[must_use]
    pub fn slices(&self) -> Vec<Slices> {
        let grid = self.grid;
        let each = self.parts.iter().cloned();
        each.map(|half| Slices { grid, half }).collect()
    }

    /// The residuals without what the fitted steps of parameters explain: each residual minus its
    /// `steps`, [R, n], times the derivatives. A change of the parameters leaves them unchanged to
    /// first order.
    #[must_use]
    pub fn without_steps(mut self, derivatives: &[Array3<Complex>], steps: &Array2<f64>) -> Self {
        for (part, steps) in self.parts.iter_mut().zip(steps.outer_iter()) {
            for (derivative, step) in derivatives.iter().zip(steps) {
                part.scaled_add(Complex::from(-step), derivative);
            }
        }
        self
    }

    /// The number of residuals R.
    #[must_use]
    pub fn count(&self) -> usize {
        self.parts.len()
    }

    /// The number of residuals that are not zero.
    #[must_use]
    pub fn differing(&self) -> usize {
        let differs = |part: &&Array3<Complex>| part.iter().any(|value| value.norm_sqr() > 0.0);
        self.parts.iter().filter(differs).count()
    }

    /// Each residual, [azimuth, ρ ≥ 0, ν].
    pub(crate) fn each(&self) -> impl Iterator<Item = &Array3<Complex>> {
        self.parts.iter()
    }

    /// S − F, [azimuth, ρ ≥ 0, ν].
    #[must_use]
    pub fn mean(&self) -> Array3<Complex> {
        let mut sum = Array3::zeros(self.grid.half_shape());
        for residual in &self.parts {
            sum += residual;
        }
        sum / Complex::from(self.count() as f64)
    }

    /// The variance of [`Self::mean`] from the spread of the batches (docs/theory.md (12)).
    #[must_use]
    pub fn variance(&self) -> Array3<f64> {
        let mean = self.mean();
        let mut variance = Array3::zeros(self.grid.half_shape());
        for residual in &self.parts {
            ndarray::Zip::from(&mut variance)
                .and(residual)
                .and(&mean)
                .for_each(|sum: &mut f64, r, m| *sum += (r - m).norm_sqr());
        }
        variance / (self.count() * (self.count() - 1)) as f64
    }

    /// The independent cells of an array on the half-plane, in the same order for all
    /// arrays.
    fn cells<'a, T>(&self, array: &'a Array3<T>) -> impl Iterator<Item = &'a T> {
        let grid = self.grid;
        array
            .indexed_iter()
            .filter(move |((_, m, n), _)| grid.is_independent(*m, *n))
            .map(|(_, value)| value)
    }

    /// The number of independent frequencies.
    #[must_use]
    pub fn frequencies(&self) -> usize {
        self.cells(&self.parts[0]).count()
    }

    /// The sum of `term` over the independent frequencies of two arrays.
    pub(crate) fn sum<A, B>(
        &self,
        a: &Array3<A>,
        b: &Array3<B>,
        term: impl Fn(&A, &B) -> f64,
    ) -> f64 {
        self.cells(a)
            .zip(self.cells(b))
            .map(|(a, b)| term(a, b))
            .sum()
    }

    /// Returns χ² per degree of freedom: the mean of |S − F|²/σ² over the independent frequencies
    /// where σ > 0.
    ///
    /// σ² is itself estimated from R batches. For complex normal residuals this estimate raises the
    /// mean by (R − 1)/(R − 2), and the mean is divided by this factor. Returns `None` when no
    /// photon arrived.
    #[must_use]
    pub fn chi2_per_dof(&self, variance: &Array3<f64>) -> Option<f64> {
        let resolved = self.cells(variance).filter(|v| **v > 0.0).count();
        if resolved == 0 {
            return None;
        }
        let sum = self.sum(&self.mean(), variance, |m, v| {
            if *v > 0.0 { m.norm_sqr() / v } else { 0.0 }
        });
        let r = self.count() as f64;
        Some(sum / resolved as f64 * (r - 2.0) / (r - 1.0))
    }

    /// The standard deviation, [ρ, ν], of measured minus predicted radial power, if F is
    /// true.
    ///
    /// The difference is |S|² − σ² − |F|² = 2 Re F*(S − F) + (|S − F|² − σ²), averaged over the
    /// azimuths. The first term is a mean over residuals, and the spread of the residuals gives the
    /// variance of this term. The second term has the variance σ⁴ at each azimuth. Unlike the
    /// jackknife error of the power, this error does not increase when the measured power
    /// fluctuates upwards.
    #[must_use]
    pub fn radial_sigma(&self, prediction: &Slices, variance: &Array3<f64>) -> Array2<f64> {
        let azimuths = self.grid.azimuths as f64;
        let half = self.grid.half_shape();
        let r = self.count() as f64;
        let (mut sum, mut squares) = (
            Array2::<f64>::zeros((half[1], half[2])),
            Array2::<f64>::zeros((half[1], half[2])),
        );
        for residual in &self.parts {
            let mut cross = Array3::<f64>::zeros(half);
            ndarray::Zip::from(&mut cross)
                .and(residual)
                .and(&prediction.half)
                .for_each(|c, r, f| *c = 2.0 * (f.re * r.re + f.im * r.im));
            let mean = cross.sum_axis(Axis(0)) / azimuths;
            squares += &mean.mapv(|c| c * c);
            sum += &mean;
        }
        let spread = (squares - sum.mapv(|s| s * s) / r) / (r * (r - 1.0));
        let noise = variance.mapv(|v| v * v).sum_axis(Axis(0)) / (azimuths * azimuths);
        let sigma = (spread + noise).mapv(|v| v.max(0.0).sqrt());
        self.grid.unfold_radial(sigma.view())
    }

    /// The [R, R] matrix H_bc = Σ Re(r_b conj r_c) / s, where the sum runs over the
    /// frequencies. At each frequency, s is 1, or Σ_b |r_b|² if `normalised` is set.
    pub(crate) fn products(&self, normalised: bool) -> Array2<f64> {
        let mut scale = Array3::from_elem(self.grid.half_shape(), 1.0);
        if normalised {
            scale.fill(0.0);
            for residual in &self.parts {
                scale.zip_mut_with(residual, |s, r| *s += r.norm_sqr());
            }
        }
        self.scaled_products(&scale)
    }

    /// The [R, R] matrix Σ Re(r_b conj r_c) / `scale` over the frequencies where the scale is not 0.
    #[must_use]
    pub fn scaled_products(&self, scale: &Array3<f64>) -> Array2<f64> {
        let r = self.count();
        let mut products = Array2::zeros((r, r));
        for k in 0..self.grid.azimuths {
            let row = |residual| self.row(residual, scale, k);
            let rows: Vec<Vec<f64>> = self.parts.iter().map(row).collect();
            for b in 0..r {
                for c in 0..=b {
                    products[[b, c]] += dot(&rows[b], &rows[c]);
                }
            }
        }
        for b in 0..r {
            for c in 0..b {
                products[[c, b]] = products[[b, c]];
            }
        }
        products
    }

    /// ‖mean residual‖² without its noise, Σ_{b≠c} H_bc / (R (R − 1)), and the delete-one
    /// jackknife error of this value (docs/theory.md, section 6).
    #[must_use]
    pub fn squared(&self) -> (f64, f64) {
        let products = self.products(false);
        let r = self.count() as f64;
        let rows: Vec<f64> = products
            .outer_iter()
            .enumerate()
            .map(|(b, row)| row.sum() - row[b])
            .collect();
        let total: f64 = rows.iter().sum();
        let without = rows
            .iter()
            .map(|row| (total - 2.0 * row) / ((r - 1.0) * (r - 2.0)));
        let mean = without.clone().sum::<f64>() / r;
        let spread: f64 = without.map(|u| (u - mean).powi(2)).sum();
        (total / (r * (r - 1.0)), ((r - 1.0) / r * spread).sqrt())
    }

    /// The standard error of [`Self::squared`] if every residual has mean zero. If every
    /// mean is zero, the terms of the sum are uncorrelated, and each pair occurs twice.
    pub(crate) fn squared_error(&self) -> f64 {
        let products = self.products(false);
        let r = self.count() as f64;
        let all: f64 = products.iter().map(|h| h * h).sum();
        let diagonal: f64 = products.diag().iter().map(|h| h * h).sum();
        (2.0 * (all - diagonal)).max(0.0).sqrt() / (r * (r - 1.0))
    }

    /// The real and imaginary parts of the independent cells of azimuth `k`, divided by the
    /// root of `scale`.
    fn row(&self, residual: &Array3<Complex>, scale: &Array3<f64>, k: usize) -> Vec<f64> {
        let plane = residual.index_axis(Axis(0), k);
        let scale = scale.index_axis(Axis(0), k);
        let mut row = Vec::with_capacity(2 * plane.len());
        for (((m, n), value), scale) in plane.indexed_iter().zip(scale) {
            if self.grid.is_independent(m, n) {
                let root = if *scale > 0.0 {
                    1.0 / scale.sqrt()
                } else {
                    0.0
                };
                row.extend([value.re * root, value.im * root]);
            }
        }
        row
    }

    /// The p-value of the hypothesis that every residual has mean zero.
    ///
    /// The statistic is Σ |Σ_b r_b|² / Σ_b |r_b|² over the frequencies. Under the hypothesis, a
    /// residual and its negative are equally likely. Therefore the statistic with random signs has
    /// the same distribution as the observed statistic. The random signs also account for
    /// correlations between neighbouring frequencies.
    ///
    /// Returns `None` when all residuals are zero, for example when no light is measured or
    /// predicted.
    #[must_use]
    pub fn p_value(&self, seed: u64) -> Option<f64> {
        Self::joint_p_value(slice::from_ref(self), seed)
    }

    /// The p-value of the hypothesis that every residual of several planes has mean zero. All
    /// planes must have the same number of residuals; residual b of each is from the same photons.
    #[must_use]
    pub fn joint_p_value(planes: &[Self], seed: u64) -> Option<f64> {
        let products = planes.iter().map(|plane| plane.products(true));
        let products = products.reduce(|a, b| a + b)?;
        let is_noisy = products.diag().sum() > 0.0;
        is_noisy.then(|| p_of_signs(&products, products.nrows(), seed, |signs| signs))
    }
}

/// Panics if the measured and the predicted slices have different frequencies.
fn check(measured: &Slices, predicted: &Slices) {
    let (measured, predicted) = (measured.grid, predicted.grid);
    assert_eq!(
        measured, predicted,
        "the measured and the predicted frequencies differ"
    );
}

/// The largest modulus of some slices.
pub(crate) fn largest(slices: &Array3<Complex>) -> f64 {
    slices.iter().map(|s| modulus(*s)).fold(0.0, f64::max)
}

/// Computes Σ a b in eight parallel sums. Matrix products of libraries round differently on
/// different processors, whereas these sums round in the same way on all processors.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest = a_rest.iter().zip(b_rest).map(|(a, b)| a * b);
    sums.into_iter().chain(rest).sum()
}
