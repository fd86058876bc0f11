//! Tests of affine maps against general laws and traced rays, and tests of the effect of the
//! misprints in Durand et al. 2005. The formulas that only tests use are here too: events of several
//! steps, Gaussian covariances, and the conversion between slopes and angles.

pub(crate) mod covariance;
mod events;
mod gaussians;
mod kernel;
mod laws;
pub(crate) mod plane_sphere_kernel;
mod prints;
mod rays;
mod slopes;
mod trace;

use super::{AffineMap, Matrix, Media};

/// The shape operator of an asymmetric saddle.
const SHAPE: Matrix<2> = [[0.6, 0.25], [0.25, -0.3]];
const GLASS: Media = Media {
    before: 1.0,
    after: 1.5,
};
const OUT_OF_GLASS: Media = Media {
    before: 1.5,
    after: 1.0,
};

/// The largest difference between two maps, entry by entry.
fn apart<const N: usize>(a: &AffineMap<N>, b: &AffineMap<N>) -> f64 {
    let offsets = (0..N).map(|i| (a.offset[i] - b.offset[i]).abs());
    let entries = (0..N * N).map(|n| (a.matrix[n / N][n % N] - b.matrix[n / N][n % N]).abs());
    offsets.chain(entries).fold(0.0, f64::max)
}

/// A quasi-random number in (−1, 1), which is a multiple of the square root of a prime. The
/// numbers are uniform for each coordinate and for all coordinates together.
fn scatter(index: usize, coordinate: usize) -> f64 {
    let prime: f64 = [2.0, 3.0, 5.0, 7.0][coordinate];
    2.0 * ((index as f64 + 1.0) * prime.sqrt()).fract() - 1.0
}

/// Rays spread over a neighbourhood of size e.
fn bundle<const N: usize>(count: usize, e: f64) -> impl Iterator<Item = [f64; N]> {
    (0..count).map(move |i| std::array::from_fn(|k| e * scatter(i, k)))
}
