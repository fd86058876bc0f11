//! Power spectra over azimuths.

use crate::bandwidth::{BANDWIDTH_FRACTION, SliceBandwidth, Widest, widest_slice};
use crate::estimate::TooFewBatches;
use crate::jackknife::{Jackknife, Uncertain};
use crate::measurement::Measurement;
use etendue_field::{Complex, SliceGrid, Slices};
use ndarray::{Array2, Array3, ArrayView2, ArrayView3, Axis, Slice};
use std::ops::Range;

/// The measured radial power of a plane: |S_φ|² averaged over the azimuths, [ρ, ν] ascending.
#[derive(Clone, Debug)]
pub struct RadialPower {
    /// The power without the noise of the photons: unbiased, and negative where noise has it so.
    pub power: Array2<f64>,
    /// What the photons' noise added to the power of the mean spectrum, and was left out.
    pub shot_noise: Array2<f64>,
    /// The standard error of `power`, by the delete-one jackknife over R batches. On the safe side where
    /// there is nothing but noise: there it is √(2(R−1)/(R−2)) times too large.
    pub sigma: Array2<f64>,
}

/// The power spectrum of a plane by crossing independent batches (docs/theory.md (13)):
///
/// U = (|Σ S_r|² − Σ |S_r|²)/(R(R−1)),
///
/// the mean of Re(S_r conj S_s) over all pairs r ≠ s. The noises of two batches are independent, so U is an
/// unbiased estimate of |F|² whatever the photons of one batch have in common.
///
/// Without batch r it is (T − 2 row_r)/((R−1)(R−2)), T being R(R−1) U and row_r = Σ_(s≠r) Re(S_r conj S_s):
/// no copies for the jackknife.
#[derive(Clone, Debug)]
pub struct CrossPower<'m> {
    grid: SliceGrid,
    batches: Vec<&'m Slices>,
    /// The azimuths that are averaged.
    azimuths: Range<usize>,
    /// Σ S_r at these azimuths, [azimuth, ρ ≥ 0, ν].
    sum: Array3<Complex>,
    /// T at these azimuths, [azimuth, ρ ≥ 0, ν].
    pairs: Array3<f64>,
}

/// Fewest batches of a jackknife.
const NEED: usize = 3;

impl<'m> CrossPower<'m> {
    /// The cross power of plane `plane`.
    ///
    /// # Errors
    ///
    /// With fewer than three batches, the least a jackknife can do with.
    pub fn new(measurement: &'m Measurement, plane: usize) -> Result<Self, TooFewBatches> {
        let azimuths = 0..measurement.planes()[plane].grid.azimuths;
        Self::over(measurement, plane, azimuths)
    }

    /// That of one slice, number `azimuth`.
    ///
    /// # Errors
    ///
    /// With fewer than three batches.
    ///
    /// # Panics
    ///
    /// When there are not so many slices.
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

    /// That of independent replicates of a prediction, over some of their azimuths.
    ///
    /// # Errors
    ///
    /// With fewer than three.
    ///
    /// # Panics
    ///
    /// When there are not so many slices.
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

    /// That of slice number `slice` of those here.
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

    /// The power U, [ρ, ν].
    #[must_use]
    pub fn power(&self) -> Array2<f64> {
        let r = self.batches.len() as f64;
        self.grid
            .unfold_radial((mean(&self.pairs) / (r * (r - 1.0))).view())
    }

    /// The power without batch number `left_out` of those there are, [ρ, ν].
    ///
    /// # Panics
    ///
    /// When there are not so many batches.
    #[must_use]
    pub fn without(&self, left_out: usize) -> Array2<f64> {
        let r = self.batches.len() as f64;
        let mut row = Array3::zeros(self.sum.raw_dim());
        ndarray::Zip::from(&mut row)
            .and(at(&self.batches[left_out].half, &self.azimuths))
            .and(&self.sum)
            .for_each(|row: &mut f64, s, sum| *row = (s.conj() * (sum - s)).re);
        let power = (mean(&self.pairs) - mean(&row) * 2.0) / ((r - 1.0) * (r - 2.0));
        self.grid.unfold_radial(power.view())
    }

    /// Power, shot noise and standard error.
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

    /// The largest bandwidth over the azimuths, with its standard error in that azimuth. Where several are alike noise chooses among them,
    /// and the largest is above each of them by about its error.
    pub fn bandwidth(&self, of: SliceBandwidth) -> Option<Widest<Uncertain>> {
        let (slice, _) = widest_slice(self.pairs.view(), &self.grid, of)?;
        let one = self.slice(slice);
        let value = one.statistic(|power| of(power, &self.grid, BANDWIDTH_FRACTION))?;
        let azimuth = self.grid.azimuth(one.azimuths.start);
        Some(Widest { azimuth, value })
    }

    /// A number read off the power, such as a slope, with its standard error by the jackknife.
    ///
    /// `None` when the number does not exist, with all batches or with one left out.
    pub fn statistic(&self, of: impl Fn(ArrayView2<'_, f64>) -> Option<f64>) -> Option<Uncertain> {
        let value = of(self.power().view())?;
        let mut jackknife = Jackknife::new(ndarray::Ix0());
        for left_out in 0..self.batches.len() {
            jackknife.add(&ndarray::arr0(of(self.without(left_out).view())?));
        }
        Some(Uncertain {
            value,
            error: jackknife.variance().into_scalar().sqrt(),
        })
    }
}

/// The slices at some azimuths.
fn at<'a, T>(slices: &'a Array3<T>, azimuths: &Range<usize>) -> ArrayView3<'a, T> {
    slices.slice_axis(Axis(0), Slice::from(azimuths.clone()))
}

/// The mean over azimuths.
fn mean(slices: &Array3<f64>) -> Array2<f64> {
    slices.sum_axis(Axis(0)) / slices.len_of(Axis(0)) as f64
}
