//! The response of a sampler to the power of a field: E|S_m|² inside the box of measured
//! frequencies, and its mean over the dyadic tail beyond the box.

use crate::variance::dyadic_power::{FINEST, bands};
use crate::variance::expected_power::ExpectedPower;
use crate::variance::measured_power::{box_frequencies, is_in_last_octave};
use crate::variance::sampler::{Sampler, WindowPoint};
use etendue_field::{Complex, whole};
use etendue_transform::random::{Stream, unit, words};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Number of octaves of the tail. The last octave has the power of all further octaves too.
const OCTAVES: u32 = 12;

/// The response of a sampler with N points to the parts of the power: at the frequencies |m_k| ≤ M,
/// if sets are shifted on the torus, or in dyadic bands, if they are not.
#[derive(Clone, Debug)]
pub struct SamplerResponse {
    /// E|S_m|², or its counterpart in a band; 0 for the mean of the field.
    pub(crate) inside: Vec<f64>,
    /// For each part of the last octave: the mean of E|S|² over the tail that repeats this part.
    /// Other parts have 0.
    ///
    /// The tail repeats the power at m at 2^k m, spread over 2^k whole numbers along each axis;
    /// coordinates that are 0 stay 0. Each octave has half the power of the octave before, as the
    /// power of edges has. In the same way, the tail repeats the band s at s + k.
    pub(crate) tail: Vec<f64>,
}

/// The share of the tail's power in octave `k`.
fn octave_share(k: u32) -> f64 {
    let halvings = if k == OCTAVES { k - 1 } else { k };
    libm::exp2(-f64::from(halvings))
}

impl SamplerResponse {
    /// The response of `count` points at the frequencies up to `max`. Returns `None` if the
    /// sampler has no sets of `count` points.
    #[must_use]
    pub fn new(sampler: &Sampler, count: usize, max: usize, seed: u64) -> Option<Self> {
        if let Sampler::File(file) = sampler {
            return Some(Self::of_points(&file.points, max, seed));
        }
        let expected = ExpectedPower::new(sampler, count)?;
        let grid = expected.grid(max);
        let octaves = expected.octaves(max, OCTAVES);
        let all = box_frequencies(max);
        let at = |m: &[isize; 4]| {
            m.iter()
                .fold(0, |index, m| index * (max + 1) + m.unsigned_abs())
        };
        let inside = |m: &[isize; 4]| if *m == [0; 4] { 0.0 } else { grid[at(m)] };
        let tail = |m: &[isize; 4]| {
            if !is_in_last_octave(m, max) {
                return 0.0;
            }
            let octaves = (1..).zip(&octaves);
            octaves.map(|(k, mean)| octave_share(k) * mean[at(m)]).sum()
        };
        Some(Self {
            inside: all.iter().map(inside).collect(),
            tail: all.iter().map(tail).collect(),
        })
    }

    /// The response in dyadic bands, for sets that are not shifted. Returns `None` if the
    /// cells of the sampler are no dyadic blocks.
    #[must_use]
    pub fn in_bands(sampler: &Sampler, count: usize) -> Option<Self> {
        let levels = FINEST + OCTAVES as usize;
        let grid = ExpectedPower::new(sampler, count)?.bands(levels)?;
        let at = |band: [usize; 4]| grid[band.iter().fold(0, |i, s| i * (levels + 1) + s)];
        let tail = |band: [usize; 4]| {
            if !band.contains(&FINEST) {
                return 0.0;
            }
            let finer = |k: u32| band.map(|s| if s == 0 { 0 } else { s + k as usize });
            let octaves = (1..=OCTAVES).map(|k| octave_share(k) * at(finer(k)));
            octaves.sum()
        };
        let inside = |band: [usize; 4]| if band == [0; 4] { 0.0 } else { at(band) };
        Some(Self {
            inside: bands(FINEST).map(inside).collect(),
            tail: bands(FINEST).map(tail).collect(),
        })
    }

    /// |S_m|² of a fixed set. The tail of each frequency has one frequency, drawn at random
    /// in a random octave.
    fn of_points(points: &[WindowPoint], max: usize, seed: u64) -> Self {
        let all = box_frequencies(max);
        let tail_of = |(index, m): (usize, &[isize; 4])| {
            if !is_in_last_octave(m, max) {
                return 0.0;
            }
            let [octave, shifts] =
                [0, 1].map(|block| words(seed, Stream::Shift, index as u64, 1 + block));
            // The octave k has the probability 2^−k.
            let k = (1 + octave[0].leading_zeros()).min(OCTAVES);
            let far = std::array::from_fn(|axis| {
                let cells = libm::exp2(f64::from(k));
                let offset = whole(unit(shifts[axis]) * cells) as f64 - 0.5 * cells;
                if m[axis] == 0 {
                    0.0
                } else {
                    m[axis] as f64 * cells + offset
                }
            });
            power(points, far)
        };
        Self {
            inside: box_powers(points, max),
            tail: all.par_iter().enumerate().map(tail_of).collect(),
        }
    }
}

/// |S_m|² of a set at one frequency.
fn power(points: &[WindowPoint], m: [f64; 4]) -> f64 {
    let phase = |z: &WindowPoint| {
        // Whole turns are removed from each product, so that phases keep their digits.
        let turns = (0..4).map(|axis| m[axis] * z[axis]);
        turns.map(|turn| turn - turn.floor()).sum::<f64>()
    };
    let sum: Complex = points
        .iter()
        .map(|z| etendue_field::cis(-TAU * phase(z)))
        .sum();
    sum.norm_sqr() / (points.len() as f64).powi(2)
}

/// |S_m|² of a set at all frequencies up to `max`; 0 at m = 0.
fn box_powers(points: &[WindowPoint], max: usize) -> Vec<f64> {
    let width = 2 * max + 1;
    let waves = |z: f64| -> Vec<Complex> {
        let frequency = |i: usize| i as f64 - max as f64;
        (0..width)
            .map(|i| etendue_field::cis(-TAU * frequency(i) * z))
            .collect()
    };
    let tables: Vec<[Vec<Complex>; 4]> = points.iter().map(|z| z.map(waves)).collect();
    let rows = (0..width * width).into_par_iter().flat_map_iter(|row| {
        let mut sums = vec![Complex::ZERO; width * width];
        for [x, u, y, v] in &tables {
            let outer = x[row / width] * u[row % width];
            for (sums, y) in sums.chunks_exact_mut(width).zip(y) {
                let outer = outer * y;
                for (sum, v) in sums.iter_mut().zip(v) {
                    *sum += outer * v;
                }
            }
        }
        let scale = (points.len() as f64).powi(2);
        sums.into_iter().map(move |sum| sum.norm_sqr() / scale)
    });
    let mut powers: Vec<f64> = rows.collect();
    let zero = powers.len() / 2;
    powers[zero] = 0.0;
    powers
}
