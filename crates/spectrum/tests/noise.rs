//! Tests the effect of photon noise on spectra, and the removal of this noise.

use crate::common::{Shower, boxed, grid, plane};
use etendue_field::{
    Complex, FrequencyAxis, Ledger, PhotonSource, SliceGrid, Slices, VirtualPlane,
};
use etendue_spectrum::bandwidth::Along;
use etendue_spectrum::{CrossPower, Measurement, estimate, measure, moments};
use etendue_transform::random::{self, Stream};
use ndarray::{Axis, Slice};
use std::f64::consts::TAU;

/// A measurement at azimuth 0 of photons that are uniform in a box one period wide: their
/// spectrum has no structure, only noise.
fn white(seed: u64, photons: u64, batches: u32, fineness: f64) -> Measurement {
    let window = boxed();
    let plane = plane("white", window, grid(&window, 1, [12, 16], fineness));
    let source = Inside(Shower {
        seed,
        photons,
        batches,
        planes: vec![plane],
    });
    let planes: &[VirtualPlane] = &source.0.planes;
    measure(&source, planes, 0..batches, &|_| ())
}

/// A shower in which every photon is inside the window.
struct Inside(Shower);

impl PhotonSource for Inside {
    fn emitted(&self, batch: u32) -> u64 {
        self.0.emitted(batch)
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[etendue_field::Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let mut inner = |plane: usize, block: &[etendue_field::Crossing]| {
            let mut block = block.to_vec();
            for crossing in &mut block {
                for t in [&mut crossing.ray.x, &mut crossing.ray.y] {
                    *t /= 1.0267;
                }
                for t in [&mut crossing.ray.u, &mut crossing.ray.v] {
                    *t /= 1.0267;
                }
            }
            record(plane, &block);
        };
        self.0.emit(batch, &mut inner, progress)
    }
}

/// The expectation of w² for weights w uniform in [0, 2).
const SQUARE: f64 = 4.0 / 3.0;

#[test]
fn white_noise_is_flat() {
    let (photons, batches) = (128_000, 64);
    let measurement = white(1, photons, batches, 1.0);
    let expected = SQUARE / (photons as f64 / f64::from(batches)); // of |S_r|²: Σw²/n²
    let grid = measurement.planes()[0].grid;
    let mut chi2 = 0.0;
    for m in 1..=grid.rho.half {
        let each = measurement.at_plane(0).map(|batch| {
            let slice = batch.slices.half.index_axis(Axis(0), 0);
            let row = slice.index_axis_move(Axis(0), m);
            row.mapv(|s| s.norm_sqr() / expected).sum()
        });
        // For noise, |S|² has an exponential distribution, so its standard deviation equals its
        // mean.
        let count = f64::from(batches) * grid.nu.count() as f64;
        let z = (each.sum::<f64>() / count - 1.0) * count.sqrt();
        chi2 += z * z;
    }
    let bins = grid.rho.half as f64;
    // The tolerance is four standard deviations of χ² with 12 degrees of freedom. If the
    // correction of the kernel had a tilt of 10 %, χ² would deviate by hundreds of standard
    // deviations.
    assert!(chi2 < bins + 4.0 * (2.0 * bins).sqrt(), "{chi2}");
    assert!(chi2 > 2.0, "{chi2}"); // below 2 with probability 1e-4: the noise would be too smooth
}

#[test]
fn removing_shot_noise_leaves_nothing_of_white_noise() {
    let (photons, batches) = (32_000, 64);
    let measurement = white(2, photons, batches, 1.0);
    let radial = CrossPower::new(&measurement, 0).unwrap().radial();
    let noise = SQUARE / photons as f64;
    // The frequencies in one half of the (ρ, ν) plane, without the line ρ = 0, are independent.
    let zero = measurement.planes()[0].grid.rho.half;
    let power = radial.power.slice_axis(Axis(0), Slice::from(zero + 1..));
    let count = power.len() as f64;
    let mean = power.sum() / count;
    // For each frequency, Var U = s⁴/(R(R−1)) with s² = R · noise. The tolerance is four standard
    // deviations of the mean over all frequencies.
    let sd = noise / count.sqrt() * (64.0_f64 / 63.0).sqrt();
    assert!(mean.abs() < 4.0 * sd, "{mean} {sd}");
    // If the noise were not removed, the mean would deviate by 20 standard deviations.
    let shot_noise = radial
        .shot_noise
        .slice_axis(Axis(0), Slice::from(zero + 1..));
    let left_in = shot_noise.sum() / count;
    assert!((left_in / noise - 1.0).abs() < 0.02, "{left_in}"); // Σw² of 32000 weights: 0.5 %, four of them
    assert!(left_in > 15.0 * sd);
    // If there is only noise, the jackknife's variance is 2(R−1)/(R−2) times the true variance.
    let sigma = radial.sigma.slice_axis(Axis(0), Slice::from(zero + 1..));
    let variance = sigma.mapv(|s| s * s).sum() / count;
    let ratio = variance / (sd * sd * count) / (2.0 * 63.0 / 62.0);
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}"); // 396 frequencies of 63 degrees of freedom: 1 %, tails more
}

#[test]
fn the_variance_of_the_slices_is_the_photons_noise() {
    let (photons, batches) = (32_000, 64);
    let measurement = white(3, photons, batches, 1.0);
    let estimate = estimate::slices(&measurement, 0).unwrap();
    let variance = estimate.variance.slice_axis(Axis(1), Slice::from(1..));
    let mean = variance.sum() / variance.len() as f64;
    let expected = SQUARE / photons as f64;
    // The mean over 396 frequencies with 63 degrees of freedom each has a relative error of 0.6
    // %; the tolerance is four times this error.
    assert!((mean / expected - 1.0).abs() < 0.025, "{}", mean / expected);
    assert_eq!(estimate.batches, 64);
    let projection = estimate::projection(&measurement, 0).unwrap();
    let cells = projection.mean.values.len() as f64;
    let mean = projection.mean.values.sum() / cells;
    // The expected mean is the mean weight 1, divided by the area 1.6 · 0.8. The sum of 32000
    // weights has a relative error of 0.3 %; the tolerance is four times this error.
    assert!((mean * 1.28 - 1.0).abs() < 0.013, "{mean}");
    let variance = projection.standard_error.mapv(|e| e * e).sum() / cells;
    let one = SQUARE * cells / (photons as f64 * 1.28 * 1.28);
    assert!((variance / one - 1.0).abs() < 0.05, "{}", variance / one); // 2 photons a cell, 16384 cells: 1 %
}

/// Tests the field of a box. The frequency grid is three times finer than the box's period
/// requires. The power of this field is known and is not zero.
#[test]
fn jackknife_intervals_cover_the_truth() {
    let (trials, batches) = (300, 16);
    let (mut covered, mut halved, mut statistics) = (0, 0, 0);
    for trial in 0..trials {
        let measurement = white(1_000 + trial, 3_200, batches, 3.0);
        let cross = CrossPower::new(&measurement, 0).unwrap();
        let grid: SliceGrid = measurement.planes()[0].grid;
        let [i, j] = [grid.rho.half + 1, grid.nu.half];
        // The true power is |F|² = sinc²(ρ · 1.6), because the mean weight is 1.
        let t = std::f64::consts::PI * grid.rho.value(i) * 1.6;
        let truth = (t.sin() / t).powi(2);
        let radial = cross.radial();
        let off = (radial.power[[i, j]] - truth).abs();
        let interval = 2.131 * radial.sigma[[i, j]]; // 97.5 % quantile of Student's t with 15 degrees of freedom
        covered += u32::from(off < interval);
        halved += u32::from(off < 0.5 * interval);

        // If a field has no shear, its slope is zero.
        let slope = cross.statistic(|power| moments::shear_slope(power, &grid));
        let slope = slope.unwrap();
        statistics += u32::from(slope.value.abs() < 2.131 * slope.error);
    }
    let share = |count: u32| f64::from(count) / trials as f64;
    // The expected share of the 300 trials is 95 %, with an error of 1.3 %. The bounds are three
    // times this error, plus 1 % for the error of the jackknife.
    assert!((0.90..0.99).contains(&share(covered)));
    assert!((0.90..0.995).contains(&share(statistics)));
    assert!(share(halved) < 0.80); // an interval of half the width covers only 70 %
}

#[test]
fn leaving_one_out_is_the_power_of_the_others() {
    let whole = white(4, 400, 8, 2.0);
    let cross = CrossPower::new(&whole, 0).unwrap();
    for left_out in [0, 3, 7] {
        let mut others = Measurement::new(whole.planes().to_vec());
        for batch in whole.batches().filter(|b| b.index != left_out) {
            others.insert(batch.clone()).unwrap();
        }
        let expected = CrossPower::new(&others, 0).unwrap().power();
        let found = cross.without(left_out as usize);
        let largest = expected.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let error = (found - expected)
            .iter()
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        assert!(error < 1e-13 * largest); // rounding of differences of sums of 8 squares
    }
}

/// Returns normal noise at frequency `m` of a batch; the real part has variance one.
fn noise(seed: u64, batch: u32, m: usize) -> Complex {
    let block = u32::try_from(m).expect("block fits 32 bits");
    let [a, b, ..] = random::words(seed, Stream::Photon, batch.into(), block).map(random::unit);
    Complex::from_polar((-2.0 * libm::log(a)).sqrt(), TAU * b)
}

/// The error of a bandwidth holds in noise of any strength: the power is even up to four steps, and
/// nothing but noise beyond them.
#[test]
fn bandwidths_are_within_their_errors_where_noise_is_strong() {
    let axis = |half| FrequencyAxis { half, spacing: 1.0 };
    let grid = SliceGrid {
        azimuths: 1,
        rho: axis(40),
        nu: axis(0),
    };
    // 1 + 2 · 3 + 2 · 0.775 is 95 % of 9.
    let truth = 3.5 + 0.775;
    for strength in [0.1, 0.5, 1.0, 2.0, 4.0] {
        let pulls = (0..100).filter_map(|seed| {
            let batch = |batch: u32| {
                let mut slices = Slices::zeros(grid);
                for m in 0..=grid.rho.half {
                    let field = if m <= 4 { 1.0 } else { 0.0 };
                    slices.half[[0, m, 0]] = field + strength * noise(seed, batch, m);
                }
                slices
            };
            let batches: Vec<Slices> = (0..64).map(batch).collect();
            let power = CrossPower::of_replicates(&batches, 0..1).unwrap();
            let found = power.bandwidth(Along::Rho)?.value;
            Some((found.value - truth) / found.error)
        });
        let pulls: Vec<f64> = pulls.collect();
        let squares: f64 = pulls.iter().map(|pull| pull * pull).sum();
        let rms = (squares / pulls.len() as f64).sqrt();
        let largest = pulls
            .iter()
            .fold(0.0, |most: f64, pull| most.max(pull.abs()));
        // A jackknife of the bandwidth itself is off by up to 300 of its errors where noise is
        // strong. The errors here are upper estimates there.
        assert!(rms < 1.2, "{strength}: {rms}"); // 100 trials: 7 %
        assert!(rms > 0.5 || strength > 0.5, "{strength}: {rms}");
        assert!(largest < 4.0, "{strength}: {largest}");
    }
}

/// The second moment of a constant light field with noise at one frequency alone. Its power is zero
/// on average, and it is lowest where the noise of all batches cancels. There, the jackknife alone
/// gives almost no error.
#[test]
fn a_moment_of_noise_is_within_its_error_even_where_noise_cancels() {
    const BATCHES: u32 = 64;
    let axis = |half| FrequencyAxis { half, spacing: 1.0 };
    let grid = SliceGrid {
        azimuths: 1,
        rho: axis(1),
        nu: axis(0),
    };
    let pulls = (0..400).map(|seed| {
        let batch = |batch: u32| {
            let mut slices = Slices::zeros(grid);
            slices.half[[0, 0, 0]] = Complex::new(1.0, 0.0);
            slices.half[[0, 1, 0]] = 0.1 * noise(seed, batch, 0);
            slices
        };
        let batches: Vec<Slices> = (0..BATCHES).map(batch).collect();
        let power = CrossPower::of_replicates(&batches, 0..1).unwrap();
        let found = power.statistic(|power| moments::second_moment(power, &grid, [2, 0]));
        let found = found.unwrap();
        found.value / found.error
    });
    let lowest = pulls.fold(0.0, f64::min);
    // The lowest power and the error of noise alone are equal but for the error of this error, of
    // 31 pairs: an eighth of it.
    assert!((-1.6..-0.6).contains(&lowest), "{lowest}");
}
