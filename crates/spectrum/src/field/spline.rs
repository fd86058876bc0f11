//! Computes the shares of a ray in cells by B-splines. Also computes the transforms of these
//! splines, and the aliasing that the grid causes.
//!
//! A ray at t (in cells) adds the share B(j − t) to each cell j, where B is the B-spline of order p
//! with the transform sinc^p. Let f be a frequency in cycles per cell, with |f| ≤ ½. Poisson's
//! summation formula gives the transform of the shares, divided by sinc^p(f):
//!
//! e^(−2πift) (1 + ε),   ε = Σ_(n≠0) (sinc^p(f + n)/sinc^p(f)) e^(−2πint),   sinc(f + n)/sinc(f) = (−1)ⁿ f/(f + n).
//!
//! The factor e^(−2πift) is the exact phase of the ray, and ε is the sum of the aliases (Hockney
//! and Eastwood 1981, chapter 5; Jing 2005, ApJ 620).

use etendue_field::{Assignment, sinc};
use std::f64::consts::PI;

/// The transform of the spline, sinc^p(f).
pub(crate) fn transform(assignment: Assignment, f: f64) -> f64 {
    (0..assignment.order()).map(|_| sinc(f)).product()
}

/// The cells to which a ray contributes along one axis, and the ray's share in each cell.
/// The ray is at `t` ≥ 0, in units of cells, and cells have numbers in the period 0..`n`. The
/// shares add up to 1.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the index is whole and from 0 to n, because a ray in the window is in the box"
)]
pub(crate) fn taps<const P: usize>(t: f64, n: usize) -> ([usize; P], [f64; P]) {
    // For even P, `cell` is the cell below t; for odd P, `cell` is the cell nearest to t.
    let cell = (t + (P % 2) as f64 * 0.5).floor();
    let d = t - cell;
    let shares: [f64; 3] = match P {
        1 => [1.0, 0.0, 0.0],
        2 => [1.0 - d, d, 0.0],
        _ => [
            0.5 * (0.5 - d) * (0.5 - d),
            0.75 - d * d,
            0.5 * (0.5 + d) * (0.5 + d),
        ],
    };
    let first = cell as usize + n - (P - 1) / 2;
    let cells = std::array::from_fn(|i| (first + i) % n);
    (cells, std::array::from_fn(|i| shares[i]))
}

/// The maximum of |ε| at the frequency `f`, over all positions of a ray.
///
/// The value is exact for orders 1 and 2. For order 3, the value is the sum of the moduli of the
/// terms, and this sum exceeds the actual maximum by up to a fifth.
pub(crate) fn worst_alias(assignment: Assignment, f: f64) -> f64 {
    let f = f.abs();
    let one = sinc(f);
    match assignment {
        // A ray is at most half a cell from the position to which it is assigned, so |ε| is at
        // most |e^(iθ)/sinc f − 1| with |θ| ≤ πf.
        Assignment::Nearest => {
            let square = 1.0 / (one * one) - 2.0 * libm::cos(PI * f) / one + 1.0;
            square.max(0.0).sqrt()
        }
        // At t = 0 all terms of ε are positive, and Σ 1/(f + n)² = π²/sin²(πf).
        Assignment::Cic => 1.0 / (one * one) - 1.0,
        Assignment::Tsc => {
            let last = 50;
            let cube = |t: f64| t * t * t;
            let term = |n: u32| cube(f / (f64::from(n) - f)) + cube(f / (f64::from(n) + f));
            let sum: f64 = (1..=last).map(term).sum();
            // Each omitted term is below the integral of f³/(t − f)³ over one step of t.
            sum + cube(f) / (f64::from(last) - f).powi(2)
        }
    }
}

/// The mean of |ε|² over all positions of a ray, Σ_(n≠0) (f/(f + n))^2p. Jing (2005), Eq.
/// 20, gives closed forms of these sums.
pub(crate) fn mean_square_alias(assignment: Assignment, f: f64) -> f64 {
    let s = libm::sin(PI * f).powi(2);
    let all = match assignment {
        Assignment::Nearest => 1.0,
        Assignment::Cic => 1.0 - 2.0 / 3.0 * s,
        Assignment::Tsc => 1.0 - s + 2.0 / 15.0 * s * s,
    };
    (all / transform(assignment, f).powi(2) - 1.0).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::Complex;

    const ALL: [Assignment; 3] = [Assignment::Nearest, Assignment::Cic, Assignment::Tsc];

    fn both<const P: usize>(t: f64, n: usize) -> Vec<(usize, f64)> {
        let (cells, shares) = taps::<P>(t, n);
        cells.into_iter().zip(shares).collect()
    }

    fn shares(assignment: Assignment, t: f64, n: usize) -> Vec<(usize, f64)> {
        match assignment {
            Assignment::Nearest => both::<1>(t, n),
            Assignment::Cic => both::<2>(t, n),
            Assignment::Tsc => both::<3>(t, n),
        }
    }

    #[test]
    fn shares_add_up_and_keep_the_place() {
        for assignment in ALL {
            for i in 0..200 {
                let t = 2.0 + f64::from(i) * 0.0371;
                let taps = shares(assignment, t, 16);
                assert_eq!(taps.len(), assignment.order());
                let sum: f64 = taps.iter().map(|(_, share)| share).sum();
                let mean: f64 = taps.iter().map(|(cell, share)| *cell as f64 * share).sum();
                assert!((sum - 1.0).abs() < 1e-15); // rounding
                assert!(taps.iter().all(|(_, share)| *share >= 0.0));
                if assignment == Assignment::Nearest {
                    assert!((mean - t).abs() <= 0.5);
                } else {
                    assert!((mean - t).abs() < 1e-13); // rounding
                }
            }
        }
    }

    #[test]
    fn cells_beyond_the_box_are_those_at_its_other_end() {
        let cells = |a, t| {
            shares(a, t, 8)
                .iter()
                .map(|(cell, _)| *cell)
                .collect::<Vec<_>>()
        };
        assert_eq!(cells(Assignment::Nearest, 7.6), [0]);
        assert_eq!(cells(Assignment::Cic, 7.6), [7, 0]);
        assert_eq!(cells(Assignment::Tsc, 0.2), [7, 0, 1]);
        assert_eq!(cells(Assignment::Tsc, 8.0), [7, 0, 1]); // a ray that rounding has moved to the edge
    }

    /// Computes ε from its definition, for many positions of a ray.
    #[test]
    fn aliases_are_what_is_said_of_them() {
        for assignment in ALL {
            for f in [0.0_f64, 0.01, 0.1, 0.25, 0.4, 0.5] {
                let places = 1000;
                let (mut largest, mut square) = (0.0_f64, 0.0);
                for i in 0..places {
                    let t = 4.0 + (f64::from(i) + 0.5) / f64::from(places);
                    let phase = |t: f64| Complex::cis(-2.0 * PI * f * t);
                    let taps = shares(assignment, t, 16);
                    let sum: Complex = taps.iter().map(|(cell, w)| phase(*cell as f64) * w).sum();
                    let alias = sum / transform(assignment, f) / phase(t) - 1.0;
                    largest = largest.max(alias.norm());
                    square += alias.norm_sqr() / f64::from(places);
                }
                let worst = worst_alias(assignment, f);
                assert!(
                    largest <= worst + 1e-14,
                    "{assignment:?} {f}: {largest} {worst}"
                ); // rounding
                // Positions of the ray are sampled in steps of 1/1000 of a cell. For order 3, |ε|
                // stays below the sum of moduli.
                let tsc = assignment == Assignment::Tsc;
                let least = if tsc { 0.8 } else { 0.99 };
                assert!(
                    largest >= least * worst,
                    "{assignment:?} {f}: {largest} {worst}"
                );
                let mean = mean_square_alias(assignment, f);
                assert!((square - mean).abs() < 5e-6, "{f}: {square} {mean}"); // the mid-point rule: 1/1000² times a few
            }
        }
    }
}
