//! Statements of the paper about discontinuities, about curvature, and about the cosine factor of
//! environment light.

use super::brdfs::{self, GLOSS, term};
use super::light::light_hat;
use super::planar::environment::Glow;
use super::planar::{Factor, PlanarReflection, ReflectionStep};
use super::primal::{about, between, transform};
use super::words::Statement;
use crate::orders::slope;
use etendue_field::Complex;
use etendue_theory::geometry::AffineMap;
use etendue_theory::shading::environment::irradiance;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub(super) fn statements() -> Vec<Statement> {
    let mut all: Vec<Statement> = (0..4).map(discontinuity).collect();
    all.extend(curvature());
    all.extend(cosine());
    all
}

/// Tests cosⁿ on the half-circle, whose n-th derivative is discontinuous.
fn discontinuity(n: i32) -> Statement {
    // The frequencies Ω are chosen such that |sin(π²Ω)| equals one for odd n, and |cos(π²Ω)| equals
    // one for even n.
    let shift = if n % 2 == 0 { 0.5 } else { 0.0 };
    let points: Vec<[f64; 2]> = [20, 28, 40, 56, 80, 113, 160]
        .map(|m| {
            let omega = (f64::from(m) + shift) / PI;
            let nodes = between([-FRAC_PI_2, FRAC_PI_2], 900);
            let size = transform(nodes, omega, |t| t.cos().powi(n)).norm();
            [omega.ln(), size.ln()]
        })
        .into();
    let expected = f64::from(n + 1);
    Statement {
        said: "the spectrum of a discontinuity in the n-th derivative falls off as 1/Ωⁿ⁺¹ \
            (footnote 1)",
        measured: format!(
            "exponent with which the envelope of the transform of cosⁿ on the half-circle falls, \
            for n = {n} and Ω from 6 to 51"
        ),
        number: -slope(&points),
        expected: [expected - 0.02, expected + 0.02],
        holds: "holds",
    }
}

/// The reflection that the other sections use, with the given curvature and with the
/// given factor in place of the cosine.
fn reflection(curvature: f64, before: Factor<'static>) -> PlanarReflection<'static> {
    PlanarReflection {
        curvature,
        ..brdfs::reflection(vec![term(before, Some(GLOSS))])
    }
}

/// The root mean square of Ωθ, weighted by a power spectrum.
fn spread(power: impl Fn(f64) -> f64) -> f64 {
    let [mut all, mut square] = [0.0; 2];
    for (omega, w) in about(0.0, 8.0, 80) {
        let p = power(omega) * w;
        all += p;
        square += omega * omega * p;
    }
    (square / all).sqrt()
}

fn curvature() -> Vec<Statement> {
    let curvatures = [-1.0, -0.4, 0.0, 0.4, 1.0];
    let change = |of: &dyn Fn(f64) -> f64| {
        let all = curvatures.map(of);
        let [low, high] = [f64::min, f64::max].map(|pick| all.into_iter().fold(all[0], pick));
        high / low - 1.0
    };
    // The width in Ωθ of the whole light field, for which the power |L|² is summed over Ωx.
    let everywhere = |step: ReflectionStep, before: Factor<'static>| {
        change(&|k| {
            let chain = reflection(k, before);
            spread(|t| {
                let along = about(0.0, 12.0, 90);
                along
                    .map(|(x, w)| chain.spectrum(step, [x, t], &light_hat).norm_sqr() * w)
                    .sum()
            })
        })
    };
    // The width in Ωθ at a single point 1.5 m away, for which the spectrum L is projected along Ωx.
    let eye = change(&|k| {
        let chain = reflection(k, Factor::One);
        spread(|t| {
            let along = about(0.0, 24.0, 480);
            let sum: Complex = along
                .map(|(x, w)| {
                    let off = |w| chain.spectrum(ReflectionStep::Outgoing, w, &light_hat);
                    AffineMap::<2>::travel(1.5).spectrum([x, t], &off) * w
                })
                .sum();
            sum.norm_sqr()
        })
    });
    vec![
        Statement {
            said: "curvature leaves the angular bandwidth unchanged (4.2)",
            measured: "relative change of the rms Ωθ of the light field on the surface, after \
                step 2, over k = −1 … 1 /m"
                .to_owned(),
            number: everywhere(ReflectionStep::Curvature, Factor::One),
            expected: [0.0, 1e-9],
            holds: "holds for each step on the surface",
        },
        Statement {
            said: "the same, for the light that leaves",
            measured: "the same after step 7, without the cosine".to_owned(),
            number: everywhere(ReflectionStep::Outgoing, Factor::One),
            expected: [0.0, 1e-9],
            holds: "holds on the surface, for the light as a whole",
        },
        Statement {
            said: "the same, for light that the cosine cuts",
            measured: "the same after step 7, with the cosine".to_owned(),
            number: everywhere(ReflectionStep::Outgoing, Factor::Cosine),
            expected: [1e-6, 0.1],
            holds: "holds nearly: the cosine is measured from normals that turn",
        },
        Statement {
            said: "the same, for the light that an eye sees",
            measured: "the same at a point 1.5 m away".to_owned(),
            number: eye,
            expected: [0.3, 100.0],
            holds: "does not hold after travel, and therefore Eq. 20 contains k",
        },
    ]
}

fn cosine() -> Vec<Statement> {
    let k = 0.6;
    let glow = Glow {
        amplitude: 1.0,
        mean: 0.3,
        deviation: 0.3,
    };
    // Returns the relative error of the convolution if the light is also multiplied by `pattern`
    // along the surface.
    let off = |pattern: &dyn Fn(f64) -> f64| {
        let pairs: Vec<[Complex; 2]> = (0..16)
            .map(|i| {
                let omega = 0.06 * f64::from(i);
                let plain = transform(about(0.5, 7.0, 500), omega, |s| {
                    let seen = about(glow.mean, 2.5, 120);
                    let terms = seen.map(|(t, w)| {
                        let cosine = if (t - k * s).abs() < FRAC_PI_2 {
                            (t - k * s).cos()
                        } else {
                            0.0
                        };
                        glow.value(t) * cosine * w
                    });
                    terms.sum::<f64>() * pattern(s)
                });
                [irradiance(k, omega, &|w| glow.spectrum(w)), plain]
            })
            .collect();
        let error: f64 = pairs.iter().map(|[a, b]| (a - b).norm_sqr()).sum();
        (error / pairs.iter().map(|[_, b]| b.norm_sqr()).sum::<f64>()).sqrt()
    };
    vec![
        Statement {
            said: "the cosine is a primal convolution in a special case (6.1)",
            measured: "difference between the spectra of env ⊗ cos⁺ and of the irradiance of an \
                environment on a convex surface"
                .to_owned(),
            number: off(&|_| 1.0),
            // The error of the trapezoid rule at the kink of the cosine is step²/12.
            expected: [0.0, 2e-4],
            holds: "holds for light that depends on direction alone",
        },
        Statement {
            said: "the same, with light that varies in space",
            measured: "the same, with light times 1 + cos(2π 0.3 s)".to_owned(),
            number: off(&|s| 1.0 + (TAU * 0.3 * s).cos()),
            expected: [0.1, 10.0],
            holds: "does not hold: the spectrum of such light is not a line",
        },
    ]
}
