//! Closed forms in 2D under a Gaussian window that is not cut: for checks only.
//!
//! A [`Window`](etendue_field::Window) has a finite support, so this one exists nowhere else. Frequencies
//! are (Ωx, Ωv), in cycles per metre and per unit slope; the slope is called v, as in the paper.

use crate::quadrature::integrate;
use crate::shading::g_hat;
use crate::sinc::sinc;
use etendue_field::Complex;
use std::f64::consts::{PI, TAU};

/// The window exp(−π(x²/a² + v²/b²)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// Width a along the position, in metres.
    pub a: f64,
    /// Width b along the slope; may be infinite.
    pub b: f64,
}

/// A light, a plane of blockers, and a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bench {
    /// Width of the light, in metres; its radiance is 1.
    pub light: f64,
    /// Distance from the light to the blockers, in metres.
    pub to_blockers: f64,
    /// Distance from the blockers to where the light field is looked at, in metres.
    pub below: f64,
}

/// A transparency ½(1 + m cos(2πf x + p)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grating {
    /// Frequency f, cycles per metre.
    pub frequency: f64,
    /// Modulation m.
    pub modulation: f64,
    /// Phase p, in radians.
    pub phase: f64,
}

impl Grating {
    /// Its Fourier series: (frequency, coefficient).
    #[must_use]
    pub fn lines(&self) -> [(f64, Complex); 3] {
        let side = Complex::from_polar(0.25 * self.modulation, self.phase);
        [
            (-self.frequency, side.conj()),
            (0.0, Complex::from(0.5)),
            (self.frequency, side),
        ]
    }
}

/// The field |x − D v| < w/2 of an area light of width w at distance D under the window:
/// q^(−1/2) exp(−πω²/q) ∫ exp(−πPy² − 2πiQy) dy over the light, with ω = Ωv + DΩx, q = D²/a² + 1/b²,
/// P = 1/(a²b²q), Q = Ωx − Dω/(a²q) (docs/theory.md, Eq. 9).
///
/// `distance` must not be zero when b is infinite.
#[must_use]
pub fn area_light(width: f64, distance: f64, window: &Gaussian, [x, v]: [f64; 2]) -> Complex {
    let a2 = window.a * window.a;
    let inverse_b2 = 1.0 / (window.b * window.b);
    let omega = v + distance * x;
    let q = distance * distance / a2 + inverse_b2;
    let p = inverse_b2 / (a2 * q);
    let big_q = x - distance * omega / (a2 * q);
    let half = 0.5 * width;
    // Enough for the oscillation, and for the Gaussian where it is narrower than the light.
    let nodes = 16 + count(2.0 * width * (big_q.abs() + p.sqrt()));
    let integral = integrate(nodes, [-half, half], |y| {
        Complex::from_polar((-PI * p * y * y).exp(), -TAU * big_q * y)
    });
    integral * ((-PI * omega * omega / q).exp() / q.sqrt())
}

/// The same light seen through a grating: Σ cₙ I(D; Ωx − n f, Ωv + n f d) a distance d below it.
#[must_use]
pub fn through_grating(
    bench: &Bench,
    grating: &Grating,
    window: &Gaussian,
    [x, v]: [f64; 2],
) -> Complex {
    let distance = bench.to_blockers + bench.below;
    let lines = grating.lines().into_iter();
    lines
        .map(|(f, c)| c * area_light(bench.light, distance, window, [x - f, v + f * bench.below]))
        .sum()
}

/// The part of the light that a strip, (lowest, highest) in metres, blocks: a double integral over strip
/// and light, v = (y − y₀)/d₁ and x = y + d₂ v.
#[must_use]
pub fn blocked_by_strip(
    bench: &Bench,
    strip: [f64; 2],
    window: &Gaussian,
    [omega_x, omega_v]: [f64; 2],
) -> Complex {
    let half = 0.5 * bench.light;
    let nodes = 32 + count(2.0 * (bench.light + strip[1] - strip[0]) * omega_x.hypot(omega_v));
    let sum: Complex = integrate(nodes, strip, |y| {
        integrate(nodes, [-half, half], |origin| {
            let v = (y - origin) / bench.to_blockers;
            let x = y + bench.below * v;
            let (p, q) = (x / window.a, v / window.b);
            Complex::from_polar(
                (-PI * (p * p + q * q)).exp(),
                -TAU * (omega_x * x + omega_v * v),
            )
        })
    });
    sum / bench.to_blockers
}

/// A field times g(v) = (1 + v²)^(−3/2), from the same field under other Gaussian windows:
/// g(v) = 4/√π ∫₀^∞ s² exp(−s²) exp(−s²v²) ds adds s²/π to 1/b²
/// (docs/theory.md, Eq. 8).
///
/// The integrand is even and analytic in s: the trapezoid rule converges exponentially.
#[must_use]
pub fn shaded(window: &Gaussian, field: impl Fn(&Gaussian) -> Complex) -> Complex {
    // Step 0.25 errs by exp(−π²/0.25²) = 1e-69, the end at 6.5 by exp(−6.5²) = 5e-19.
    const STEP: f64 = 0.25;
    let nodes = (1..=26).map(|j| STEP * f64::from(j));
    let sum: Complex = nodes
        .map(|s| {
            let s2 = s * s;
            let b = (1.0 / (window.b * window.b) + s2 / PI).sqrt().recip();
            field(&Gaussian { a: window.a, b }) * (s2 * (-s2).exp())
        })
        .sum();
    sum * (4.0 * STEP / PI.sqrt())
}

/// The spectrum of the irradiance below a grating, no window:
/// Σ cₙ w sinc(w(Ωx − n f)) ĝ(DΩx − d₁ n f) (Durand et al. 2005, Eq. 7 without the albedo).
#[must_use]
pub fn irradiance(bench: &Bench, grating: &Grating, x: f64) -> Complex {
    let w = bench.light;
    let distance = bench.to_blockers + bench.below;
    let lines = grating.lines().into_iter();
    lines
        .map(|(f, c)| c * w * sinc(w * (x - f)) * g_hat(distance * x - bench.to_blockers * f))
        .sum()
}

/// A number of nodes.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a small positive number, rounded up"
)]
fn count(nodes: f64) -> usize {
    nodes.ceil() as usize
}
