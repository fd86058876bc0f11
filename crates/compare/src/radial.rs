//! Compares the radial spectrum of a plane with its prediction.

use crate::power::{BinDifference, PowerReport, PowerSums, crossed};
use etendue_field::{Complex, Slices};
use etendue_spectrum::Measurement;
use ndarray::{Array2, Array3, Axis};
use rayon::prelude::*;
use std::borrow::Cow;

/// Maximum number of groups of batches. Sixteen groups have enough choices of signs for the levels
/// of some hundred planes, and the time of the test grows with the fourth power of the number.
const MAX_GROUPS: usize = 16;

/// The two sides of the test of a radial spectrum, in groups of neighbouring batches and, if the
/// prediction has replicates, in groups of neighbouring replicates.
pub(crate) struct RadialTest<'a> {
    prediction: &'a Slices,
    /// The batches, and the replicates of the prediction.
    samples: [Vec<&'a Slices>; 2],
    /// The share of each group in the mean over batches.
    shares: Vec<f64>,
    /// The sum of each group's batches, divided by the number of all batches.
    measured: Vec<Array3<Complex>>,
    /// The prediction, if it is exact, or the mean of each group's replicates.
    predicted: Vec<Cow<'a, Array3<Complex>>>,
}

/// Tests the radial spectrum of plane `plane` of a measurement against slices that are the mean of
/// replicates. The slices are exact if there are no replicates.
///
/// # Panics
/// Panics if the frequencies of the plane differ from the frequencies of the prediction.
#[must_use]
pub fn radial(
    measurement: &Measurement,
    plane: usize,
    prediction: &Slices,
    replicates: &[Slices],
    seed: u64,
) -> PowerReport {
    RadialTest::new((measurement, plane), prediction, replicates).report(None, seed)
}

impl<'a> RadialTest<'a> {
    pub(crate) fn new(
        (measurement, plane): (&'a Measurement, usize),
        prediction: &'a Slices,
        replicates: &'a [Slices],
    ) -> Self {
        let batches = measurement.at_plane(plane).map(|batch| &batch.slices);
        let samples: [Vec<&Slices>; 2] = [batches.collect(), replicates.iter().collect()];
        let sizes = samples.iter().map(Vec::len).filter(|size| *size > 0);
        let count = sizes.fold(MAX_GROUPS, usize::min);
        let all = samples[0].len();
        let (shares, measured) = groups(&samples[0], count)
            .map(|members| (members.len() as f64 / all as f64, sum(members, all)))
            .unzip();
        let predicted = if replicates.is_empty() {
            vec![Cow::Borrowed(&prediction.half)]
        } else {
            let groups = groups(&samples[1], count);
            groups
                .map(|members| Cow::Owned(sum(members, members.len())))
                .collect()
        };
        Self {
            prediction,
            samples,
            shares,
            measured,
            predicted,
        }
    }

    /// Every number of the test. `forgiven` is subtracted from the measured slices: a part
    /// of the difference that systematic errors may cause.
    pub(crate) fn report(&self, forgiven: Option<&Array3<Complex>>, seed: u64) -> PowerReport {
        let rho = 0..self.prediction.grid.half_shape()[1];
        let of_row = |rho| self.sums(rho, forgiven);
        let rows: Vec<PowerSums> = rho.into_par_iter().map(of_row).collect();
        let mut sums = PowerSums::new(self.shares.len());
        rows.iter().for_each(|row| sums.merge(row));
        sums.report(seed)
    }

    /// The sums over the bins of one ρ.
    fn sums(&self, rho: usize, forgiven: Option<&Array3<Complex>>) -> PowerSums {
        let (grid, groups) = (&self.prediction.grid, self.shares.len());
        let mut sums = PowerSums::new(groups);
        for nu in 0..grid.half_shape()[2] {
            if !grid.is_independent(rho, nu) {
                continue;
            }
            let at = [rho, nu];
            let forgiven = forgiven.map(|forgiven| values(forgiven, at));
            let measured = self.measured.iter().zip(&self.shares);
            let measured = measured.map(|(half, share)| {
                let mut values = values(half, at);
                for (value, part) in values.iter_mut().zip(forgiven.iter().flatten()) {
                    *value -= part * share;
                }
                values
            });
            let predicted = self.predicted.iter().map(|half| values(half, at));
            let products = products(&measured.chain(predicted).collect::<Vec<_>>());
            let power = match self.predicted.len() {
                1 => products[[groups, groups]],
                _ => crossed(products.view(), groups),
            };
            let difference = BinDifference::new(products.view(), &self.shares);
            let variance = match self.noise(at) {
                Some(noise) => noise + difference.variance_of_pairs(),
                None => difference.variance(),
            };
            sums.add(&difference, variance, power);
        }
        sums
    }

    /// The variance of 2 F·(S − F) at a frequency, from the scatter within groups. Returns
    /// `None` if a group has a single member.
    ///
    /// A wrong prediction moves all batches of a group alike, so it does not raise this variance.
    /// The scatter between groups would grow with the fault and hide it.
    fn noise(&self, at: [usize; 2]) -> Option<f64> {
        let predicted = values(&self.prediction.half, at);
        let of_group = |members: &[&Slices]| {
            let along = members.iter();
            let along = along.map(|slices| dot(&values(&slices.half, at), &predicted));
            let along: Vec<f64> = along.collect();
            let count = along.len() as f64;
            let mean = along.iter().sum::<f64>() / count;
            let squares: f64 = along.iter().map(|value| (value - mean).powi(2)).sum();
            (count > 1.0).then(|| squares * count / (count - 1.0))
        };
        let samples = self.samples.iter().filter(|sample| !sample.is_empty());
        let of_samples = samples.map(|sample| {
            let all = sample.len() as f64;
            let sum: Option<f64> = groups(sample, self.shares.len()).map(of_group).sum();
            Some(4.0 * sum? / (all * all))
        });
        of_samples.sum()
    }
}

/// Returns `count` groups of neighbouring slices.
fn groups<'s, 'a>(
    slices: &'s [&'a Slices],
    count: usize,
) -> impl Iterator<Item = &'s [&'a Slices]> {
    let all = slices.len();
    (0..count).map(move |group| &slices[group * all / count..(group + 1) * all / count])
}

/// The sum of some slices divided by `all`.
fn sum(members: &[&Slices], all: usize) -> Array3<Complex> {
    let mut sum = Array3::zeros(members[0].half.raw_dim());
    members.iter().for_each(|slices| sum += &slices.half);
    sum / Complex::from(all as f64)
}

/// The values at a frequency [ρ, ν] at all azimuths.
fn values(half: &Array3<Complex>, [rho, nu]: [usize; 2]) -> Vec<Complex> {
    let row = half.index_axis(Axis(1), rho);
    row.index_axis(Axis(1), nu).to_vec()
}

/// The mean over azimuths of Re(a conj b).
fn dot(a: &[Complex], b: &[Complex]) -> f64 {
    let products = a.iter().zip(b).map(|(a, b)| a.re * b.re + a.im * b.im);
    products.sum::<f64>() / a.len() as f64
}

/// The products of spectra at one frequency.
fn products(spectra: &[Vec<Complex>]) -> Array2<f64> {
    let mut products = Array2::zeros((spectra.len(), spectra.len()));
    for (i, a) in spectra.iter().enumerate() {
        for (j, b) in spectra[..=i].iter().enumerate() {
            products[[i, j]] = dot(a, b);
            products[[j, i]] = products[[i, j]];
        }
    }
    products
}
