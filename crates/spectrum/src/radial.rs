//! Averages power spectra over azimuths.

use crate::bandwidth::{Along, Widest, widest_slice};
use crate::estimate::TooFewBatches;
use crate::jackknife::{Jackknife, Uncertain};
use crate::measurement::Measurement;
use etendue_field::{Complex, SliceGrid, Slices};
use ndarray::{Array1, Array2, Array3, ArrayView2, ArrayView3, Axis, Slice};
use std::ops::Range;

/// The measured radial power of a plane, which is |S_φ|² averaged over the azimuths φ. The arrays
/// are [ρ, ν], both ascending.
#[derive(Clone, Debug)]
pub struct RadialPower {
    /// The power without the noise of the photons. The estimate of the power is unbiased, and noise
    /// can make the estimate negative.
    pub power: Array2<f64>,
    /// The power that the photons' noise adds to the mean spectrum; `power` does not include it.
    pub shot_noise: Array2<f64>,
    /// The standard error of `power`, by the delete-one jackknife over R batches. At frequencies
    /// that contain only noise, this error is conservative: it is √(2(R−1)/(R−2)) times too
    /// large.
    pub sigma: Array2<f64>,
}

/// The power spectrum U of a plane from products of independent batches (docs/theory.md (13)).
///
/// U = (|Σ S_r|² − Σ |S_r|²)/(R(R−1)),
///
/// U is the mean of Re(S_r conj S_s) over all pairs of batches r ≠ s. The noise of any two
/// batches is independent, so U is an unbiased estimate of |F|² even if the photons of one batch
/// are correlated.
///
/// If batch r is left out, the estimate is (T − 2 row_r)/((R−1)(R−2)), where T is R(R−1) U and
/// row_r is Σ_(s≠r) Re(S_r conj S_s). The jackknife therefore needs no copies of the slices.
#[derive(Clone, Debug)]
pub struct CrossPower<'m> {
    grid: SliceGrid,
    batches: Vec<&'m Slices>,
    /// The range of azimuths over which to average.
    azimuths: Range<usize>,
    /// The sum Σ S_r at the azimuths of the range, [azimuth, ρ ≥ 0, ν].
    sum: Array3<Complex>,
    /// The sum T over pairs at the azimuths of the range, [azimuth, ρ ≥ 0, ν].
    pairs: Array3<f64>,
}

/// The minimum number of batches for a jackknife.
const NEED: usize = 3;

impl<'m> CrossPower<'m> {
    /// Computes the cross power of plane `plane` over all azimuths.
    ///
    /// # Errors
    ///
    /// Fails if there are fewer than three batches, the minimum for a jackknife.
    pub fn new(measurement: &'m Measurement, plane: usize) -> Result<Self, TooFewBatches> {
        let azimuths = 0..measurement.planes()[plane].grid.azimuths;
        Self::over(measurement, plane, azimuths)
    }

    /// Computes the cross power of one slice of a plane, with the index `azimuth`.
    ///
    /// # Errors
    ///
    /// Fails if there are fewer than three batches.
    ///
    /// # Panics
    ///
    /// Panics if the plane has no slice with this index.
    pub fn of_slice(
        measurement: &'m Measurement,
        plane: usize,
        azimuth: usize,
    ) -> Result<Self, TooFewBatches> {
        Self::over(measurement, plane, azimuth..azimuth + 1)
    }

    fn over(
        measurement: &'m Measurement,
        plane: usize,
        azimuths: Range<usize>,
    ) -> Result<Self, TooFewBatches> {
        let grid = measurement.planes()[plane].grid;
        let batches = measurement.at_plane(plane).map(|b| &b.slices).collect();
        Self::between(grid, batches, azimuths)
    }

    /// Computes the cross power of independent replicates of a prediction, over some of their
    /// azimuths.
    ///
    /// # Errors
    ///
    /// Fails if there are fewer than three replicates.
    ///
    /// # Panics
    ///
    /// Panics if the replicates have no slices at these azimuths.
    pub fn of_replicates(
        replicates: &'m [Slices],
        azimuths: Range<usize>,
    ) -> Result<Self, TooFewBatches> {
        let none = TooFewBatches {
            have: 0,
            need: NEED,
        };
        let grid = replicates.first().ok_or(none)?.grid;
        Self::between(grid, replicates.iter().collect(), azimuths)
    }

    fn between(
        grid: SliceGrid,
        batches: Vec<&'m Slices>,
        azimuths: Range<usize>,
    ) -> Result<Self, TooFewBatches> {
        let have = batches.len();
        if have < NEED {
            return Err(TooFewBatches { have, need: NEED });
        }
        let [_, rho, nu] = grid.half_shape();
        let mut sum = Array3::zeros([azimuths.len(), rho, nu]);
        let mut squares = Array3::zeros(sum.raw_dim());
        for slices in &batches {
            let half = at(&slices.half, &azimuths);
            sum += &half;
            squares.zip_mut_with(&half, |sum: &mut f64, s| *sum += s.norm_sqr());
        }
        let pairs = sum.mapv(|s: Complex| s.norm_sqr()) - squares;
        Ok(Self {
            grid,
            batches,
            azimuths,
            sum,
            pairs,
        })
    }

    /// The cross power of a single slice. `slice` is the index among the slices of this
    /// cross power.
    fn slice(&self, slice: usize) -> Self {
        let one = slice..slice + 1;
        let first = self.azimuths.start;
        Self {
            grid: self.grid,
            batches: self.batches.clone(),
            azimuths: first + slice..first + slice + 1,
            sum: at(&self.sum, &one).to_owned(),
            pairs: at(&self.pairs, &one).to_owned(),
        }
    }

    /// The power U averaged over the azimuths, [ρ, ν].
    #[must_use]
    pub fn power(&self) -> Array2<f64> {
        let r = self.batches.len() as f64;
        self.grid
            .unfold_radial((mean(&self.pairs) / (r * (r - 1.0))).view())
    }

    /// The power with the batch at index `left_out` left out, [ρ, ν].
    ///
    /// # Panics
    ///
    /// Panics if there is no batch with this index.
    #[must_use]
    pub fn without(&self, left_out: usize) -> Array2<f64> {
        let r = self.batches.len() as f64;
        let row = self.row(left_out);
        let power = (mean(&self.pairs) - mean(&row) * 2.0) / ((r - 1.0) * (r - 2.0));
        self.grid.unfold_radial(power.view())
    }

    /// Σ_(s≠r) Re(S_r conj S_s) for the batch r.
    fn row(&self, batch: usize) -> Array3<f64> {
        let mut row = Array3::zeros(self.sum.raw_dim());
        ndarray::Zip::from(&mut row)
            .and(at(&self.batches[batch].half, &self.azimuths))
            .and(&self.sum)
            .for_each(|row: &mut f64, s, sum| *row = (s.conj() * (sum - s)).re);
        row
    }

    /// The power that noise adds to the mean spectrum, [azimuth, ρ ≥ 0, ν].
    pub(crate) fn noise_at_azimuths(&self) -> Array3<f64> {
        let r = self.batches.len() as f64;
        self.sum.mapv(|s| s.norm_sqr() / (r * r)) - &self.pairs / (r * (r - 1.0))
    }

    /// The power at each azimuth, [azimuth, ρ ≥ 0, ν]: first from all batches, then with
    /// each batch left out in turn.
    pub(crate) fn at_azimuths(&self) -> impl Iterator<Item = Array3<f64>> {
        let r = self.batches.len() as f64;
        let without = (0..self.batches.len()).map(move |left_out| {
            (&self.pairs - self.row(left_out) * 2.0) / ((r - 1.0) * (r - 2.0))
        });
        std::iter::once(&self.pairs / (r * (r - 1.0))).chain(without)
    }

    /// The power, the shot noise and the standard error.
    #[must_use]
    pub fn radial(&self) -> RadialPower {
        let power = self.power();
        let r = self.batches.len() as f64;
        let of_mean = mean(&self.sum.mapv(|s| s.norm_sqr() / (r * r)));
        let mut jackknife = Jackknife::new(power.raw_dim());
        for left_out in 0..self.batches.len() {
            jackknife.add(&self.without(left_out));
        }
        RadialPower {
            shot_noise: self.grid.unfold_radial(of_mean.view()) - &power,
            sigma: jackknife.variance().mapv(f64::sqrt),
            power,
        }
    }

    /// The largest bandwidth over the azimuths and its standard error. The error belongs to
    /// the bandwidth at this azimuth. If the bandwidths of several azimuths are nearly equal, noise
    /// decides which of them is the largest, and the result exceeds the true value by about the
    /// error.
    pub fn bandwidth(&self, along: Along) -> Option<Widest<Uncertain>> {
        let (slice, value) = widest_slice(self.pairs.view(), &self.grid, along)?;
        let one = self.slice(slice);
        let missing = |power: ArrayView2<'_, f64>| Some(along.missing(power, &self.grid, value));
        let found = one.statistics(missing)?.map(|numbers| numbers.to_vec());
        Some(Widest {
            azimuth: self.grid.azimuth(one.azimuths.start),
            value: along.with_error(value, found.each_ref().map(Vec::as_slice), &self.grid),
        })
    }

    /// A statistic of the power, such as a slope, with its standard error by the
    /// delete-one jackknife, or with the error from noise alone if this is larger.
    ///
    /// Returns `None` if the statistic does not exist, either for all batches together or if any
    /// one batch is left out.
    pub fn statistic(&self, of: impl Fn(ArrayView2<'_, f64>) -> Option<f64>) -> Option<Uncertain> {
        let [values, errors] = self.statistics(|power| Some(ndarray::arr1(&[of(power)?])))?;
        Some(Uncertain {
            value: values[0],
            error: errors[0],
        })
    }

    /// The change of the bandwidth from this to `other`, at the azimuth where this bandwidth is
    /// largest: see [`CrossPower::change`].
    pub fn bandwidth_change(&self, other: &Self, along: Along) -> Option<Uncertain> {
        let (slice, _) = widest_slice(self.pairs.view(), &self.grid, along)?;
        let [a, b] = [self, other].map(|of| of.slice(slice));
        a.change(&b, |power| along.bandwidth(power, &self.grid))
    }

    /// The change of a statistic from this to `other`, of which each batch has the same random
    /// numbers as that of this, and its standard error by the delete-one jackknife over pairs of
    /// batches.
    pub fn change(
        &self,
        other: &Self,
        of: impl Fn(ArrayView2<'_, f64>) -> Option<f64>,
    ) -> Option<Uncertain> {
        let mut jackknife = Jackknife::new(ndarray::Ix0());
        for left_out in 0..self.batches.len() {
            let [a, b] = [self, other].map(|of| of.without(left_out));
            jackknife.add(&ndarray::arr0(of(b.view())? - of(a.view())?));
        }
        Some(Uncertain {
            value: of(other.power().view())? - of(self.power().view())?,
            error: jackknife.variance().into_scalar().sqrt(),
        })
    }

    /// Returns several statistics of the power, and their standard errors as in
    /// [`CrossPower::statistic`].
    fn statistics(
        &self,
        of: impl Fn(ArrayView2<'_, f64>) -> Option<Array1<f64>>,
    ) -> Option<[Array1<f64>; 2]> {
        let values = of(self.power().view())?;
        let mut jackknife = Jackknife::new(values.raw_dim());
        for left_out in 0..self.batches.len() {
            jackknife.add(&of(self.without(left_out).view())?);
        }
        let mut errors = jackknife.variance();
        errors.zip_mut_with(&self.noise_alone(&values, of)?, |own, noise| {
            *own = own.max(*noise).sqrt();
        });
        Some([values, errors])
    }

    /// The variance of a statistic if the power were noise alone: 2/(R(R−1)) times the
    /// variance of what a pair of batches adds.
    ///
    /// The jackknife varies with Σ S, which is zero by chance now and then where there is only noise.
    /// Then the power is lowest, and the jackknife would give almost no error. Pairs do not depend
    /// on Σ S.
    fn noise_alone(
        &self,
        values: &Array1<f64>,
        of: impl Fn(ArrayView2<'_, f64>) -> Option<Array1<f64>>,
    ) -> Option<Array1<f64>> {
        let r = self.batches.len() as f64;
        // A step as large as those of the jackknife.
        let step = 1.0 / (r * r.sqrt());
        let still = self.power() * (1.0 - step);
        let mut added = Jackknife::new(values.raw_dim());
        for pair in self.batches.chunks_exact(2) {
            let [a, b] = [pair[0], pair[1]].map(|slices| at(&slices.half, &self.azimuths));
            let products = ndarray::Zip::from(&a)
                .and(&b)
                .map_collect(|a, b| (a.conj() * b).re);
            let pair = self.grid.unfold_radial(mean(&products).view());
            added.add(&((of((pair * step + &still).view())? - values) / step));
        }
        Some(added.sample_variance() * (2.0 / (r * (r - 1.0))))
    }
}

/// The slices at some azimuths.
fn at<'a, T>(slices: &'a Array3<T>, azimuths: &Range<usize>) -> ArrayView3<'a, T> {
    slices.slice_axis(Axis(0), Slice::from(azimuths.clone()))
}

/// The mean of slices over azimuths.
fn mean(slices: &Array3<f64>) -> Array2<f64> {
    slices.sum_axis(Axis(0)) / slices.len_of(Axis(0)) as f64
}
