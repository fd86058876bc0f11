//! Tests of reflections by separable BRDFs, by sums of BRDFs, by textured BRDFs, and by BRDFs
//! that vary in space.

use super::light::{PrimalSurface, frequencies, light, light_hat};
use super::operators::OperatorComparison;
use super::planar::{
    Factor, Lattice, PlanarReflection, ReflectionStep, Schlick, SeparableTerm, TextureWave,
    semi_convolution, texture,
};
use crate::rows::Line;
use crate::table1::apart;
use etendue_field::{AngleTable, Complex};
use etendue_theory::geometry::AffineMap;
use etendue_theory::shading::{PlanarLobe, cosine_hat, cosine_squared_hat};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub(super) const THETA0: f64 = 0.5;
pub(super) const THETA1: f64 = -0.4;
pub(super) const K: f64 = 0.5;

const GLOSS: PlanarLobe = PlanarLobe::Gaussian { deviation: 0.12 };
const PHONG: PlanarLobe = PlanarLobe::Phong { exponent: 30.0 };
const SCHLICK: Schlick = Schlick(0.04);

/// Returns the theory's operators for reflection by a BRDF that is a sum of separable terms.
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

/// Returns the surface of [`reflection`] in the primal domain, with a clamped cosine.
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

/// Returns the Fourier transform of [`lopsided`].
pub(super) fn lopsided_hat(q: f64) -> Complex {
    let side = cosine_hat(q - 1.0 / TAU) - cosine_hat(q + 1.0 / TAU);
    Complex::new(cosine_hat(q), -0.3 * side)
}

/// Returns the comparisons that involve all steps of a reflection at a surface.
pub(super) fn all() -> Vec<OperatorComparison> {
    let mut rows = separable();
    rows.extend(listed());
    rows.push(sum());
    rows.push(weighted());
    rows.push(textured());
    rows.push(varying());
    rows
}

fn separable() -> Vec<OperatorComparison> {
    let gaussian = |_: f64, d: f64| GLOSS.value(d);
    let row = |line,
               operator,
               surface: &PrimalSurface<'_>,
               right: SeparableTerm<'_>,
               name,
               wrong: SeparableTerm<'_>| {
        let traced = primal(surface);
        OperatorComparison {
            operator,
            line: Some(line),
            compared: "reflection after step 7".to_owned(),
            off: apart(&chain(&reflection(vec![right])), &traced),
            fault: (name, apart(&chain(&reflection(vec![wrong])), &traced)),
        }
    };
    let squared = |q: f64| Complex::from(cosine_squared_hat(q));
    let conjugate = |q: f64| lopsided_hat(-q);
    let after = |t: f64| t.cos().powi(2);
    let schlick = |t: f64| SCHLICK.reflectance(t) * t.cos();
    let glossy = |before| term(before, Some(GLOSS));
    vec![
        row(
            Line::Mirror,
            "ideal mirror, δ/cos θ",
            &PrimalSurface {
                before: &|_| 1.0,
                horizon: PI,
                ..surface(None)
            },
            term(Factor::One, None),
            "δ without 1/cos θ",
            term(Factor::Cosine, None),
        ),
        row(
            Line::Brdf,
            "cosine and Gaussian lobe",
            &surface(Some(&gaussian)),
            glossy(Factor::Cosine),
            "no cosine",
            glossy(Factor::One),
        ),
        row(
            Line::Brdf,
            "cosine and Phong lobe",
            &surface(Some(&|_, d| PHONG.value(d))),
            term(Factor::Cosine, Some(PHONG)),
            "exponent 5 % off",
            term(Factor::Cosine, Some(PlanarLobe::Phong { exponent: 31.5 })),
        ),
        row(
            Line::Separable,
            "separable, f(θ_i') = Schlick",
            &PrimalSurface {
                before: &schlick,
                ..surface(Some(&gaussian))
            },
            glossy(Factor::Schlick(SCHLICK)),
            "f left out",
            glossy(Factor::Cosine),
        ),
        row(
            Line::Separable,
            "separable, asymmetric f(θ_i')",
            &PrimalSurface {
                before: &lopsided,
                ..surface(Some(&gaussian))
            },
            glossy(Factor::Other(&lopsided_hat)),
            "f̂(Ω) instead of f̂(−Ω)",
            glossy(Factor::Other(&conjugate)),
        ),
        row(
            Line::Separable,
            "separable, h(θ_o') = cos²",
            &PrimalSurface {
                after: Some(&after),
                ..surface(Some(&gaussian))
            },
            SeparableTerm {
                after: Factor::Other(&squared),
                ..glossy(Factor::Cosine)
            },
            "h before the lobe",
            glossy(Factor::Other(&|q| {
                // On the half-circle, cos θ cos² θ = (3 cos θ + cos 3θ)/4.
                let third = 3.0 / TAU;
                let triple = |q: f64| {
                    let half = |t: f64| {
                        let angle = PI * PI * t;
                        if angle.abs() < 1e-9 {
                            PI
                        } else {
                            PI * angle.sin() / angle
                        }
                    };
                    0.5 * (half(q - third) + half(q + third))
                };
                Complex::from(0.75 * cosine_hat(q) + 0.25 * triple(q))
            })),
        ),
    ]
}

/// Compares reflections in which the factors f and h are lists of values over |θ|. These factors
/// have kinks.
fn listed() -> [OperatorComparison; 2] {
    let table = AngleTable {
        values: [1.0, 0.9, 0.2, 0.3, 0.8].into(),
    };
    // Interpolates a list of factors between the nearest two angles.
    let value = |t: f64| {
        let at = t.abs() / FRAC_PI_2 * 4.0;
        let hats = [1.0, 0.9, 0.2, 0.3, 0.8].iter().zip(0_u32..);
        hats.map(|(v, i)| v * (1.0 - (at - f64::from(i)).abs()).max(0.0))
            .sum::<f64>()
    };
    let gaussian = |_: f64, d: f64| GLOSS.value(d);
    let with_cosine = |t: f64| value(t) * t.cos();
    let f = SeparableTerm {
        before: Factor::TableCosine(&table),
        ..term(Factor::Cosine, Some(GLOSS))
    };
    let h = SeparableTerm {
        after: Factor::Table(&table),
        ..term(Factor::Cosine, Some(GLOSS))
    };
    let kinks = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0].map(|i| FRAC_PI_2 * i / 4.0);
    let off = |term: SeparableTerm<'_>, surface: &PrimalSurface<'_>| {
        apart(&chain(&reflection(vec![term])), &primal(surface))
    };
    let [by_f, by_h] = [
        PrimalSurface {
            before: &with_cosine,
            kinks: &kinks,
            ..surface(Some(&gaussian))
        },
        PrimalSurface {
            after: Some(&value),
            kinks: &kinks,
            ..surface(Some(&gaussian))
        },
    ];
    let row = |operator, off, fault| OperatorComparison {
        operator,
        line: Some(Line::Separable),
        compared: "reflection after step 7".to_owned(),
        off,
        fault,
    };
    [
        row(
            "separable, f(θ_i') by a list",
            off(f, &by_f),
            ("h for f", off(h, &by_f)),
        ),
        row(
            "separable, h(θ_o') by a list",
            off(h, &by_h),
            ("f for h", off(f, &by_h)),
        ),
    ]
}

/// Compares, with the primal domain, reflection by a sum of two lobes with the weights w = ½ (1 +
/// 0.9 cos(2π 1.5 s + 0.4)) and 1 − w.
fn weighted() -> OperatorComparison {
    let weight = |s: f64| 0.5 * (1.0 + 0.9 * (TAU * 1.5 * s + 0.4).cos());
    let both = |s: f64, d: f64| weight(s) * GLOSS.value(d) + (1.0 - weight(s)) * PHONG.value(d);
    let traced = primal(&surface(Some(&both)));
    let waves = |sign: f64| {
        let side = Complex::from_polar(sign * 0.225, 0.4);
        [(0.0, Complex::from(0.5)), (1.5, side), (-1.5, side.conj())].map(
            |(frequency, amplitude)| TextureWave {
                frequency,
                amplitude,
            },
        )
    };
    let [one, rest] = [1.0, -1.0].map(waves);
    let by = |one: &[TextureWave], rest: &[TextureWave]| {
        let of = |lobe, weight| SeparableTerm {
            weight: Some(weight),
            ..term(Factor::Cosine, Some(lobe))
        };
        let terms = vec![of(GLOSS, one), of(PHONG, rest)];
        apart(&chain(&reflection(terms)), &traced)
    };
    OperatorComparison {
        operator: "weighted sum of two lobes",
        line: Some(Line::SpaceVarying),
        compared: "reflection after step 7".to_owned(),
        off: by(&one, &rest),
        fault: ("weights swapped", by(&rest, &one)),
    }
}

fn sum() -> OperatorComparison {
    let gaussian = |_: f64, d: f64| GLOSS.value(d);
    let phong = |_: f64, d: f64| PHONG.value(d);
    let schlick = |t: f64| SCHLICK.reflectance(t) * t.cos();
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
    let mut terms = vec![
        term(Factor::Cosine, Some(GLOSS)),
        term(Factor::Schlick(SCHLICK), Some(PHONG)),
        term(Factor::Other(&lopsided_hat), None),
    ];
    let right = chain(&reflection(terms.clone()));
    terms.remove(1);
    OperatorComparison {
        operator: "sum of three separable terms",
        line: Some(Line::Separable),
        compared: "reflection after step 7".to_owned(),
        off: apart(&right, &traced),
        fault: (
            "a term left out",
            apart(&chain(&reflection(terms)), &traced),
        ),
    }
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
        let side = Complex::from_polar(0.35, 0.4);
        let waves = [
            (0.0, Complex::from(1.0)),
            (frequency, side),
            (-frequency, side.conj()),
        ]
        .map(|(frequency, amplitude)| TextureWave {
            frequency,
            amplitude,
        });
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
