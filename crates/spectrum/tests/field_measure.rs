//! Tests the measured light field of a plane on a 4D grid, and the field's full radial spectrum.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use crate::common::{Random, Shower, boxed, grid, hann, plane};
use etendue_field::{Assignment, Crossing, Ledger, PhotonSource, Quantity, TwoPlane, VirtualPlane};
use etendue_spectrum::field::{
    FieldMeasurement, FieldOptions, RadialBins, full_radial_of, measure_field,
};
use etendue_spectrum::{estimate, measure};
use ndarray::Array2;
use std::sync::atomic::{AtomicU64, Ordering};

fn planes() -> Vec<VirtualPlane> {
    let (first, second) = (hann(), boxed());
    vec![
        plane("first", first, grid(&first, 4, [4, 5], 1.0)),
        plane("second", second, grid(&second, 2, [5, 4], 1.0)),
    ]
}

fn shower() -> Shower {
    Shower {
        seed: 21,
        photons: 4_003,
        batches: 20,
        planes: planes(),
    }
}

fn options(groups: usize) -> FieldOptions {
    FieldOptions {
        groups,
        ..FieldOptions::default()
    }
}

fn run(source: &dyn PhotonSource, plane: &VirtualPlane, groups: usize) -> FieldMeasurement {
    measure_field(source, 0, plane, 0..20, &options(groups), &|_| ()).unwrap()
}

#[test]
fn threads_and_memory_do_not_change_a_bit() {
    let source = shower();
    let on = |threads, keep| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let options = FieldOptions { keep, ..options(7) };
        let run = || measure_field(&source, 1, &source.planes[1], 0..20, &options, &|_| ());
        pool.build().unwrap().install(run).unwrap()
    };
    let one = on(1, false);
    assert_eq!(one, on(2, false));
    assert_eq!(one, on(5, false));
    assert_eq!(one, on(3, true));
    assert!(one.full_radial.sigma.iter().all(|sigma| *sigma > 0.0));
}

/// Checks that the grid and the slices have the same photons, tallies and means over batches.
#[test]
fn the_grid_sees_what_the_slices_see() {
    let source = shower();
    let measurement = measure(&source, &source.planes, 0..20, &|_| ());
    for (index, plane) in source.planes.iter().enumerate() {
        let field = measure_field(&source, index, plane, 0..20, &options(16), &|_| ()).unwrap();
        assert_eq!(field.tally, measurement.tally(index));
        let slices = estimate::slices(&measurement, index).unwrap().mean;
        let zero = slices.at_zero();
        assert!((field.spectrum.at_zero() / zero - 1.0).abs() < 2e-7); // the error of the slices
        let sum = field.field.sum() * field.grid.cell_volume();
        assert!((sum / zero - 1.0).abs() < 2e-7);
        let aliasing = field.spectrum.aliasing(&slices, 1.0).unwrap();
        assert!(aliasing.difference < aliasing.bound);
        assert!((0.3..3.0).contains(&(aliasing.difference / aliasing.expected))); // few frequencies
    }
}

/// A source that emits the photons of one batch in every batch.
struct Same(Shower);

impl PhotonSource for Same {
    fn emitted(&self, _: u32) -> u64 {
        self.0.emitted(0)
    }

    fn emit(
        &self,
        _: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        self.0.emit(0, record, progress)
    }
}

fn largest(values: &Array2<f64>) -> f64 {
    values.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

#[test]
fn batches_that_agree_have_no_noise() {
    let source = Same(shower());
    let plane = &source.0.planes[0];
    for groups in [20, 7, 3] {
        // The 20 batches are divided into 7 or 3 groups of unequal size.
        let field = run(&source, plane, groups);
        #[expect(clippy::cast_possible_truncation, reason = "a few")]
        let value = |frequency: [f64; 4]| {
            let whole = |axis: usize| (frequency[axis] / field.grid.spacing(axis)).round() as isize;
            field.spectrum.at([whole(0), whole(1), whole(2), whole(3)])
        };
        let expected = full_radial_of(&field.grid, value);
        let scale = largest(&expected);
        let radial = &field.full_radial;
        assert!(largest(&(&radial.power - &expected)) < 1e-13 * scale); // rounding
        assert!(largest(&radial.shot_noise) < 1e-13 * scale);
        assert!(largest(&radial.sigma) < 1e-12 * scale); // rounding of differences, times √groups
        let bins = RadialBins::new(&field.grid);
        assert_eq!(bins.power(&field.spectrum), expected);
        assert_eq!(bins.counts, radial.counts);
    }
}

/// A shower from which some batches are omitted.
struct Without<'a>(&'a Shower, &'a [u32]);

impl PhotonSource for Without<'_> {
    fn emitted(&self, batch: u32) -> u64 {
        if self.1.contains(&batch) {
            0
        } else {
            self.0.emitted(batch)
        }
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        self.0.emit(batch, record, progress)
    }
}

/// Checks the errors against a jackknife in which each group is left out because its photons are
/// not emitted.
#[test]
fn the_jackknife_leaves_groups_out() {
    let source = shower();
    let plane = &source.planes[0];
    let whole = run(&source, plane, 20).full_radial;
    let powers: Vec<_> = (0..20)
        .map(|r| run(&Without(&source, &[r]), plane, 19).full_radial.power)
        .collect();
    let mean = powers
        .iter()
        .fold(Array2::<f64>::zeros(whole.power.raw_dim()), |sum, p| {
            sum + p
        })
        / 20.0;
    let mut variance = Array2::<f64>::zeros(mean.raw_dim());
    for power in &powers {
        variance += &(power - &mean).mapv(|d| d * d * 19.0 / 20.0);
    }
    let sigma = variance.mapv(f64::sqrt);
    assert!(largest(&(&whole.sigma - &sigma)) < 1e-10 * largest(&sigma)); // rounding of differences
    // The groups have unequal sizes: 20 batches in 3 groups make groups of 7, 7 and 6.
    let three = run(&source, plane, 3).full_radial;
    let groups = [0, 1, 2].map(|g| (g..20).step_by(3).collect::<Vec<u32>>());
    let bins = RadialBins::new(&run(&source, plane, 3).grid);
    let spectra = [0, 1, 2].map(|g| {
        let others: Vec<u32> = (0..20).filter(|b| !groups[g].contains(b)).collect();
        run(&Without(&source, &others), plane, 3).spectrum
    });
    // The definition of the power is Σ a_r a_s Re(S_r conj S_s) / Σ a_r a_s over r ≠ s.
    let share = |r: usize| groups[r].len() as f64 / 20.0;
    let pairs = [[0, 1], [0, 2], [1, 2]];
    let norm: f64 = pairs.iter().map(|[r, s]| share(*r) * share(*s)).sum();
    let [expected] = bins.means(|index| {
        let pair = |[r, s]: &[usize; 2]| {
            let product = spectra[*r].values[index] * spectra[*s].values[index].conj();
            share(*r) * share(*s) * product.re
        };
        [pairs.iter().map(pair).sum::<f64>() / norm]
    });
    assert!(largest(&(&three.power - &expected)) < 1e-12 * largest(&expected)); // rounding
}

/// A source of photons that cover a box and have weights of zero mean, so the field contains only
/// noise.
struct White(u64);

impl PhotonSource for White {
    fn emitted(&self, _: u32) -> u64 {
        100
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        _: &dyn Fn(u64),
    ) -> Ledger {
        let mut random = Random(self.0 * 1_000_003 + u64::from(batch) * 7919);
        let mut crossing = || {
            let Crossing { ray, weight } = random.crossing(&boxed(), 1.0);
            let weight = weight - 1.0;
            Crossing { ray, weight }
        };
        let crossings: Vec<_> = (0..100).map(|_| crossing()).collect();
        record(0, &crossings);
        Ledger::default()
    }
}

#[test]
fn shot_noise_is_removed() {
    let plane = plane("white", boxed(), grid(&boxed(), 2, [4, 5], 1.0));
    let (mut removed, mut left_in, mut variance, mut frequencies) = (0.0, 0.0, 0.0, 0.0);
    let trials = 40;
    // The expected noise power is E w²/N times the aliasing of white noise, averaged over the bins.
    // It is the same for every trial.
    for seed in 0..trials {
        let radial = run(&White(seed), &plane, 20).full_radial;
        let counts = radial.counts.mapv(|count| count as f64);
        removed += (&radial.power * &counts).sum();
        left_in += (&radial.shot_noise * &counts).sum();
        variance += (&radial.sigma * &counts).mapv(|s| s * s).sum();
        frequencies += counts.sum();
    }
    // Each complex number adds the variance noise² · R/(R−1) to the sum over the bins of a trial.
    // There are effectively half as many complex numbers as frequencies.
    let noise = left_in / frequencies;
    assert!(noise > 1.0 / 3.0 / 2000.0); // E w² = 1/3 over 2000 photons; aliases come on top
    let sd = noise * (2.0 / frequencies * 20.0 / 19.0).sqrt();
    let mean = removed / frequencies;
    // The tolerance is four standard deviations, times 1.5 because noise is not white on the grid
    // (its aliases grow towards Nyquist).
    assert!(mean.abs() < 4.0 * 1.5 * sd, "{mean} {sd}");
    assert!(noise > 50.0 * sd); // noise that is not removed would be noticed
    // If there is only noise, the jackknife's variance is 2(R−1)/(R−2) times the true variance.
    let ratio = variance / frequencies.powi(2) / (sd * sd) / (2.0 * 19.0 / 18.0);
    assert!((0.8..1.5).contains(&ratio), "{ratio}");
}

/// A source of one photon per batch, whose field is almost deterministic.
struct Lone(TwoPlane);

impl PhotonSource for Lone {
    fn emitted(&self, _: u32) -> u64 {
        4
    }

    fn emit(
        &self,
        _: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let (ray, weight) = (self.0, 2.0);
        record(0, &[Crossing { ray, weight }]);
        record(1, &[Crossing { ray, weight: 1e9 }]); // a crossing of another plane
        progress(4);
        Ledger::default()
    }
}

#[test]
fn the_quantity_is_a_factor() {
    let ray = TwoPlane {
        x: 0.1,
        y: -0.2,
        u: 0.25,
        v: 0.1,
    };
    let mut plane = plane("one", hann(), grid(&hann(), 2, [4, 4], 1.0));
    plane.quantity = Quantity::DifferentialIrradiance;
    let expected = 2.0 / 4.0 * hann().value(&ray) / (1.0 + 0.25 * 0.25 + 0.1 * 0.1_f64).powi(2);
    let traced = AtomicU64::new(0);
    let count = |photons| {
        traced.fetch_add(photons, Ordering::Relaxed);
    };
    let field = measure_field(&Lone(ray), 0, &plane, 0..5, &options(5), &count).unwrap();
    assert!((field.spectrum.at_zero() / expected - 1.0).abs() < 1e-14); // rounding
    assert_eq!(traced.into_inner(), 2 * 5 * 4);
    // The largest cell is the one that contains the photon.
    let cell = field
        .field
        .indexed_iter()
        .max_by(|a, b| a.1.total_cmp(b.1))
        .unwrap()
        .0;
    let near = |axis: usize, i: usize, t: f64| {
        (field.grid.center(axis, i) - t).abs() <= 0.51 * field.grid.cell_width(axis)
    };
    assert!(
        near(0, cell.0, 0.1)
            && near(1, cell.1, -0.2)
            && near(2, cell.2, 0.25)
            && near(3, cell.3, 0.1)
    );

    let planes = [plane.clone(), plane];
    let measurement = measure(&Lone(ray), &planes, 0..5, &|_| ());
    let slices = estimate::slices(&measurement, 0).unwrap().mean;
    assert!((slices.at_zero() / expected - 1.0).abs() < 2e-7); // the error of the slices
}

#[test]
fn too_few_batches_are_refused() {
    let source = shower();
    let refused = measure_field(&source, 0, &source.planes[0], 0..2, &options(16), &|_| ());
    assert_eq!(
        refused.unwrap_err().to_string(),
        "2 batches are too few for an error: at least 3 are needed"
    );
    // A single group is not allowed, so the minimum number of groups replaces it.
    assert_eq!(
        run(&source, &source.planes[0], 1),
        run(&source, &source.planes[0], 3)
    );
}

#[test]
fn memory_is_told_beforehand() {
    let grid = run(&shower(), &planes()[0], 3).grid;
    let of = |keep, threads| {
        FieldOptions {
            keep,
            ..options(16)
        }
        .bytes(&grid, threads)
            / grid.bytes()
    };
    assert_eq!([of(false, 2), of(false, 64), of(true, 2)], [4, 18, 18]);
    assert_eq!(FieldOptions::default().assignment, Assignment::Tsc);
}
