//! Tests of single factors (cosines, Fresnel factors and lobes), of diffuse irradiance, and of
//! environments.

use super::operators::OperatorComparison;
use super::planar::environment::{Glow, mirrored_differential_irradiance};
use super::planar::{Lattice, Schlick, angular_product};
use super::primal::{about, between, transform, wave};
use crate::rows::Line;
use crate::table1::apart;
use etendue_field::{Complex, Fresnel};
use etendue_theory::shading::environment::irradiance;
use etendue_theory::shading::{
    PlanarLobe, cosine_hat, cosine_squared_hat, fresnel_cosine_hat, fresnel_reflectance, g_hat,
};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The 24 frequencies at which transforms are compared, in cycles per radian.
fn line() -> Vec<f64> {
    (0..24).map(|i| 0.26 * f64::from(i) + 0.01).collect()
}

fn curve(f: impl Fn(f64) -> f64) -> Vec<Complex> {
    line().into_iter().map(|omega| f(omega).into()).collect()
}

/// The transform, by quadrature, of an even function on |θ| < `end` that is given for θ >
/// 0. The panels of the quadrature are finer near θ = 0 and near `end`.
fn plain(end: f64, inner: f64, f: &dyn Fn(f64) -> f64) -> Vec<Complex> {
    let mut cuts = vec![0.0];
    let mut at = inner;
    while at < end {
        cuts.push(at);
        at *= 2.0;
    }
    cuts.push(end);
    let panels = |omega: f64| {
        let each = cuts.windows(2).map(|cut| {
            let half = transform(between([cut[0], cut[1]], 70), omega, f);
            Complex::from(2.0 * half.re)
        });
        each.sum()
    };
    line().into_iter().map(panels).collect()
}

/// The comparisons of single factors, without a surface.
pub(super) fn all() -> Vec<OperatorComparison> {
    let mut rows = cosines();
    rows.extend(fresnel());
    rows.extend(lobes());
    rows.push(differential_irradiance());
    rows.extend(environments());
    rows
}

fn cosines() -> Vec<OperatorComparison> {
    let clamped = plain(FRAC_PI_2, 1.0, &f64::cos);
    let squared = plain(FRAC_PI_2, 1.0, &|t| t.cos().powi(2));
    let orders = 0..24;
    let series: Vec<Complex> = orders
        .clone()
        .map(|n| {
            let nodes = between([-FRAC_PI_2, FRAC_PI_2], 120);
            transform(nodes, f64::from(n) / TAU, f64::cos) / TAU
        })
        .collect();
    let said: Vec<Complex> = orders.clone().map(|n| cosine_series(n).into()).collect();
    let printed: Vec<Complex> = orders
        .map(|n| cosine_hat(f64::from(n) / TAU).into())
        .collect();
    vec![
        OperatorComparison {
            operator: "clamped cosine",
            line: Some(Line::Cosine),
            compared: "cos⁺^(Ω) with ∫ cos θ e^(−2πiΩθ)".to_owned(),
            off: apart(&curve(cosine_hat), &clamped),
            fault: (
                "cosine counted twice",
                apart(&curve(cosine_squared_hat), &clamped),
            ),
        },
        OperatorComparison {
            operator: "cosine along latitudes",
            line: Some(Line::Cosine),
            compared: "C₂(Ω) with ∫ cos² φ e^(−2πiΩφ)".to_owned(),
            off: apart(&curve(cosine_squared_hat), &squared),
            fault: ("cosine counted once", apart(&curve(cosine_hat), &squared)),
        },
        OperatorComparison {
            operator: "full-circle series",
            line: Some(Line::Cosine),
            compared: "24 coefficients of cos⁺".to_owned(),
            off: apart(&said, &series),
            fault: (
                "the transform instead of the series",
                apart(&printed, &series),
            ),
        },
    ]
}

/// The coefficient of e^(inθ) in the Fourier series of the clamped cosine on the full
/// circle, which is [`cosine_hat`](n/2π)/2π.
///
/// Durand et al. 2005 print only the transform (Eq. 13).
fn cosine_series(n: i32) -> f64 {
    cosine_hat(f64::from(n) / TAU) / TAU
}

fn fresnel() -> Vec<OperatorComparison> {
    let glass = Fresnel::Dielectric { index: 1.5 };
    let metal = Fresnel::Conductor { n: 0.96, k: 6.69 };
    let schlick = Schlick(0.04);
    let row = |operator,
               hat: &dyn Fn(f64) -> f64,
               share: &dyn Fn(f64) -> f64,
               name,
               wrong: &dyn Fn(f64) -> f64| {
        let primal = plain(FRAC_PI_2, 0.5, &|t| share(t) * t.cos());
        OperatorComparison {
            operator,
            line: Some(Line::Separable),
            compared: "transform of F cos⁺".to_owned(),
            off: apart(&curve(hat), &primal),
            fault: (name, apart(&curve(wrong), &primal)),
        }
    };
    // Fresnel's formulas with sines and tangents of the refracted angle. The theory uses another
    // form of these formulas.
    let snell = |theta: f64| {
        let theta = theta.max(1e-4);
        let beyond = (theta.sin() / 1.5).asin();
        let across = (theta - beyond).sin() / (theta + beyond).sin();
        let along = (theta - beyond).tan() / (theta + beyond).tan();
        0.5 * (across * across + along * along)
    };
    // Fresnel's formulas for metals, written in real numbers (Born and Wolf 1999, section 14.2).
    let conductor = |theta: f64| {
        let (n, k, sine, cosine) = (0.96_f64, 6.69_f64, theta.sin(), theta.cos());
        let t0 = n * n - k * k - sine * sine;
        let ab = (t0 * t0 + 4.0 * n * n * k * k).sqrt();
        let a = (0.5 * (ab + t0)).sqrt();
        let across =
            (ab + cosine * cosine - 2.0 * a * cosine) / (ab + cosine * cosine + 2.0 * a * cosine);
        let (s2, t) = (sine * sine, 2.0 * a * cosine * sine * sine);
        let along =
            across * (cosine * cosine * ab + s2 * s2 - t) / (cosine * cosine * ab + s2 * s2 + t);
        0.5 * (across + along)
    };
    let approximation = |theta: f64| 0.04 + 0.96 * (1.0 - theta.cos()).powi(5);
    vec![
        row(
            "Fresnel · cosine, n = 1.5",
            &|w| fresnel_cosine_hat(glass, w),
            &snell,
            "Schlick's formula instead",
            &|w| schlick.cosine_hat(w),
        ),
        row(
            "Fresnel · cosine, aluminium",
            &|w| fresnel_cosine_hat(metal, w),
            &conductor,
            "constant F",
            &|w| fresnel_reflectance(metal, 0.0) * cosine_hat(w),
        ),
        row(
            "Fresnel · cosine, Schlick F₀ = 0.04",
            &|w| schlick.cosine_hat(w),
            &approximation,
            "F₀ 5 % off",
            &|w| Schlick(0.042).cosine_hat(w),
        ),
    ]
}

fn lobes() -> Vec<OperatorComparison> {
    // Each row has a second implementation of a lobe's shape, which a separate quadrature
    // normalises, and the end and the scale of the lobe.
    let row =
        |operator, [lobe, off]: [PlanarLobe; 2], ends: [f64; 2], shape: &dyn Fn(f64) -> f64| {
            let [end, inner] = ends;
            let area = 2.0 * plain_integral(end, inner, shape);
            let primal = plain(end, inner, &|t| shape(t) / area);
            OperatorComparison {
                operator,
                line: Some(Line::Brdf),
                compared: "ρ̂'(Ω) of a lobe of unit integral".to_owned(),
                off: apart(&curve(|w| lobe.spectrum(w)), &primal),
                fault: (
                    "width or exponent 5 % off",
                    apart(&curve(|w| off.spectrum(w)), &primal),
                ),
            }
        };
    let phong = |exponent| PlanarLobe::Phong { exponent };
    let gaussian = |deviation| PlanarLobe::Gaussian { deviation };
    let beckmann = |roughness| PlanarLobe::Beckmann { roughness };
    let ggx = |roughness| PlanarLobe::Ggx { roughness };
    vec![
        row(
            "lobe, Phong n = 20",
            [20.0, 21.0].map(phong),
            [FRAC_PI_2, 0.2],
            &|t| t.cos().powi(20),
        ),
        row(
            "lobe, Phong n = 3",
            [3.0, 3.15].map(phong),
            [FRAC_PI_2, 0.5],
            &|t| t.cos().powi(3),
        ),
        row(
            "lobe, Gaussian σ = 0.08",
            [0.08, 0.084].map(gaussian),
            [0.72, 0.09],
            &|t| (-0.5 * (t / 0.08).powi(2)).exp(),
        ),
        row(
            "lobe, Beckmann α = 0.1",
            [0.1, 0.105].map(beckmann),
            [PI, 0.1],
            &|t| {
                let slope = (0.5 * t).tan().min(1e3);
                (-100.0 * slope * slope).exp() / (0.5 * t).cos().powi(4)
            },
        ),
        row(
            "lobe, GGX α = 0.1",
            [0.1, 0.105].map(ggx),
            [PI, 0.1],
            // The GGX distribution of Walter et al. is 1/(cos⁴ τ (α² + tan² τ)²) as a function of
            // the cosine of δ.
            &|t| (1.01 - 0.99 * t.cos()).powi(-2),
        ),
    ]
}

fn plain_integral(end: f64, inner: f64, f: &dyn Fn(f64) -> f64) -> f64 {
    let mut sum = 0.0;
    let (mut low, mut high) = (0.0, inner.min(end));
    loop {
        sum += super::primal::integral(between([low, high], 70), f);
        if high >= end {
            return sum;
        }
        (low, high) = (high, (2.0 * high).min(end));
    }
}

/// Checks dE = ℓ g in slopes. Its spectrum is the convolution of Eq. 7.
fn differential_irradiance() -> OperatorComparison {
    let bell = &super::light::LIGHT[0];
    let omegas = [[0.0, 0.0], [0.4, 0.2], [-0.3, 0.5], [0.6, -0.9]];
    let g = |v: f64| (1.0 + v * v).powf(-1.5);
    let primal: Vec<Complex> = omegas
        .iter()
        .map(|[x, v]| {
            let positions = about(bell.mean[0], 2.2, 60);
            positions
                .map(|(at, w)| {
                    let slopes = about(bell.mean[1], 2.6, 100);
                    let inner = transform(slopes, *v, |t| bell.value([at, t]) * g(t));
                    inner * wave(x * at) * w
                })
                .sum()
        })
        .collect();
    // The factor g decreases as 1/v³ and has unbounded support, so its periodic copies at a
    // distance of 3000 add an error of 10⁻¹⁰.
    let lattice = Lattice {
        spacing: 1.0 / 3000.0,
        reach: 6.0,
    };
    let with = |factor: &dyn Fn(f64) -> Complex| -> Vec<Complex> {
        let each = omegas.iter();
        each.map(|w| angular_product(&lattice, *w, factor, &|w| bell.spectrum(w)))
            .collect()
    };
    let area = |q: f64| Complex::from(2.0 * g_hat(q));
    OperatorComparison {
        operator: "differential irradiance, g",
        line: None,
        compared: "L ⊗ ĝ with the transform of ℓ (1 + v²)^(−3/2)".to_owned(),
        off: apart(&with(&|q| g_hat(q).into()), &primal),
        fault: ("g of twice the size", apart(&with(&area), &primal)),
    }
}

/// An environment of two Gaussians.
const SKY: [Glow; 2] = [
    Glow {
        amplitude: 1.0,
        mean: 0.3,
        deviation: 0.4,
    },
    Glow {
        amplitude: 0.5,
        mean: -0.5,
        deviation: 0.25,
    },
];

/// The spectrum of [`SKY`].
pub(super) fn sky_hat(w: f64) -> Complex {
    SKY.iter().map(|glow| glow.spectrum(w)).sum()
}

/// The transform, by quadrature, of the field dE'_r(s, θ_r') = env(k s − θ_r') cos θ_r' of
/// the environment [`SKY`]. The width of this field over s is the width of the environment's
/// Gaussians divided by |k|.
pub(super) fn mirrored_sky(k: f64, [x, t]: [f64; 2]) -> Complex {
    let env = |t: f64| -> f64 { SKY.iter().map(|glow| glow.value(t)).sum() };
    let mirrored = between([-FRAC_PI_2, FRAC_PI_2], 60).into_iter();
    mirrored
        .map(|(at, w)| {
            let along = about(at / k, 4.0 / k.abs(), 160);
            let inner = transform(along, x, |s| env(k * s - at));
            inner * wave(t * at) * (w * at.cos())
        })
        .sum()
}

fn environments() -> Vec<OperatorComparison> {
    let mut rows = Vec::new();
    for (operator, diffuse, k) in [
        (
            "environment map, convex",
            "irradiance of an environment, convex",
            0.6,
        ),
        (
            "environment map, concave",
            "irradiance of an environment, concave",
            -0.4_f64,
        ),
    ] {
        let omegas: Vec<[f64; 2]> = (0..12)
            .map(|i| [0.05 * f64::from(i) - 0.2, 0.3 * f64::from(i % 5) - 0.5])
            .collect();
        let primal = |w: [f64; 2]| mirrored_sky(k, w);
        let of = |f: &dyn Fn([f64; 2]) -> Complex| -> Vec<Complex> {
            omegas.iter().map(|w| f(*w)).collect()
        };
        let traced = of(&primal);
        let right = |w| mirrored_differential_irradiance(k, w, &sky_hat);
        rows.push(OperatorComparison {
            operator,
            line: Some(Line::Environment),
            compared: format!("dE'_r^ at k = {k} /m"),
            off: apart(&of(&right), &traced),
            fault: (
                "1/|k| left out",
                apart(&of(&|w| right(w) * k.abs()), &traced),
            ),
        });
        let floor = of(&|[x, _]| primal([x, 0.0]));
        let turned = |[x, _]: [f64; 2]| irradiance(-k, x, &sky_hat);
        rows.push(OperatorComparison {
            operator: diffuse,
            line: Some(Line::Environment),
            compared: format!("E^ at k = {k} /m"),
            off: apart(&of(&|[x, _]| irradiance(k, x, &sky_hat)), &floor),
            fault: ("wrong sign of k", apart(&of(&turned), &floor)),
        });
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_adds_up_to_the_cosine() {
        for theta in [0.0_f64, 0.4, 1.2, 2.0, 3.0] {
            let wave = |n: i32| cosine_series(n) * libm::cos(f64::from(n) * theta);
            let sum = wave(0) + 2.0 * (1..4000).map(wave).sum::<f64>();
            // The tolerance covers the omitted coefficients beyond 4000, which fall as 1/n² and add
            // up to less than 2/π/4000.
            assert!((sum - theta.cos().max(0.0)).abs() < 2e-4, "{theta}");
            // A transform is 2π times the coefficient. The test detects if the transform is used in
            // place of the coefficient.
            assert!((TAU * sum - theta.cos().max(0.0)).abs() > 2e-4 || sum < 1e-4);
        }
    }
}
