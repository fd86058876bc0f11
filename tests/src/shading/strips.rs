//! Periodic masks with transparent strips (period 1), and the Fourier coefficients of these
//! masks.

use super::primal::wave;
use etendue_field::Complex;
use std::f64::consts::TAU;

/// Transparent intervals, each given as [from, to].
pub(crate) type Strips = Vec<[f64; 2]>;

/// Three strips between 0 and 1 for a mask of a pair, where `offset` distinguishes the
/// second mask from the first. The edges of the strips are pseudo-random but reproducible
/// (additive recurrences, Weyl).
pub(crate) fn strips(pair: u32, offset: f64) -> Strips {
    let cut = |i: u32| (0.618_034 * f64::from(6 * pair + i) + offset * f64::from(i + 1)).fract();
    let mut cuts: Vec<f64> = (0..6).map(cut).collect();
    cuts.sort_by(f64::total_cmp);
    cuts.chunks(2).map(|cut| [cut[0], cut[1]]).collect()
}

/// The strips that are transparent in both of two masks in one plane.
pub(crate) fn in_common(a: &Strips, b: &Strips) -> Strips {
    let pairs = a.iter().flat_map(|p| b.iter().map(move |q| (p, q)));
    let both = pairs.map(|(p, q)| [p[0].max(q[0]), p[1].min(q[1])]);
    both.filter(|[low, high]| high > low).collect()
}

/// The Fourier coefficients of a mask for indices from −N to N.
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
