//! The numbers of a study: what is predicted and found for each sampler at a plane.

use crate::variance::found::{SetFamily, variance_of};
use crate::variance::measured_power::{MeasuredPower, box_frequencies};
use crate::variance::power_estimate::{PowerEstimate, jackknife_error};
use crate::variance::power_law::fitted_slope;
use crate::variance::prediction::{MAX_FILE_TAIL, PredictedVariance};
use crate::variance::radiance::{WindowMoments, WindowRadiance};
use crate::variance::response::SamplerResponse;
use crate::variance::sampler::Sampler;
use etendue_spectrum::Uncertain;
use serde::Serialize;

/// The names of the axes of the window coordinates, in their order.
pub const AXES: [&str; 4] = ["x", "u", "y", "v"];

/// The power of the field at frequencies at which a fixed set of coordinates is not zero.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AxisSetPower {
    /// The axes whose coordinates are not zero.
    pub axes: Vec<&'static str>,
    /// The power as a share of σ², inside the box of measured frequencies.
    pub share: Uncertain,
}

/// The numbers of one sampler.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SamplerReport {
    /// Name of the sampler.
    pub sampler: String,
    /// The variances of sets that are shifted on the torus at random.
    pub shifted: VarianceCurve,
    /// The variances of sets that are not shifted, if they are requested, the cells of the sampler
    /// are dyadic blocks, and the points are not independent.
    pub unshifted: Option<VarianceCurve>,
}

/// The variances of one sampler against the number of points N.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VarianceCurve {
    /// The slope of log Var against log N as predicted: a least-squares fit in which all numbers of
    /// points count the same. `None` if there are fewer than two numbers of points.
    pub predicted_slope: Option<f64>,
    /// The slope as found; numbers of points count by their errors.
    pub found_slope: Option<Uncertain>,
    /// The numbers at each N.
    pub counts: Vec<CountReport>,
}

/// The variance of the mean at N points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CountReport {
    /// N.
    pub count: usize,
    /// The predicted variance.
    pub predicted: Uncertain,
    /// The share of the dyadic tail in the predicted variance.
    pub tail: f64,
    /// The variance found, with its standard error.
    pub found: Uncertain,
    /// Predicted / found, with its standard error.
    pub ratio: Uncertain,
    /// N · Var/σ² as predicted: 1 for independent points if radiances are exact, smaller is better.
    pub predicted_gain: f64,
    /// N · Var/σ² as found.
    pub found_gain: f64,
    /// Whether the prediction is undecided: the set is fixed, and the tail is too large.
    pub is_undecided: bool,
    /// The frequencies at which a shifted sampler is worse than independent points.
    pub worse: Option<WorsePower>,
}

/// The power of the field at frequencies at which a sampler is worse than independent points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorsePower {
    /// The power at these frequencies, as a share of σ².
    pub share: f64,
    /// The worst of these frequencies, each with all its signs. At most [`MAX_WORST`].
    pub worst: Vec<WorstFrequency>,
}

/// A frequency at which a sampler is worse than independent points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorstFrequency {
    /// The moduli of the coordinates (x, u, y, v), cycles per window.
    pub frequency: [usize; 4],
    /// N · E|S_m|², which is 1 for independent points. The largest value over the signs.
    pub ratio: f64,
    /// The power of the field at all signs, as a share of σ².
    pub share: f64,
}

/// The largest number of worst frequencies in a report.
pub const MAX_WORST: usize = 3;

/// A sampler is worse than independent points if N · E|S_m|² exceeds 1 by more than rounding.
const ROUNDING: f64 = 1e-9;

/// What all samplers of a study share.
#[derive(Clone, Copy, Debug)]
pub struct WindowStudy<'a> {
    /// The measured power at frequencies.
    pub power: &'a MeasuredPower,
    /// The measured power in dyadic bands, if variances without shifts are requested.
    pub bands: Option<&'a PowerEstimate>,
    /// The radiance along rays.
    pub radiance: &'a WindowRadiance<'a>,
    /// The moments of the radiance.
    pub moments: &'a WindowMoments,
    /// Number of sets of points with which each variance is found.
    pub sets: u32,
    /// The seed of the sets of points.
    pub seed: u64,
}

/// Number of families of sets of each sampler: one for each number of points, with and without
/// shifts.
const FAMILIES: u64 = 256;

impl WindowStudy<'_> {
    /// Predicts and finds the variances of a sampler, at most 64 numbers of points. `progress` is
    /// called with 1 after each set of points.
    #[must_use]
    pub fn sampler(
        &self,
        sampler: &Sampler,
        counts: &[usize],
        progress: &(dyn Fn(u64) + Sync),
    ) -> SamplerReport {
        let shifted = |count: usize| {
            let response = SamplerResponse::new(sampler, count, self.power.max, self.seed)?;
            let worse = self.worse(&response, count);
            Some((&self.power.spectrum, response, Some(worse)))
        };
        let unshifted = |count: usize| {
            // A shift changes nothing about independent points.
            if *sampler == Sampler::Independent {
                return None;
            }
            Some((
                self.bands?,
                SamplerResponse::in_bands(sampler, count)?,
                None,
            ))
        };
        let curve = |is_shifted: bool| {
            let each = (0..).zip(sampler.counts(counts)).filter_map(|(i, count)| {
                let (power, response, worse) = if is_shifted {
                    shifted(count)
                } else {
                    unshifted(count)
                }?;
                let family = SetFamily {
                    seed: self.seed,
                    family: FAMILIES * sampler.number() + 2 * i + u64::from(is_shifted),
                    sets: self.sets,
                    is_shifted,
                };
                let predicted = PredictedVariance::new(power, &response, self.moments, count);
                let means = family.means(self.radiance, sampler, count, progress)?;
                let mut report = self.compared(sampler, count, predicted, &means);
                report.worse = worse;
                Some(report)
            });
            VarianceCurve::new(each.collect())
        };
        let unshifted = curve(false);
        SamplerReport {
            sampler: sampler.to_string(),
            shifted: curve(true),
            unshifted: (!unshifted.counts.is_empty()).then_some(unshifted),
        }
    }

    /// Compares a predicted variance with the variance of means.
    fn compared(
        &self,
        sampler: &Sampler,
        count: usize,
        predicted: PredictedVariance,
        means: &[f64],
    ) -> CountReport {
        let found = variance_of(means);
        let gain = |variance: f64| count as f64 * variance / self.moments.variance.value;
        let is_file = matches!(sampler, Sampler::File(_));
        CountReport {
            count,
            predicted: predicted.variance,
            tail: predicted.tail,
            found,
            ratio: ratio(predicted.variance, found),
            predicted_gain: gain(predicted.variance.value),
            found_gain: gain(found.value),
            is_undecided: is_file && predicted.tail > MAX_FILE_TAIL,
            worse: None,
        }
    }

    /// The frequencies at which a sampler is worse than independent points.
    fn worse(&self, response: &SamplerResponse, count: usize) -> WorsePower {
        let variance = self.moments.variance.value;
        let mut share = 0.0;
        let mut worst = std::collections::BTreeMap::<[usize; 4], (f64, f64)>::new();
        let all = box_frequencies(self.power.max);
        for ((m, power), expected) in all
            .iter()
            .zip(&self.power.spectrum.power)
            .zip(&response.inside)
        {
            let ratio = count as f64 * expected;
            if ratio > 1.0 + ROUNDING {
                share += power / variance;
                let signs = worst.entry(m.map(isize::unsigned_abs)).or_default();
                *signs = (signs.0.max(ratio), signs.1 + power / variance);
            }
        }
        let named = |(frequency, (ratio, share))| WorstFrequency {
            frequency,
            ratio,
            share,
        };
        let mut worst: Vec<WorstFrequency> = worst.into_iter().map(named).collect();
        worst.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
        worst.truncate(MAX_WORST);
        WorsePower { share, worst }
    }
}

impl VarianceCurve {
    fn new(counts: Vec<CountReport>) -> Self {
        let of = |value: fn(&CountReport) -> Uncertain| {
            let all = counts.iter().map(|report| (report.count, value(report)));
            all.collect::<Vec<_>>()
        };
        Self {
            predicted_slope: fitted_slope(&of(|r| r.predicted), false).map(|slope| slope.value),
            found_slope: fitted_slope(&of(|r| r.found), true),
            counts,
        }
    }
}

/// The power of each of the 15 sets of axes as a share of σ². Sets with fewer axes come
/// first. A Latin hypercube removes the power of single axes, and padding removes the power of sets
/// inside one of its pairs.
#[must_use]
pub fn axis_sets(power: &MeasuredPower, moments: &WindowMoments) -> Vec<AxisSetPower> {
    let all = box_frequencies(power.max);
    let set_of = |m: &[isize; 4]| {
        let nonzero = m.iter().enumerate().filter(|(_, m)| **m != 0);
        nonzero.fold(0_usize, |set, (axis, _)| set | 1 << axis)
    };
    let sets: Vec<usize> = all.iter().map(set_of).collect();
    let mut order: Vec<usize> = (1..16).collect();
    order.sort_by_key(|set| (set.count_ones(), *set));
    let share = |set: usize| {
        let (value, without) = power.spectrum.estimates(|power| {
            let inside = power.iter().zip(&sets).filter(|(_, other)| **other == set);
            inside.map(|(p, _)| p).sum::<f64>() / moments.variance.value
        });
        let of_photons = jackknife_error(&without);
        let of_variance = value * moments.variance.error / moments.variance.value;
        Uncertain {
            value,
            error: (of_photons * of_photons + of_variance * of_variance).sqrt(),
        }
    };
    let named = |set: usize| AxisSetPower {
        axes: (0..4)
            .filter(|axis| set >> axis & 1 == 1)
            .map(|axis| AXES[axis])
            .collect(),
        share: share(set),
    };
    order.into_iter().map(named).collect()
}

/// The ratio of two independent numbers.
fn ratio(a: Uncertain, b: Uncertain) -> Uncertain {
    let value = a.value / b.value;
    let [of_a, of_b] = [a, b].map(|number| number.error / number.value);
    Uncertain {
        value,
        error: value.abs() * (of_a * of_a + of_b * of_b).sqrt(),
    }
}
