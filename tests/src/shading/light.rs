//! The light for the tests of shading in 2D, and its first-order reflection. The reflection is
//! computed by quadrature in the primal domain.

use super::primal::{about, between, wave};
use etendue_field::Complex;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Number of standard deviations at which sums over a Gaussian end; there the Gaussian has the
/// value 2·10⁻¹⁶.
const REACH: f64 = 8.5;

/// A Gaussian component of a light field, A exp(−½ (z − μ)ᵀ C⁻¹ (z − μ)), z = (x, θ).
#[derive(Clone, Copy, Debug)]
pub(super) struct Bell {
    pub(super) amplitude: f64,
    pub(super) mean: [f64; 2],
    pub(super) covariance: [[f64; 2]; 2],
}

impl Bell {
    fn det(&self) -> f64 {
        let [[a, b], [_, d]] = self.covariance;
        a * d - b * b
    }

    pub(super) fn value(&self, [x, t]: [f64; 2]) -> f64 {
        let [[a, b], [_, d]] = self.covariance;
        let (x, t) = (x - self.mean[0], t - self.mean[1]);
        let form = (d * x * x - 2.0 * b * x * t + a * t * t) / self.det();
        self.amplitude * (-0.5 * form).exp()
    }

    pub(super) fn spectrum(&self, [x, t]: [f64; 2]) -> Complex {
        let [[a, b], [_, d]] = self.covariance;
        let form = a * x * x + 2.0 * b * x * t + d * t * t;
        let size = self.amplitude * TAU * self.det().sqrt() * (-2.0 * PI * PI * form).exp();
        wave(x * self.mean[0] + t * self.mean[1]) * size
    }
}

/// Two Gaussians, wide enough in angle to be cut by the horizon.
pub(super) const LIGHT: [Bell; 2] = [
    Bell {
        amplitude: 1.0,
        mean: [0.05, -0.1],
        covariance: [[0.06, 0.02], [0.02, 0.08]],
    },
    Bell {
        amplitude: 0.6,
        mean: [-0.1, 0.2],
        covariance: [[0.03, -0.015], [-0.015, 0.05]],
    },
];

pub(super) fn light(z: [f64; 2]) -> f64 {
    LIGHT.iter().map(|bell| bell.value(z)).sum()
}

pub(super) fn light_hat(omega: [f64; 2]) -> Complex {
    LIGHT.iter().map(|bell| bell.spectrum(omega)).sum()
}

/// Frequencies at which the spectrum of the light is not negligible.
pub(super) fn frequencies() -> Vec<[f64; 2]> {
    (0..18)
        .map(|i| {
            let radius = 0.35 * f64::from(i / 6) + 0.1;
            let angle = TAU * f64::from(i % 6) / 6.0 + 0.2;
            [1.2 * radius * angle.cos(), radius * angle.sin()]
        })
        .collect()
}

/// A surface and its reflection in the primal domain.
pub(super) struct PrimalSurface<'a> {
    pub(super) theta0: f64,
    pub(super) theta1: f64,
    pub(super) k: f64,
    /// Maximum angle of incidence in sums: π/2 if the horizon cuts the light, and more if the
    /// horizon must not cut the light.
    pub(super) horizon: f64,
    /// f(θ_i').
    pub(super) before: &'a dyn Fn(f64) -> f64,
    /// The lobe ρ(s, δ); `None` means a Dirac.
    pub(super) lobe: Option<&'a dyn Fn(f64, f64) -> f64>,
    /// The factor h(θ_o') on the half-circle of outgoing directions. `None` means a factor of 1 on
    /// the full circle.
    pub(super) after: Option<&'a dyn Fn(f64) -> f64>,
    /// Angles at which f or h has a kink, ascending.
    pub(super) kinks: &'a [f64],
    /// T(s).
    pub(super) texture: &'a dyn Fn(f64) -> f64,
}

impl PrimalSurface<'_> {
    /// Returns quadrature nodes from −`end` to `end`; each interval between two kinks has `count`
    /// nodes on either side of its centre.
    fn pieces(&self, end: f64, count: i32) -> Vec<(f64, f64)> {
        let ends = [&[-end], self.kinks, &[end]].concat();
        let pieces = ends
            .windows(2)
            .map(|ends| between([ends[0], ends[1]], count));
        pieces.flatten().collect()
    }

    /// The transform of the reflected light field in the outgoing light frame. All outgoing
    /// angles and positions are linear in the incoming angle and position: x = −c₀ s, θ = θ_i' + k
    /// s − θ₀, θ_r' = −θ_i', x'' = c₁ s, θ'' = θ_o' + k s − θ₁.
    pub(super) fn transform(&self, light: &dyn Fn([f64; 2]) -> f64, omega: [f64; 2]) -> Complex {
        let (c0, c1) = (self.theta0.cos(), self.theta1.cos());
        let incident = self.pieces(self.horizon, 120);
        let outgoing = self.pieces(FRAC_PI_2, 160);
        // The sum of the lobe ρ over δ, weighted by a phase; if ρ does not vary along s, the sum
        // is computed once.
        let spread = |s: f64, mirror: f64| -> Complex {
            let Some(lobe) = self.lobe else {
                let h = self.after.map_or(1.0, |h| h(mirror));
                return wave(omega[1] * mirror) * h;
            };
            match self.after {
                None => about(0.0, FRAC_PI_2, 120)
                    .map(|(d, w)| wave(omega[1] * (mirror + d)) * (w * lobe(s, d)))
                    .sum(),
                Some(h) => outgoing
                    .iter()
                    .map(|(t, w)| wave(omega[1] * t) * (w * h(*t) * lobe(s, t - mirror)))
                    .sum(),
            }
        };
        let varies = self
            .lobe
            .is_some_and(|lobe| (lobe(0.0, 0.0) - lobe(0.3, 0.0)).abs() > 1e-12);
        let fixed: Vec<Complex> = incident.iter().map(|(t, _)| spread(0.0, -t)).collect();
        let mut sum = Complex::from(0.0);
        for (s, ds) in about(0.0, REACH * 0.25 / c0, 60) {
            let turn = self.k * s;
            let mut here = Complex::from(0.0);
            for ((theta, w), fixed) in incident.iter().zip(&fixed) {
                let radiance = light([-c0 * s, theta + turn - self.theta0]);
                let weight = w * radiance * (self.before)(*theta);
                if weight < 1e-18 {
                    continue;
                }
                let out = if varies { spread(s, -theta) } else { *fixed };
                here += out * weight;
            }
            let phase = omega[0] * c1 * s + omega[1] * (turn - self.theta1);
            sum += here * wave(phase) * (self.texture)(s) * (ds * c1);
        }
        sum
    }
}
