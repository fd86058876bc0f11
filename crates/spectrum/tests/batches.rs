//! Tests of batches, partial results and threads.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{Shower, boxed, grid, hann, plane};
use etendue_field::{Crossing, Ledger, PhotonSource, VirtualPlane};
use etendue_spectrum::{
    Measurement, MergeError, PartialBatch, Watch, estimate, measure, measure_watched,
};
use etendue_transform::direct;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

fn planes() -> Vec<VirtualPlane> {
    let (first, second) = (hann(), boxed());
    vec![
        plane("first", first, grid(&first, 4, [6, 9], 1.0)),
        plane("second", second, grid(&second, 3, [4, 4], 1.5)),
    ]
}

fn shower() -> Shower {
    Shower {
        seed: 5,
        photons: 5_003,
        batches: 10,
        planes: planes(),
    }
}

fn run(source: &Shower, batches: std::ops::Range<u32>) -> Measurement {
    measure(source, &source.planes, batches, &|_| ())
}

/// A source of photons whose batches have two parts. The first part has the photons at one plane of
/// a shower, and the second part has the photons at the other plane.
struct Parted(Shower);

impl PhotonSource for Parted {
    fn emitted(&self, batch: u32) -> u64 {
        self.0.emitted(batch)
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        self.0.emit(batch, record, progress)
    }

    fn parts(&self, _: u32) -> u32 {
        2
    }

    fn emit_part(
        &self,
        batch: u32,
        part: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        _: &dyn Fn(u64),
    ) -> Ledger {
        let mut of_part = |plane: usize, block: &[Crossing]| {
            if plane == part as usize {
                record(plane, block);
            }
        };
        let ledger = self.0.emit(batch, &mut of_part, &|_| ());
        ledger.scaled(0.5)
    }
}

/// Tests that the sum of the parts of a batch equals the batch, on any number of threads.
#[test]
fn parts_make_a_batch() {
    let whole = run(&shower(), 0..10);
    let parted = Parted(shower());
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let measured = pool
            .unwrap()
            .install(|| measure(&parted, &planes(), 0..10, &|_| ()));
        assert!(measured == whole, "{threads} threads");
    }
}

/// A source of two batches, each made of five batches of a shower.
struct Large(Shower);

impl PhotonSource for Large {
    fn emitted(&self, batch: u32) -> u64 {
        (0..5).map(|part| self.0.emitted(5 * batch + part)).sum()
    }

    fn emit(&self, _: u32, _: &mut dyn FnMut(usize, &[Crossing]), _: &dyn Fn(u64)) -> Ledger {
        panic!("it is emitted in parts")
    }

    fn parts(&self, _: u32) -> u32 {
        5
    }

    fn emit_part(
        &self,
        batch: u32,
        part: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        self.0.emit(5 * batch + part, record, progress)
    }
}

/// A [`Watch`] that stops the first batch after a given number of parts.
struct Stop {
    parts: u32,
    /// Number of parts of the batch in each partial sum, in the order of the callbacks.
    begun: Mutex<Vec<u32>>,
}

impl Watch for Stop {
    fn traced(&self, _: u64) {}

    fn should_continue(&self, batch: u32, part: u32) -> bool {
        batch > 0 || part < self.parts
    }

    fn begun(&self, batch: &PartialBatch) {
        if batch.index == 0 {
            self.begun.lock().unwrap().push(batch.parts);
        }
    }
}

/// Tests that the result is bitwise identical if a batch stops after any of its parts and continues
/// later, on any number of threads.
#[test]
fn a_batch_goes_on_where_it_was_left() {
    let source = Large(shower());
    let planes = planes();
    let whole = measure(&source, &planes, 0..2, &|_| ());
    assert_eq!(whole.emitted(), 5_003);
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.unwrap();
        for parts in 0..5 {
            let measured = |batches: Vec<PartialBatch>, watch: &Stop| {
                let mut batches = batches.into_iter();
                pool.install(|| measure_watched(&source, &planes, &mut batches, watch))
            };
            let watch = |parts| Stop {
                parts,
                begun: Mutex::default(),
            };
            let first = watch(parts);
            let (found, left) = measured([0, 1].map(PartialBatch::new).to_vec(), &first);
            // The partial sum contains all parts that were begun, and partial sums are reported
            // in the order of summation.
            assert_eq!(
                left.iter().map(|b| (b.index, b.parts)).collect::<Vec<_>>(),
                [(0, parts)]
            );
            let told = first.begun.into_inner().unwrap();
            assert!(
                told.is_sorted() && told.last().copied().unwrap_or(0) == parts,
                "{told:?}"
            );
            let (rest, none) = measured(left, &watch(5));
            assert!(none.is_empty());
            assert!(
                found.merge(rest).unwrap() == whole,
                "{threads} threads, {parts} parts"
            );
        }
    }
}

#[test]
fn a_batch_is_the_mean_over_its_emitted_photons() {
    let source = shower();
    let measurement = run(&source, 0..10);
    assert_eq!(measurement.emitted(), 5_003);
    for (batch, emitted) in measurement.batches().zip([501, 501, 501, 500]) {
        assert_eq!(batch.emitted, emitted);
        let mut crossings = vec![Vec::<Crossing>::new(); 2];
        source.emit(
            batch.index,
            &mut |plane, block| crossings[plane].extend(block),
            &|_| (),
        );
        for ((plane, measured), crossings) in
            source.planes.iter().zip(&batch.planes).zip(&crossings)
        {
            let mut plain = direct::slices(crossings, |z| plane.window.value(z), &plane.grid);
            plain.half.mapv_inplace(|s| s / batch.emitted as f64);
            let tolerance = 2e-7 * plain.at_zero(); // the bound stated at `SliceTransform`; weights are ≥ 0
            for (a, b) in plain.half.iter().zip(&measured.slices.half) {
                assert!((a - b).norm() < tolerance);
            }
            let inside = crossings.iter().filter(|c| plane.window.contains(&c.ray));
            assert_eq!(measured.tally.inside, inside.count() as u64);
            assert_eq!(measured.tally.crossed, crossings.len() as u64);
            assert!(measured.tally.outside > 20);
            let total = measured.projection.values.sum() * measured.projection.grid.cell_area();
            assert!((total / plain.at_zero() - 1.0).abs() < 1e-12); // the same sum in another order
        }
    }
    let tally = measurement.tally(1);
    assert_eq!(tally.crossed, 5_003);
    assert_eq!(tally.crossed, tally.inside + tally.outside);
    assert!(measurement.ledger().imbalance().abs() < 1e-15); // sums of ones
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let source = shower();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| run(&source, 0..10))
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(4));
    let other = Shower {
        seed: 6,
        ..shower()
    };
    assert_ne!(one, run(&other, 0..10));
}

#[test]
fn partial_results_merge_in_any_order() {
    let source = shower();
    let whole = run(&source, 0..10);
    let parts = || [run(&source, 0..3), run(&source, 3..4), run(&source, 4..10)];
    let [a, b, c] = parts();
    let forward = a.merge(b).unwrap().merge(c).unwrap();
    let [a, b, c] = parts();
    let backward = c.merge(b.merge(a).unwrap()).unwrap();
    assert_eq!(forward, whole);
    assert_eq!(backward, whole);
    let bits = |m: &Measurement| {
        let variance = estimate::slices(m, 0).unwrap().variance;
        variance.mapv(f64::to_bits)
    };
    assert_eq!(bits(&forward), bits(&backward));
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let source = shower();
    let twice = run(&source, 0..3).merge(run(&source, 2..4));
    assert_eq!(twice.unwrap_err(), MergeError::BatchTwice(2));

    let mut moved = planes();
    moved[1].distance += 1e-9;
    let other = measure(&source, &moved, 5..6, &|_| ());
    let refused = run(&source, 0..1).merge(other).unwrap_err();
    assert!(matches!(refused, MergeError::Planes(..)));

    let mut finer = planes();
    finer[0].grid.rho.half += 1;
    let batch = measure(&source, &finer, 5..6, &|_| ());
    let batch = batch.batches().next().unwrap().clone();
    let refused = run(&source, 0..1).insert(batch).unwrap_err();
    assert!(matches!(refused, MergeError::Shape { batch: 5, .. }));
}

#[test]
fn progress_tells_every_photon() {
    let source = shower();
    let traced = AtomicU64::new(0);
    let count = |photons| {
        traced.fetch_add(photons, Ordering::Relaxed);
    };
    let measurement = measure(&source, &source.planes, 0..10, &count);
    assert_eq!(measurement.emitted(), traced.into_inner());
}

#[test]
fn batches_that_emit_nothing_are_left_out() {
    let source = Shower {
        photons: 3,
        ..shower()
    };
    assert_eq!(run(&source, 0..10).batches().len(), 3);
    assert_eq!(run(&source, 5..10).batches().len(), 0);
    let none = estimate::slices(&run(&source, 5..10), 0);
    assert!(none.is_err());
}

/// Tests that the mean of two values a and b has the variance |a − b|²/4.
#[test]
fn two_batches_tell_their_error() {
    let measurement = run(&shower(), 0..2);
    let [a, b] = [0, 1].map(|r| measurement.at_plane(1).nth(r).unwrap());
    let slices = estimate::slices(&measurement, 1).unwrap();
    for (index, variance) in slices.variance.indexed_iter() {
        let (a, b) = (a.slices.half[index], b.slices.half[index]);
        assert!((variance - (a - b).norm_sqr() / 4.0).abs() < 1e-15); // rounding; values are below 1
        assert!((slices.mean.half[index] - (a + b) / 2.0).norm() < 1e-15);
    }
    let projection = estimate::projection(&measurement, 1).unwrap();
    for (index, error) in projection.standard_error.indexed_iter() {
        let difference = a.projection.values[index] - b.projection.values[index];
        assert!((error - difference.abs() / 2.0).abs() < 1e-14); // rounding; values are below 100
    }
    assert!(estimate::slices(&run(&shower(), 0..1), 1).is_err());
}
