//! Tests of reflections by separable BRDFs, by sums of BRDFs, by textured BRDFs, and by BRDFs
//! that vary in space.

use super::light::{PrimalSurface, frequencies, light, light_hat};
use super::operators::OperatorComparison;
use super::planar::{
    Factor, Lattice, PlanarReflection, ReflectionStep, Schlick, SeparableTerm, TextureWave,
    semi_convolution, table_hat, texture,
};
use crate::rows::Line;
use crate::table1::apart;
use etendue_field::{AngleTable, Complex};
use etendue_theory::geometry::AffineMap;
use etendue_theory::shading::{PlanarLobe, cosine_hat, cosine_squared_hat};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const THETA0: f64 = 0.5;
pub(super) const THETA1: f64 = -0.4;
pub(super) const K: f64 = 0.5;

pub(super) const GLOSS: PlanarLobe = PlanarLobe::Gaussian { deviation: 0.12 };
const PHONG: PlanarLobe = PlanarLobe::Phong { exponent: 30.0 };
const SCHLICK: Schlick = Schlick(0.04);

/// The theory's operators for reflection by a BRDF that is a sum of separable terms.
pub(super) fn reflection(terms: Vec<SeparableTerm<'_>>) -> PlanarReflection<'_> {
    PlanarReflection {
        incidence: THETA0,
        outgoing: THETA1,
        curvature: K,
        terms,
        // The lattice is wide enough for the narrowest Gaussian, whose spectrum has a standard
        // deviation of 0.75 cycles per radian.
        lattice: Lattice::circle(12.0),
    }
}

/// The surface of [`reflection`] in the primal domain, with a clamped cosine.
pub(super) fn surface<'a>(lobe: Option<&'a dyn Fn(f64, f64) -> f64>) -> PrimalSurface<'a> {
    PrimalSurface {
        theta0: THETA0,
        theta1: THETA1,
        k: K,
        horizon: FRAC_PI_2,
        before: &f64::cos,
        lobe,
        after: None,
        kinks: &[],
        texture: &|_| 1.0,
    }
}

pub(super) fn primal(surface: &PrimalSurface<'_>) -> Vec<Complex> {
    let each = frequencies().into_iter();
    each.map(|omega| surface.transform(&light, omega)).collect()
}

pub(super) fn said(f: impl Fn([f64; 2]) -> Complex) -> Vec<Complex> {
    frequencies().into_iter().map(f).collect()
}

pub(super) fn chain(reflection: &PlanarReflection<'_>) -> Vec<Complex> {
    said(|omega| reflection.spectrum(ReflectionStep::Outgoing, omega, &light_hat))
}

pub(super) const fn term(before: Factor<'_>, lobe: Option<PlanarLobe>) -> SeparableTerm<'_> {
    SeparableTerm {
        before,
        lobe,
        after: Factor::One,
        weight: None,
    }
}

/// Returns cos θ (1 + 0.6 sin θ), which is not an even function. The factor sin θ shifts a spectrum
/// by ± 1/2π.
pub(super) fn lopsided(theta: f64) -> f64 {
    theta.cos() * (1.0 + 0.6 * theta.sin())
}

/// The Fourier transform of [`lopsided`].
pub(super) fn lopsided_hat(q: f64) -> Complex {
    let side = cosine_hat(q - 1.0 / TAU) - cosine_hat(q + 1.0 / TAU);
    Complex::new(cosine_hat(q), -0.3 * side)
}

/// The comparisons that involve all steps of a reflection at a surface.
pub(super) fn all() -> Vec<OperatorComparison> {
    let mut rows = separable();
    rows.extend(sums());
    rows.push(textured());
    rows.push(varying());
    rows
}

/// Compares the chains of two sums of terms, of which the second is wrong, with the field that is
/// traced in the primal domain.
fn row(
    line: Line,
    operator: &'static str,
    traced: &[Complex],
    right: Vec<SeparableTerm<'_>>,
    (fault, wrong): (&'static str, Vec<SeparableTerm<'_>>),
) -> OperatorComparison {
    let off = |terms| apart(&chain(&reflection(terms)), traced);
    OperatorComparison {
        operator,
        line: Some(line),
        compared: "reflection after step 7".to_owned(),
        off: off(right),
        fault: (fault, off(wrong)),
    }
}

/// Compares reflections by BRDFs of one term. Factors f and h that are lists of values over |θ|
/// have kinks.
fn separable() -> Vec<OperatorComparison> {
    let gaussian = |_: f64, d: f64| GLOSS.value(d);
    let phong = |_: f64, d: f64| PHONG.value(d);
    let glossy = |before| term(before, Some(GLOSS));
    let with_after = |after| SeparableTerm {
        after,
        ..glossy(Factor::Cosine)
    };
    let plain = || surface(Some(&gaussian));
    let conjugate = |q: f64| lopsided_hat(-q);
    let squared = |q: f64| Complex::from(cosine_squared_hat(q));
    let table = AngleTable {
        values: [1.0, 0.9, 0.2, 0.3, 0.8].into(),
    };
    // Interpolates the list between the nearest two angles.
    let listed = |t: f64| {
        let at = t.abs() / FRAC_PI_2 * 4.0;
        let hats = [1.0, 0.9, 0.2, 0.3, 0.8].iter().zip(0_u32..);
        hats.map(|(v, i)| v * (1.0 - (at - f64::from(i)).abs()).max(0.0))
            .sum::<f64>()
    };
    let kinks = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0].map(|i| FRAC_PI_2 * i / 4.0);
    let listed_f = |q: f64| Complex::from(table_hat(&table, libm::cos, q));
    let listed_h = |q: f64| Complex::from(table_hat(&table, |_| 1.0, q));
    let [f, h] = [
        glossy(Factor::Other(&listed_f)),
        with_after(Factor::Other(&listed_h)),
    ];
    let cases = [
        (
            Line::Mirror,
            "ideal mirror, δ/cos θ",
            PrimalSurface {
                before: &|_| 1.0,
                horizon: PI,
                ..surface(None)
            },
            term(Factor::One, None),
            ("δ without 1/cos θ", term(Factor::Cosine, None)),
        ),
        (
            Line::Brdf,
            "cosine and Gaussian lobe",
            plain(),
            glossy(Factor::Cosine),
            ("no cosine", glossy(Factor::One)),
        ),
        (
            Line::Brdf,
            "cosine and Phong lobe",
            surface(Some(&phong)),
            term(Factor::Cosine, Some(PHONG)),
            (
                "exponent 5 % off",
                term(Factor::Cosine, Some(PlanarLobe::Phong { exponent: 31.5 })),
            ),
        ),
        (
            Line::Separable,
            "separable, f(θ_i') = Schlick",
            PrimalSurface {
                before: &schlick,
                ..plain()
            },
            glossy(Factor::Other(&schlick_hat)),
            ("f left out", glossy(Factor::Cosine)),
        ),
        (
            Line::Separable,
            "separable, asymmetric f(θ_i')",
            PrimalSurface {
                before: &lopsided,
                ..plain()
            },
            glossy(Factor::Other(&lopsided_hat)),
            ("f̂(Ω) instead of f̂(−Ω)", glossy(Factor::Other(&conjugate))),
        ),
        (
            Line::Separable,
            "separable, h(θ_o') = cos²",
            PrimalSurface {
                after: Some(&|t| t.cos().powi(2)),
                ..plain()
            },
            with_after(Factor::Other(&squared)),
            (
                "h before the lobe",
                glossy(Factor::Other(&cosine_cubed_hat)),
            ),
        ),
        (
            Line::Separable,
            "separable, f(θ_i') by a list",
            PrimalSurface {
                before: &|t| listed(t) * t.cos(),
                kinks: &kinks,
                ..plain()
            },
            f,
            ("h for f", h),
        ),
        (
            Line::Separable,
            "separable, h(θ_o') by a list",
            PrimalSurface {
                after: Some(&listed),
                kinks: &kinks,
                ..plain()
            },
            h,
            ("f for h", f),
        ),
    ];
    let rows = cases.map(|(line, operator, surface, right, (fault, wrong))| {
        let traced = primal(&surface);
        row(line, operator, &traced, vec![right], (fault, vec![wrong]))
    });
    rows.into()
}

/// Schlick's reflectance times the cosine.
fn schlick(theta: f64) -> f64 {
    SCHLICK.reflectance(theta) * theta.cos()
}

/// The Fourier transform of [`schlick`] on the half-circle.
fn schlick_hat(q: f64) -> Complex {
    SCHLICK.cosine_hat(q).into()
}

/// The Fourier transform of cos³ on the half-circle, where it is (3 cos θ + cos 3θ)/4.
fn cosine_cubed_hat(q: f64) -> Complex {
    let third = 3.0 / TAU;
    let half = |t: f64| {
        let angle = PI * PI * t;
        if angle.abs() < 1e-9 {
            PI
        } else {
            PI * angle.sin() / angle
        }
    };
    let triple = 0.5 * (half(q - third) + half(q + third));
    Complex::from(0.75 * cosine_hat(q) + 0.25 * triple)
}

/// Compares reflections by BRDFs of several terms. The last BRDF has two lobes with the weights w =
/// ½ (1 + 0.9 cos(2π 1.5 s + 0.4)) and 1 − w.
fn sums() -> [OperatorComparison; 2] {
    let gaussian = |_: f64, d: f64| GLOSS.value(d);
    let phong = |_: f64, d: f64| PHONG.value(d);
    let parts = [
        surface(Some(&gaussian)),
        PrimalSurface {
            before: &schlick,
            ..surface(Some(&phong))
        },
        PrimalSurface {
            before: &lopsided,
            ..surface(None)
        },
    ]
    .map(|part| primal(&part));
    let traced: Vec<Complex> = (0..parts[0].len())
        .map(|i| parts.iter().map(|part| part[i]).sum())
        .collect();
    let terms = [
        term(Factor::Cosine, Some(GLOSS)),
        term(Factor::Other(&schlick_hat), Some(PHONG)),
        term(Factor::Other(&lopsided_hat), None),
    ];
    let weight = |s: f64| 0.5 * (1.0 + 0.9 * (TAU * 1.5 * s + 0.4).cos());
    let both = |s: f64, d: f64| weight(s) * GLOSS.value(d) + (1.0 - weight(s)) * PHONG.value(d);
    let [one, rest] = [1.0, -1.0].map(|sign: f64| waves(0.5, 1.5, sign * 0.225));
    let weighted = |one, rest| {
        let of = |lobe, weight| SeparableTerm {
            weight: Some(weight),
            ..term(Factor::Cosine, Some(lobe))
        };
        vec![of(GLOSS, one), of(PHONG, rest)]
    };
    [
        row(
            Line::Separable,
            "sum of three separable terms",
            &traced,
            terms.to_vec(),
            ("a term left out", vec![terms[0], terms[2]]),
        ),
        row(
            Line::SpaceVarying,
            "weighted sum of two lobes",
            &primal(&surface(Some(&both))),
            weighted(&one, &rest),
            ("weights swapped", weighted(&rest, &one)),
        ),
    ]
}

/// The waves of mean + 2 amplitude cos(2π f s + 0.4), for the frequency f.
fn waves(mean: f64, frequency: f64, amplitude: f64) -> [TextureWave; 3] {
    let side = Complex::from_polar(amplitude, 0.4);
    [
        (0.0, Complex::from(mean)),
        (frequency, side),
        (-frequency, side.conj()),
    ]
    .map(|(frequency, amplitude)| TextureWave {
        frequency,
        amplitude,
    })
}

/// Compares, with the primal domain, a glossy reflection multiplied by the texture 1 + 0.7 cos(2π
/// 1.5 s + 0.4).
fn textured() -> OperatorComparison {
    let gaussian = |_: f64, d: f64| GLOSS.value(d);
    let traced = primal(&PrimalSurface {
        texture: &|s| 1.0 + 0.7 * (TAU * 1.5 * s + 0.4).cos(),
        ..surface(Some(&gaussian))
    });
    let gloss = reflection(vec![term(Factor::Cosine, Some(GLOSS))]);
    let with = |frequency: f64| {
        let waves = waves(1.0, frequency, 0.35);
        let back = |w: [f64; 2]| gloss.spectrum(ReflectionStep::Back, w, &light_hat);
        said(|omega| {
            AffineMap::<2>::outgoing(THETA1).spectrum(omega, &|w| texture(&waves, w, &back))
        })
    };
    OperatorComparison {
        operator: "texture",
        line: Some(Line::Texture),
        compared: "reflection times 1 + 0.7 cos(2π 1.5 s + 0.4)".to_owned(),
        off: apart(&with(1.5), &traced),
        fault: (
            "frequency of the texture 5 % off",
            apart(&with(1.575), &traced),
        ),
    }
}

/// Compares reflection by the BRDF ρ(s, δ) = exp(−½ zᵀ C⁻¹ z)/√2π σ, whose lobe rotates along the
/// surface.
fn varying() -> OperatorComparison {
    let bell = super::light::Bell {
        amplitude: 3.0,
        mean: [0.1, 0.02],
        covariance: [[0.04, 0.008], [0.008, 0.012]],
    };
    let lobe = |s: f64, d: f64| bell.value([s, d]);
    let traced = primal(&surface(Some(&lobe)));
    let mirror = reflection(vec![term(Factor::Cosine, None)]);
    let lit = |w: [f64; 2]| mirror.spectrum(ReflectionStep::Mirror, w, &light_hat);
    // The light is 0.3 m wide, and sampling frequencies on a lattice repeats this light every 8
    // m.
    let lattice = Lattice {
        spacing: 0.125,
        reach: 12.0,
    };
    let through = |brdf: &dyn Fn([f64; 2]) -> Complex| {
        let off = AffineMap::<2>::back(K).then(&AffineMap::<2>::outgoing(THETA1));
        said(|omega| off.spectrum(omega, &|w| semi_convolution(&lattice, w, brdf, &lit)))
    };
    let straight = |[x, t]: [f64; 2]| {
        let upright = super::light::Bell {
            covariance: [[0.04, 0.0], [0.0, 0.012]],
            ..bell
        };
        upright.spectrum([x, t])
    };
    OperatorComparison {
        operator: "space-varying BRDF, semi-convolution",
        line: Some(Line::SpaceVarying),
        compared: "reflection by a lobe that turns along s".to_owned(),
        off: apart(&through(&|w| bell.spectrum(w)), &traced),
        fault: ("a separable ρ instead", apart(&through(&straight), &traced)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_a_mirror_factors_before_and_after_are_one_with_the_sign_turned() {
        let before =
            |hat: &dyn Fn(f64) -> Complex| chain(&reflection(vec![term(Factor::Other(hat), None)]));
        let after = SeparableTerm {
            after: Factor::Other(&lopsided_hat),
            ..term(Factor::One, None)
        };
        let after = chain(&reflection(vec![after]));
        assert!(apart(&before(&|q| lopsided_hat(-q)), &after) < 1e-14); // rounding of 10² terms
        assert!(apart(&before(&lopsided_hat), &after) > 0.05);
    }
}
