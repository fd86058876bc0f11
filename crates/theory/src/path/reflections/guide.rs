//! Gaussians that guide light into the window. Rays are sampled by these Gaussians.
//!
//! The window is approximated by a Gaussian with the same variances. An affine map takes this
//! Gaussian back to the previous leg. A lobe blurs the Gaussian's angles, and the edge of a surface
//! narrows the Gaussian's positions. The Gaussian at a surface gives the directions that reach the
//! window from each point of the surface. The Gaussian at the light gives the rays that reach the
//! window.

use crate::geometry::{
    AffineMap, Matrix, congruent, diagonal, from_fn, inverse, plus, product, sum, times,
};
use crate::path::scattering::{bell, bell_density};
use etendue_field::{Profile, Window};
use std::f64::consts::{PI, TAU};

/// A Gaussian of N coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gaussian<const N: usize> {
    pub(super) mean: [f64; N],
    pub(super) covariance: Matrix<N>,
}

/// Standard deviation, in radians, of the Gaussian that represents the angles of diffuse light.
const DIFFUSE: f64 = 0.6;

impl Gaussian<4> {
    pub(super) fn of_window(window: &Window) -> Self {
        let profiles = [window.x, window.y, window.u, window.v];
        Self {
            mean: [0.0; 4],
            covariance: diagonal(profiles.map(|profile| variance(&profile))),
        }
    }

    /// The Gaussian that a map takes to this Gaussian.
    pub(super) fn before(&self, map: &AffineMap<4>) -> Option<Self> {
        let back = map.inverse()?;
        Some(Self {
            mean: back.apply(self.mean),
            covariance: congruent(&back.matrix, &self.covariance),
        })
    }

    /// The Gaussian of incident light that a lobe scatters into light of this Gaussian. The
    /// angles of this Gaussian are relative to the central ray. The lobe blurs the Gaussian about
    /// the mirror direction. If the surface is diffuse, the angles of the incident light are
    /// arbitrary.
    pub(super) fn before_lobe(&self, width: Option<f64>, outgoing: [f64; 2]) -> Self {
        let [s, t, theta, phi] = self.mean;
        let Some(width) = width else {
            let keeps = |i: usize, j: usize| i < 2 && j < 2;
            return Self {
                mean: [s, t, 0.0, 0.0],
                covariance: from_fn(|i, j| match (keeps(i, j), i == j) {
                    (true, _) => self.covariance[i][j],
                    (false, true) => DIFFUSE * DIFFUSE,
                    (false, false) => 0.0,
                }),
            };
        };
        let mirror = AffineMap::<4>::mirror();
        let blur = diagonal([0.0, 0.0, width * width, width * width]);
        Self {
            mean: mirror.apply([s, t, theta + outgoing[0], phi + outgoing[1]]),
            covariance: sum(&congruent(&mirror.matrix, &self.covariance), &blur),
        }
    }

    /// The product of this Gaussian and an independent Gaussian along each axis, given by
    /// means and inverse variances.
    pub(super) fn narrowed(&self, means: [f64; 4], precisions: [f64; 4]) -> Option<Self> {
        self.times(&means, &diagonal(precisions))
    }

    /// The marginal Gaussian of two coordinates; the other two coordinates are arbitrary.
    pub(super) fn marginal(&self, of: [usize; 2]) -> Gaussian<2> {
        Gaussian {
            mean: of.map(|i| self.mean[i]),
            covariance: from_fn(|i, j| self.covariance[of[i]][of[j]]),
        }
    }

    /// The Gaussian of two coordinates, positions or slopes, conditional on the other two
    /// coordinates. Returns `None` if the Gaussian has zero width along the other two coordinates.
    pub(super) fn given(&self, [a, b]: [usize; 2]) -> Option<Conditional> {
        let others = match a {
            0 => [2, 3],
            _ => [0, 1],
        };
        let block = |rows: [usize; 2], columns: [usize; 2]| -> Matrix<2> {
            from_fn(|i, j| self.covariance[rows[i]][columns[j]])
        };
        let known_inverse = inverse(&block([a, b], [a, b]))?;
        let across = block(others, [a, b]);
        let taken = congruent(&across, &known_inverse);
        let own = block(others, others);
        Some(Conditional {
            known: [self.mean[a], self.mean[b]],
            mean: others.map(|i| self.mean[i]),
            gain: product(&across, &known_inverse),
            covariance: from_fn(|i, j| own[i][j] - taken[i][j]),
        })
    }
}

/// A Gaussian of two coordinates. Its mean depends linearly on two other coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conditional {
    /// The value of the other two coordinates at which the mean is `mean`.
    known: [f64; 2],
    mean: [f64; 2],
    /// The derivative of the mean with respect to the other two coordinates.
    gain: Matrix<2>,
    covariance: Matrix<2>,
}

impl Conditional {
    pub(super) fn at(&self, known: [f64; 2]) -> Gaussian<2> {
        let off = [known[0] - self.known[0], known[1] - self.known[1]];
        let moved = times(&self.gain, &off);
        Gaussian {
            mean: [self.mean[0] + moved[0], self.mean[1] + moved[1]],
            covariance: self.covariance,
        }
    }
}

impl Gaussian<2> {
    /// A Gaussian with the given mean, and with the same standard deviation along both
    /// axes.
    pub(super) fn round(mean: [f64; 2], width: Option<f64>) -> Self {
        let width = width.unwrap_or(DIFFUSE);
        Self {
            mean,
            covariance: diagonal([width * width; 2]),
        }
    }

    /// The product of two Gaussians.
    pub(super) fn product(&self, other: &Self) -> Option<Self> {
        self.times(&other.mean, &inverse(&other.covariance)?)
    }
}

impl<const N: usize> Gaussian<N> {
    /// The product of this Gaussian and another, given by its mean and the inverse of its
    /// covariance.
    fn times(&self, mean: &[f64; N], precision: &Matrix<N>) -> Option<Self> {
        let own = inverse(&self.covariance)?;
        let covariance = inverse(&sum(&own, precision))?;
        let pull = plus(&times(&own, &self.mean), &times(precision, mean));
        Some(Self {
            mean: times(&covariance, &pull),
            covariance,
        })
    }
}

/// A density of two coordinates that is as wide as a Gaussian and has longer tails, which bound the
/// weights of rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeavyTailedGaussian {
    mean: [f64; 2],
    /// Lower triangular matrix R: points are mean + R q.
    root: [f64; 3],
}

/// The width of a density divided by the standard deviation of its Gaussian.
const BROADENED: f64 = 1.8;

impl HeavyTailedGaussian {
    pub(super) fn new(gaussian: &Gaussian<2>) -> Option<Self> {
        let [[a, b], [_, c]] = gaussian.covariance;
        let first = a.sqrt();
        let cross = b / first;
        let second = (c - cross * cross).sqrt();
        let root = [first, cross, second].map(|entry| BROADENED * entry);
        let is_sound = root[0] > 0.0 && root[2] > 0.0 && root.iter().all(|r| r.is_finite());
        is_sound.then_some(Self {
            mean: gaussian.mean,
            root,
        })
    }

    pub(super) fn draw(&self, at: [f64; 2]) -> [f64; 2] {
        let [p, q] = bell(1.0, at);
        let [first, cross, second] = self.root;
        [
            self.mean[0] + first * p,
            self.mean[1] + cross * p + second * q,
        ]
    }

    pub(super) fn density(&self, [a, b]: [f64; 2]) -> f64 {
        let [first, cross, second] = self.root;
        let p = (a - self.mean[0]) / first;
        let q = (b - self.mean[1] - cross * p) / second;
        bell_density(1.0, [p, q]) / (first * second)
    }
}

/// A mixture of heavy-tailed Gaussians, each with its share.
#[derive(Clone, Debug)]
pub(super) struct GuideMixture(Vec<(f64, HeavyTailedGaussian)>);

impl GuideMixture {
    /// Builds the mixture from Gaussians with shares that add up to 1; degenerate Gaussians are
    /// omitted.
    pub(super) fn new(parts: impl IntoIterator<Item = (f64, Option<Gaussian<2>>)>) -> Option<Self> {
        let bells = parts.into_iter();
        let bells =
            bells.filter_map(|(share, part)| Some((share, HeavyTailedGaussian::new(&part?)?)));
        let mut bells: Vec<(f64, HeavyTailedGaussian)> = bells.collect();
        let total: f64 = bells.iter().map(|(share, _)| share).sum();
        for (share, _) in &mut bells {
            *share /= total;
        }
        (total > 0.0).then_some(Self(bells))
    }

    pub(super) fn draw(&self, [a, b]: [f64; 2]) -> [f64; 2] {
        let mut left = a;
        for (share, bell) in &self.0 {
            if left < *share {
                return bell.draw([left / share, b]);
            }
            left -= share;
        }
        // Because of rounding, `a` may lie beyond the last share.
        let (_, last) = self.0[self.0.len() - 1];
        last.draw([0.5, b])
    }

    pub(super) fn density(&self, point: [f64; 2]) -> f64 {
        let parts = self.0.iter();
        parts.map(|(share, bell)| share * bell.density(point)).sum()
    }
}

/// The variance of a window's profile.
fn variance(profile: &Profile) -> f64 {
    match *profile {
        Profile::Hann(half) => half * half * (1.0 / 3.0 - 2.0 / (PI * PI)),
        Profile::Box(half) => half * half / 3.0,
        Profile::Gaussian { width, .. } => width * width / TAU,
    }
}
