//! Masks with transparent strips over a period of 1, and their Fourier coefficients.

use super::primal::wave;
use etendue_field::Complex;
use std::f64::consts::TAU;

/// Open intervals, [from, to].
pub(crate) type Strips = Vec<[f64; 2]>;

/// Returns three strips between 0 and 1 for a mask of a pair, where `offset` distinguishes the
/// second mask from the first. The edges are reproducible (additive recurrences, Weyl).
pub(crate) fn strips(pair: u32, offset: f64) -> Strips {
    let cut = |i: u32| (0.618_034 * f64::from(6 * pair + i) + offset * f64::from(i + 1)).fract();
    let mut cuts: Vec<f64> = (0..6).map(cut).collect();
    cuts.sort_by(f64::total_cmp);
    cuts.chunks(2).map(|cut| [cut[0], cut[1]]).collect()
}

/// Returns the common openings of two masks in one plane.
pub(crate) fn in_common(a: &Strips, b: &Strips) -> Strips {
    let pairs = a.iter().flat_map(|p| b.iter().map(move |q| (p, q)));
    let both = pairs.map(|(p, q)| [p[0].max(q[0]), p[1].min(q[1])]);
    both.filter(|[low, high]| high > low).collect()
}

/// Returns the Fourier coefficients from −N to N.
pub(crate) fn coefficients(open: &Strips, most: usize) -> Vec<Complex> {
    (0..=2 * most)
        .map(|i| {
            let n = i as f64 - most as f64;
            let each = open.iter().map(|[a, b]| {
                if n.abs() < 0.5 {
                    Complex::from(b - a)
                } else {
                    (wave(n * b) - wave(n * a)) * Complex::new(0.0, 1.0 / (TAU * n))
                }
            });
            each.sum()
        })
        .collect()
}
