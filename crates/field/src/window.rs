//! Windows and their profiles.

use crate::TwoPlane;
use crate::number::sinc;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One factor of a window. The factor is 1 at its centre and zero outside |t| < half-width.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Profile {
    /// Hann window: cos²(π t / 2h) on |t| < h.
    Hann(f64),
    /// Box: 1 on |t| < h.
    Box(f64),
    /// Truncated Gaussian: exp(−π t² / width²) on |t| < cut.
    Gaussian {
        /// The width, which is the integral of the Gaussian before truncation.
        #[schemars(title = "a width in the unit of its coordinate", extend("x-ron" = "0.3"))]
        width: f64,
        /// Half-width of the support.
        #[schemars(title = "a half-width in the unit of its coordinate", extend("x-ron" = "0.5"))]
        cut: f64,
    },
}

/// One term `weight` · cos(2π `frequency` t) of a window's profile inside its support.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CosineTerm {
    /// Frequency in cycles per unit, ≥ 0.
    pub frequency: f64,
    /// Amplitude of the cosine.
    pub weight: f64,
}

/// Number of terms of the power series of a cosine. The error of the series is 2·10⁻¹⁷ at a quarter
/// of the cosine's period.
const TERMS: usize = 11;

/// (−1)ᵏ (π/2)²ᵏ/(2k)!.
const COSINE: [f64; TERMS] = {
    let mut terms = [1.0; TERMS];
    let mut k = 1;
    while k < TERMS {
        let both = ((2 * k - 1) * (2 * k)) as f64;
        let quarter = std::f64::consts::FRAC_PI_2;
        terms[k] = -terms[k - 1] * (quarter * quarter) / both;
        k += 1;
    }
    terms
};

/// Computes cos²(π s/2) on |s| ≤ 1 for several values at a time, to 8·10⁻¹⁶. The window is
/// evaluated for each photon, and this function is much faster than the cosine of a library. Its
/// results are bitwise identical on every machine.
#[inline(always)]
fn hann<const N: usize>(s: [f64; N]) -> [f64; N] {
    let mut cosines = [0.0; N];
    for term in COSINE.iter().rev() {
        for (cosine, s) in cosines.iter_mut().zip(s) {
            *cosine = *cosine * (s * s) + term;
        }
    }
    for cosine in &mut cosines {
        *cosine *= *cosine;
    }
    cosines
}

impl Profile {
    /// The half-width of the support.
    #[inline]
    #[must_use]
    pub fn half_width(&self) -> f64 {
        match *self {
            Self::Hann(h) | Self::Box(h) => h,
            Self::Gaussian { cut, .. } => cut,
        }
    }

    /// The profile at `t`.
    #[inline]
    #[must_use]
    pub fn value(&self, t: f64) -> f64 {
        if t.abs() >= self.half_width() {
            return 0.0;
        }
        match *self {
            Self::Hann(h) => {
                let [value] = hann([t / h]);
                value
            }
            Self::Box(_) => 1.0,
            Self::Gaussian { width, .. } => libm::exp(-std::f64::consts::PI * (t / width).powi(2)),
        }
    }

    /// The profile at several numbers inside the support.
    #[inline(always)]
    fn values<const N: usize>(&self, t: &[f64; N]) -> [f64; N] {
        match *self {
            Self::Hann(h) => {
                let mut shares = *t;
                shares.iter_mut().for_each(|share| *share /= h);
                hann(shares)
            }
            Self::Box(_) => [1.0; N],
            Self::Gaussian { .. } => t.map(|t| self.value(t)),
        }
    }

    /// The same shape, `factor` times as wide.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        match *self {
            Self::Hann(h) => Self::Hann(h * factor),
            Self::Box(h) => Self::Box(h * factor),
            Self::Gaussian { width, cut } => Self::Gaussian {
                width: width * factor,
                cut: cut * factor,
            },
        }
    }

    /// The Fourier transform ∫ W(t) e^(−2πi f t) dt at a frequency. The transform is real.
    #[must_use]
    pub fn transform(&self, frequency: f64) -> f64 {
        let width = 2.0 * self.half_width();
        let of_term = |term: &CosineTerm| {
            let sides = [frequency - term.frequency, frequency + term.frequency];
            0.5 * term.weight * sides.map(|f| sinc(width * f)).iter().sum::<f64>()
        };
        width * self.cosine_terms().iter().map(of_term).sum::<f64>()
    }

    /// The profile inside its support as a sum of cosines (docs/theory.md (3)).
    ///
    /// The sum is exact for Hann and Box. A Gaussian is approximated by a Fourier series of period
    /// 2L, which equals the sum of copies of the Gaussian at distances of 2L. L is chosen such that
    /// the copies add less than 10⁻¹⁶ inside the cut, and terms below 10⁻¹⁷ are left out.
    #[must_use]
    pub fn cosine_terms(&self) -> Vec<CosineTerm> {
        match *self {
            Self::Hann(h) => vec![
                CosineTerm {
                    frequency: 0.0,
                    weight: 0.5,
                },
                CosineTerm {
                    frequency: 0.5 / h,
                    weight: 0.5,
                },
            ],
            Self::Box(_) => vec![CosineTerm {
                frequency: 0.0,
                weight: 1.0,
            }],
            Self::Gaussian { width, cut } => {
                // exp(−π (2L − cut)²/width²) < 1e-16 needs (2L − cut) > 3.43 width.
                let period = cut + 3.5 * width;
                (0..)
                    .map(|n| {
                        let frequency = f64::from(n) / period;
                        let coefficient = width / period
                            * libm::exp(-std::f64::consts::PI * (width * frequency).powi(2));
                        CosineTerm {
                            frequency,
                            weight: if n == 0 {
                                coefficient
                            } else {
                                2.0 * coefficient
                            },
                        }
                    })
                    .take_while(|term| term.weight > 1e-17)
                    .collect()
            }
        }
    }
}

/// The window of a virtual plane: the product of four profiles, one for each coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Window {
    /// Along x, metres.
    pub x: Profile,
    /// Along y, metres.
    pub y: Profile,
    /// Along u, slope.
    pub u: Profile,
    /// Along v, slope.
    pub v: Profile,
}

impl Window {
    /// The window at a ray; zero outside the support.
    #[inline]
    #[must_use]
    pub fn value(&self, z: &TwoPlane) -> f64 {
        if !self.contains(z) {
            return 0.0;
        }
        let [x, y, u, v] = match [self.x, self.y, self.u, self.v] {
            [
                Profile::Hann(a),
                Profile::Hann(b),
                Profile::Hann(c),
                Profile::Hann(d),
            ] => hann([z.x / a, z.y / b, z.u / c, z.v / d]),
            [x, y, u, v] => [x.value(z.x), y.value(z.y), u.value(z.u), v.value(z.v)],
        };
        x * y * u * v
    }

    /// The window at several rays inside the support, given as columns of x, y, u and v.
    /// The values are those of [`Self::value`].
    #[inline(always)]
    #[must_use]
    pub fn values<const N: usize>(&self, [x, y, u, v]: &[[f64; N]; 4]) -> [f64; N] {
        let mut product = self.x.values(x);
        for (profile, along) in [(self.y, y), (self.u, u), (self.v, v)] {
            for (product, value) in product.iter_mut().zip(profile.values(along)) {
                *product *= value;
            }
        }
        product
    }

    /// Checks whether a ray is inside the support.
    #[inline]
    #[must_use]
    pub fn contains(&self, z: &TwoPlane) -> bool {
        z.x.abs() < self.x.half_width()
            && z.y.abs() < self.y.half_width()
            && z.u.abs() < self.u.half_width()
            && z.v.abs() < self.v.half_width()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_values_are_single_values() {
        let gaussian = Profile::Gaussian {
            width: 0.3,
            cut: 0.5,
        };
        for x in [Profile::Hann(0.7), Profile::Box(0.7), gaussian] {
            let window = Window {
                x,
                y: Profile::Hann(0.5),
                u: Profile::Hann(0.9),
                v: Profile::Hann(1.1),
            };
            let rays = [
                [-0.4, 0.1, 0.45],
                [0.3, 0.0, -0.49],
                [0.8, 0.2, 0.1],
                [1.0, -1.0, 0.5],
            ];
            for (i, value) in window.values(&rays).into_iter().enumerate() {
                let [x, y, u, v] = rays.map(|column| column[i]);
                let expected = window.value(&TwoPlane { x, y, u, v });
                assert_eq!(value.to_bits(), expected.to_bits());
            }
        }
    }

    #[test]
    fn hann_is_right_to_rounding() {
        for i in -1000..=1000 {
            let s = f64::from(i) / 1000.0;
            let exact = libm::cos(std::f64::consts::FRAC_PI_2 * s).powi(2);
            // The limit is twice the error of two roundings of numbers up to 1.3, in steps of
            // 2.2·10⁻¹⁶.
            assert!((hann([0.5, s])[1] - exact).abs() < 8e-16, "at {s}");
        }
    }

    #[test]
    fn transforms_are_midpoint_sums() {
        const POINTS: u32 = 20_000;
        let profiles = [
            Profile::Hann(0.7),
            Profile::Box(0.3),
            Profile::Gaussian {
                width: 0.5,
                cut: 0.6,
            },
        ];
        for (profile, frequency) in profiles.into_iter().zip([0.0, 1.3, 2.1]) {
            let half = profile.half_width();
            let at = |i: u32| {
                let t = half * (2.0 * (f64::from(i) + 0.5) / f64::from(POINTS) - 1.0);
                profile.value(t) * libm::cos(std::f64::consts::TAU * frequency * t)
            };
            let sum: f64 = (0..POINTS).map(at).sum();
            let sum = sum * 2.0 * half / f64::from(POINTS);
            let off = (profile.transform(frequency) - sum).abs();
            assert!(off < 1e-8, "{profile:?} {off:e}"); // the midpoint rule
        }
    }

    #[test]
    fn cosine_terms_add_up_to_the_profile() {
        for profile in [
            Profile::Hann(0.7),
            Profile::Box(0.3),
            Profile::Gaussian {
                width: 0.35,
                cut: 0.6,
            },
            Profile::Gaussian {
                width: 0.35,
                cut: 1.3,
            },
        ] {
            let terms = profile.cosine_terms();
            for i in 0..50 {
                let t = profile.half_width() * (f64::from(i) / 50.0);
                let sum: f64 = terms
                    .iter()
                    .map(|c| c.weight * libm::cos(std::f64::consts::TAU * c.frequency * t))
                    .sum();
                // The Gaussian's copies and the omitted terms stay below 1e-15. The rest of the
                // tolerance covers rounding errors.
                assert!((sum - profile.value(t)).abs() < 3e-15, "{profile:?} at {t}");
            }
        }
    }
}
