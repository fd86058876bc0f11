//! Tests with random signs.

use etendue_transform::random::{self, Stream};
use ndarray::Array2;

/// Number of rounds of random signs. With this number, the p-value is a multiple of 1/20,000.
const ROUNDS: u64 = 19_999;
/// Number of sums that are computed side by side, which the compiler turns into vector instructions.
pub(crate) const LANES: usize = 8;

/// The p-value of a quadratic form of `count` random signs, or of what `factors` makes of
/// the signs: factors that are 1 or −1. It is the share of rounds in which the form is at least as
/// large as for signs that are all 1, which count as one round.
pub(crate) fn p_of_signs(
    form: &Array2<f64>,
    count: usize,
    seed: u64,
    factors: impl Fn(Vec<[f64; LANES]>) -> Vec<[f64; LANES]>,
) -> f64 {
    let observed = signed_sums(form, &factors(vec![[1.0; LANES]; count]))[0];
    let reached: usize = (0..ROUNDS)
        .step_by(LANES)
        .map(|first| {
            let sums = signed_sums(form, &factors(signs_of_rounds(seed, first, count)));
            // The last block has fewer rounds than lanes.
            let drawn = sums.iter().zip(first..ROUNDS);
            drawn.filter(|(sum, _)| **sum >= observed).count()
        })
        .sum();
    (reached + 1) as f64 / (ROUNDS + 1) as f64
}

/// Σ_b<c ε_b ε_c H_bc for several rounds of signs, [b][round]. The diagonal is left out
/// because it is the same for all signs.
fn signed_sums(products: &Array2<f64>, signs: &[[f64; LANES]]) -> [f64; LANES] {
    let mut sums = [0.0; LANES];
    for (b, row) in products.outer_iter().enumerate() {
        let mut ahead = [0.0; LANES];
        for (h, signs) in row.iter().zip(&signs[..b]) {
            for lane in 0..LANES {
                ahead[lane] += h * signs[lane];
            }
        }
        for lane in 0..LANES {
            sums[lane] += signs[b][lane] * ahead[lane];
        }
    }
    sums
}

/// The signs of the rounds from `first` on, [b][round].
fn signs_of_rounds(seed: u64, first: u64, count: usize) -> Vec<[f64; LANES]> {
    let mut columns = vec![[0.0; LANES]; count];
    for (lane, round) in (first..).take(LANES).enumerate() {
        for (column, sign) in columns.iter_mut().zip(signs(seed, round)) {
            column[lane] = sign;
        }
    }
    columns
}

/// Random signs for the batches of one round.
fn signs(seed: u64, round: u64) -> impl Iterator<Item = f64> {
    let words = (0..).flat_map(move |block| random::words(seed, Stream::Flip, round, block));
    words.flat_map(|word| (0..32).map(move |bit| 1.0 - 2.0 * f64::from(word >> bit & 1)))
}
