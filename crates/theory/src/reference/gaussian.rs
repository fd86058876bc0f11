//! Closed forms under an untruncated Gaussian window, for checks only.
//!
//! A [`Window`](etendue_field::Window) has a finite support, so only these checks use the
//! untruncated Gaussian window. All closed forms are in 2D, except the closed form for the disc.
//! Frequencies are (Ωx, Ωv), in cycles per metre and per unit slope. The slope is called v, as in
//! the paper.

use crate::quadrature::integrate;
use crate::shading::g_hat;
use etendue_field::{Complex, sinc, whole};
use std::f64::consts::{PI, TAU};

/// The window exp(−π(x²/a² + v²/b²)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GaussianWindow {
    /// Width a along the position, in metres.
    pub(crate) a: f64,
    /// Width b along the slope; may be infinite.
    pub(crate) b: f64,
}

/// A light field after travel over a distance, under the Gaussian window (docs/theory.md (9)).
struct Travelled {
    distance: f64,
    /// 1/a².
    inverse_a2: f64,
    q: f64,
    p: f64,
}

impl Travelled {
    fn new(distance: f64, window: &GaussianWindow) -> Self {
        let inverse_a2 = 1.0 / (window.a * window.a);
        let inverse_b2 = 1.0 / (window.b * window.b);
        let q = distance * distance * inverse_a2 + inverse_b2;
        let p = inverse_b2 * inverse_a2 / q;
        Self {
            distance,
            inverse_a2,
            q,
            p,
        }
    }

    /// Returns ω and Q at the frequencies of one axis.
    fn frequencies(&self, [x, v]: [f64; 2]) -> [f64; 2] {
        let omega = v + self.distance * x;
        let big_q = x - self.distance * omega * self.inverse_a2 / self.q;
        [omega, big_q]
    }
}

/// A light, a plane of blockers, and a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GaussianBlock {
    /// Width of the light, in metres; its radiance is 1.
    pub(crate) light: f64,
    /// Distance from the light to the blockers, in metres.
    pub(crate) to_blockers: f64,
    /// Distance from the blockers to the plane where the light field is observed, in metres.
    pub(crate) below: f64,
}

/// A cosine grating with the transmission ½(1 + m cos(2πf x + p)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CosineGrating {
    /// Frequency f, cycles per metre.
    pub(crate) frequency: f64,
    /// Modulation m.
    pub(crate) modulation: f64,
    /// Phase p, in radians.
    pub(crate) phase: f64,
}

impl CosineGrating {
    /// The terms of the Fourier series, each as (frequency, coefficient).
    #[must_use]
    pub(crate) fn lines(&self) -> [(f64, Complex); 3] {
        let side = Complex::from_polar(0.25 * self.modulation, self.phase);
        [
            (-self.frequency, side.conj()),
            (0.0, Complex::from(0.5)),
            (self.frequency, side),
        ]
    }
}

/// The windowed spectrum of the field |x − D v| < w/2 of an area light of width w at
/// distance D. The spectrum is q^(−1/2) exp(−πω²/q) ∫ exp(−πPy² − 2πiQy) dy over the light, with ω
/// = Ωv + DΩx, q = D²/a² + 1/b², P = 1/(a²b²q), Q = Ωx − Dω/(a²q) (docs/theory.md (9)).
///
/// `distance` must not be zero when b is infinite.
#[must_use]
pub(crate) fn area_light(
    width: f64,
    distance: f64,
    window: &GaussianWindow,
    k: [f64; 2],
) -> Complex {
    let travelled = Travelled::new(distance, window);
    let [omega, big_q] = travelled.frequencies(k);
    let Travelled { p, q, .. } = travelled;
    let half = 0.5 * width;
    // The number of nodes suffices for the oscillation of the integrand, and for the Gaussian if
    // the Gaussian is narrower than the light.
    let nodes = 16 + whole((2.0 * width * (big_q.abs() + p.sqrt())).ceil());
    let integral = integrate(nodes, [-half, half], |y| {
        Complex::from_polar(libm::exp(-PI * p * y * y), -TAU * big_q * y)
    });
    integral * (libm::exp(-PI * omega * omega / q) / q.sqrt())
}

/// The windowed spectrum of the field δ(x − D v) of a point light at distance D: q^(−1/2)
/// exp(−πω²/q), which is also a factor of the area light's spectrum (docs/theory.md (20)).
#[must_use]
pub(crate) fn point_light(distance: f64, window: &GaussianWindow, k: [f64; 2]) -> f64 {
    let travelled = Travelled::new(distance, window);
    let [omega, _] = travelled.frequencies(k);
    libm::exp(-PI * omega * omega / travelled.q) / travelled.q.sqrt()
}

/// The windowed spectrum of an area light of width w with the lobe exp(−πv²/c²) at distance
/// D. The lobe narrows the window: 1/b² becomes 1/b² + 1/c².
#[must_use]
pub(crate) fn spot(
    width: f64,
    lobe: f64,
    distance: f64,
    window: &GaussianWindow,
    k: [f64; 2],
) -> Complex {
    let b = libm::hypot(window.b.recip(), lobe.recip()).recip();
    area_light(width, distance, &GaussianWindow { a: window.a, b }, k)
}

/// The 4D spectrum of a disc of radius R at distance D, under a window with the widths a
/// and b along both axes: q⁻¹ exp(−π|ω|²/q) 2π ∫₀ᴿ r exp(−πPr²) J₀(2π|Q|r) dr, where ω and Q are
/// vectors (docs/theory.md (21)).
///
/// Frequencies are (Ωx, Ωy, Ωu, Ωv). The disc is centred, so the spectrum is real.
#[must_use]
pub(crate) fn disc_light(
    radius: f64,
    distance: f64,
    window: &GaussianWindow,
    [x, y, u, v]: [f64; 4],
) -> f64 {
    let travelled = Travelled::new(distance, window);
    let [[omega_x, q_x], [omega_y, q_y]] = [[x, u], [y, v]].map(|k| travelled.frequencies(k));
    let Travelled { p, q, .. } = travelled;
    let (omega, big_q) = (libm::hypot(omega_x, omega_y), libm::hypot(q_x, q_y));
    let nodes = 16 + whole((4.0 * radius * (big_q + p.sqrt())).ceil());
    let integral = integrate(nodes, [0.0, radius], |r| {
        r * libm::exp(-PI * p * r * r) * libm::j0(TAU * big_q * r)
    });
    TAU * integral * libm::exp(-PI * omega * omega / q) / q
}

/// The field exp(−π(α x² + 2β x v + γ v²)), for example a Gaussian window after travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tilted {
    /// Coefficient α, per square metre.
    pub(crate) alpha: f64,
    /// β, per metre.
    pub(crate) beta: f64,
    /// γ.
    pub(crate) gamma: f64,
}

/// Three spectra of a field: the first without a blocker, the second with x < 0 blocked,
/// and the third with x > 0 blocked. The first spectrum is F₀ = A exp(−πa²Ω'²) with A = γ^(−1/2)
/// exp(−πΩv²/γ) a, 1/a² = α − β²/γ and Ω' = Ωx − βΩv/γ. The other two spectra are F₀/2 ∓ i/√π · A ·
/// Dawson(√π a Ω') (docs/theory.md (22)).
#[must_use]
pub(crate) fn half_planes(field: &Tilted, [x, v]: [f64; 2]) -> [Complex; 3] {
    let Tilted { alpha, beta, gamma } = *field;
    let a = (alpha - beta * beta / gamma).sqrt().recip();
    let along = x - beta * v / gamma;
    let scale = a * libm::exp(-PI * v * v / gamma) / gamma.sqrt();
    let even = scale * libm::exp(-PI * (a * along).powi(2));
    let odd = scale / PI.sqrt() * dawson(PI.sqrt() * a * along);
    let half = Complex::new(0.5 * even, -odd);
    [even.into(), half, half.conj()]
}

/// Dawson's integral exp(−x²) ∫₀ˣ exp(t²) dt, by a Gauss rule, since the integrand is an
/// entire function.
fn dawson(x: f64) -> f64 {
    integrate(24 + whole((x * x).ceil()), [0.0, x], |t| {
        libm::exp(t * t - x * x)
    })
}

/// The windowed spectrum of an area light at a distance d behind a grating: Σ cₙ I(D; Ωx −
/// n f, Ωv + n f d), where I is the spectrum without the grating.
#[must_use]
pub(crate) fn through_grating(
    bench: &GaussianBlock,
    grating: &CosineGrating,
    window: &GaussianWindow,
    [x, v]: [f64; 2],
) -> Complex {
    let distance = bench.to_blockers + bench.below;
    let lines = grating.lines().into_iter();
    lines
        .map(|(f, c)| c * area_light(bench.light, distance, window, [x - f, v + f * bench.below]))
        .sum()
}

/// The windowed spectrum of the light that a strip blocks. `strip` contains the strip's
/// lowest and highest coordinate in metres. The spectrum is a double integral over the position y
/// on the strip and the position y₀ on the light, with v = (y − y₀)/d₁ and x = y + d₂ v.
#[must_use]
pub(crate) fn blocked_by_strip(
    bench: &GaussianBlock,
    strip: [f64; 2],
    window: &GaussianWindow,
    [omega_x, omega_v]: [f64; 2],
) -> Complex {
    let half = 0.5 * bench.light;
    let nodes = 32
        + whole((2.0 * (bench.light + strip[1] - strip[0]) * libm::hypot(omega_x, omega_v)).ceil());
    let sum: Complex = integrate(nodes, strip, |y| {
        integrate(nodes, [-half, half], |origin| {
            let v = (y - origin) / bench.to_blockers;
            let x = y + bench.below * v;
            let (p, q) = (x / window.a, v / window.b);
            Complex::from_polar(
                libm::exp(-PI * (p * p + q * q)),
                -TAU * (omega_x * x + omega_v * v),
            )
        })
    });
    sum / bench.to_blockers
}

/// The spectrum of a field times g(v) = (1 + v²)^(−3/2). It is computed from spectra of the
/// field under other Gaussian windows. In g(v) = 4/√π ∫₀^∞ s² exp(−s²) exp(−s²v²) ds, the factor
/// exp(−s²v²) adds s²/π to 1/b² (docs/theory.md (8)).
///
/// The integrand is even and analytic in s, so the trapezoid rule converges exponentially.
#[must_use]
pub(crate) fn shaded(
    window: &GaussianWindow,
    field: impl Fn(&GaussianWindow) -> Complex,
) -> Complex {
    // The step of 0.25 causes an error of exp(−π²/0.25²) = 1e-69. The sum ends at 6.5, which causes
    // an error of exp(−6.5²) = 5e-19.
    const STEP: f64 = 0.25;
    let nodes = (1..=26).map(|j| STEP * f64::from(j));
    let sum: Complex = nodes
        .map(|s| {
            let s2 = s * s;
            let b = (1.0 / (window.b * window.b) + s2 / PI).sqrt().recip();
            field(&GaussianWindow { a: window.a, b }) * (s2 * libm::exp(-s2))
        })
        .sum();
    sum * (4.0 * STEP / PI.sqrt())
}

/// The spectrum of the irradiance behind a grating, without a window: Σ cₙ w sinc(w(Ωx − n
/// f)) ĝ(DΩx − d₁ n f) (Durand et al. 2005, Eq. 7 without the albedo).
#[must_use]
pub(crate) fn irradiance(bench: &GaussianBlock, grating: &CosineGrating, x: f64) -> Complex {
    let w = bench.light;
    let distance = bench.to_blockers + bench.below;
    let lines = grating.lines().into_iter();
    lines
        .map(|(f, c)| c * w * sinc(w * (x - f)) * g_hat(distance * x - bench.to_blockers * f))
        .sum()
}
