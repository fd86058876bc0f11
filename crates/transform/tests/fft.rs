//! Tests of the 4D transform against the plain sum.

use crate::random::Random;
use etendue_field::Complex;
use etendue_transform::{RealFft4, real, real_mut};
use std::f64::consts::TAU;

/// Random reals laid out for `plan`.
fn field(plan: &RealFft4, seed: u64) -> Vec<Complex> {
    let mut random = Random(seed);
    // The unused part of a row must not be read, so it is filled too.
    let mut data = vec![Complex::new(1e9, -1e9); plan.size()];
    for row in data.chunks_exact_mut(plan.row()) {
        for l in 0..plan.shape()[3] {
            *real_mut(row, l) = random.within(1.0);
        }
    }
    data
}

fn indices([n0, n1, n2, n3]: [usize; 4]) -> impl Iterator<Item = [usize; 4]> {
    let all = move |i| [i / (n1 * n2 * n3), i / (n2 * n3) % n1, i / n3 % n2, i % n3];
    (0..n0 * n1 * n2 * n3).map(all)
}

/// The plain sum at `frequency`.
fn plain(shape: [usize; 4], reals: &[f64], frequency: [usize; 4]) -> Complex {
    let term = |(z, f): ([usize; 4], &f64)| {
        let cycles =
            |axis: usize| (z[axis] * frequency[axis] % shape[axis]) as f64 / shape[axis] as f64;
        Complex::from_polar(*f, -TAU * (0..4).map(cycles).sum::<f64>())
    };
    indices(shape).zip(reals).map(term).sum()
}

fn reals(plan: &RealFft4, data: &[Complex]) -> Vec<f64> {
    let rows = data.chunks_exact(plan.row());
    rows.flat_map(|row| (0..plan.shape()[3]).map(|l| real(row, l)))
        .collect()
}

/// The largest difference between the transform and the plain sum, relative to the root
/// mean square of the plain sum.
fn error(shape: [usize; 4]) -> f64 {
    let plan = RealFft4::new(shape);
    let mut data = field(&plan, 7);
    let reals = reals(&plan, &data);
    plan.forward(&mut data);
    let half = [shape[0], shape[1], shape[2], plan.row()];
    let (mut largest, mut square) = (0.0_f64, 0.0);
    for (frequency, found) in indices(half).zip(&data) {
        let expected = plain(shape, &reals, frequency);
        largest = largest.max((found - expected).norm());
        square += expected.norm_sqr();
    }
    largest / (square / plan.size() as f64).sqrt()
}

const SMALL: [[usize; 4]; 9] = [
    [1, 1, 1, 1],
    [2, 3, 4, 5],
    [5, 4, 3, 2],
    [3, 3, 3, 3],
    [4, 4, 4, 4],
    [1, 2, 1, 7],
    [7, 1, 3, 6],
    [3, 5, 17, 1],
    [8, 6, 2, 10],
];

#[test]
fn the_transform_is_the_plain_sum() {
    for shape in SMALL {
        let error = error(shape);
        assert!(error < 1e-14, "{shape:?}: {error}"); // rounding of sums of 960 terms
    }
}

#[test]
fn arrays_are_padded_by_rows() {
    for shape in SMALL {
        let plan = RealFft4::new(shape);
        let mut random = Random(6);
        let count = shape.iter().product();
        let values: Vec<f64> = (0..count).map(|_| random.unit()).collect();
        assert_eq!(reals(&plan, &plan.padded(&values)), values);
    }
}

/// Tests a shape that has several bands of the first axis and several blocks of columns. Some of
/// the bands and blocks are incomplete.
#[test]
fn large_shapes_are_put_together_right() {
    let shape = [6, 10, 9, 14];
    let plan = RealFft4::new(shape);
    let mut data = field(&plan, 8);
    let reals = reals(&plan, &data);
    plan.forward(&mut data);
    let half = [shape[0], shape[1], shape[2], plan.row()];
    let scale = (reals.len() as f64 / 3.0).sqrt(); // root mean square of F
    for (frequency, found) in indices(half).zip(&data).step_by(37) {
        let off = (found - plain(shape, &reals, frequency)).norm();
        assert!(off < 1e-13 * scale, "{frequency:?}: {off}"); // rounding of sums of 7560 terms
    }
}

#[test]
fn power_is_the_sum_of_squares() {
    for shape in [[12, 10, 9, 15], [16, 12, 10, 20]] {
        let plan = RealFft4::new(shape);
        let mut data = field(&plan, 9);
        let reals = reals(&plan, &data);
        plan.forward(&mut data);
        let weight = |m: usize| {
            if m == 0 || 2 * m == shape[3] {
                1.0
            } else {
                2.0
            }
        };
        let powers = data.iter().enumerate();
        let power: f64 = powers
            .map(|(i, z)| weight(i % plan.row()) * z.norm_sqr())
            .sum();
        let squares: f64 = reals.iter().map(|f| f * f).sum();
        assert!((power / (squares * reals.len() as f64) - 1.0).abs() < 1e-13); // rounding
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let plan = RealFft4::new([10, 12, 9, 16]);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let mut data = field(&plan, 10);
        pool.build().unwrap().install(|| plan.forward(&mut data));
        data
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(5));
}
