//! Computes BRDFs from their definitions: Fresnel's equations with complex indices, microfacets
//! that are described by their slopes, and Smith's masking as an integral.

use super::check::if_planted;
use super::vector::{Vector, angle, dot, plus, turned, unit};
use etendue_field::{AngleTable, Brdf, Complex, Fresnel, Lobe};
use std::f64::consts::PI;

const NORMAL: Vector = [0.0, 0.0, 1.0];

/// The BRDF between two unit vectors away from a surface whose normal is along Z, sr⁻¹
/// (docs of `etendue_field::Brdf`).
pub(super) fn value(brdf: &Brdf, from: Vector, to: Vector, fault: &str) -> f64 {
    if from[2] <= 0.0 || to[2] <= 0.0 {
        return 0.0;
    }
    let incidence = angle(NORMAL, from);
    let [f, h] = match fault {
        "h for f" => [&brdf.outgoing, &brdf.incoming],
        "h left out" => [&brdf.incoming, &None],
        _ => [&brdf.incoming, &brdf.outgoing],
    };
    let factor = |table: &Option<AngleTable>, at: f64| {
        table
            .as_ref()
            .map_or(1.0, |table| by_angle(&table.values, at, fault))
    };
    let factors = factor(f, incidence) * factor(h, angle(NORMAL, to));
    factors * lobe(brdf, incidence, [from, to], fault)
}

/// The value at an angle, by linear interpolation in a list of values over 0 to 90°.
fn by_angle(values: &[f64], angle: f64, fault: &str) -> f64 {
    let step = 90.0 / (values.len() - 1) as f64;
    let degrees = match fault {
        "angle measured from the surface" => 90.0 - angle.to_degrees(),
        "interpolated over the cosine" => 90.0 * (1.0 - angle.cos()),
        _ => angle.to_degrees(),
    };
    let pairs = values.windows(2).enumerate();
    let spans = pairs.map(|(i, pair)| (i as f64 * step, pair));
    let held = spans.rev().find(|(start, _)| *start <= degrees);
    held.map_or(f64::NAN, |(start, pair)| {
        pair[0] + (degrees - start) / step * (pair[1] - pair[0])
    })
}

/// The value of a BRDF without the angular factors that the BRDF's lists tabulate.
fn lobe(brdf: &Brdf, incidence: f64, [from, to]: [Vector; 2], fault: &str) -> f64 {
    let reflected = |angle: f64| brdf.albedo * reflected(&brdf.fresnel, angle, fault);
    match brdf.lobe {
        Lobe::Lambertian => reflected(incidence) / PI,
        Lobe::Phong { exponent } => reflected(incidence) * phong(exponent, from, to, fault),
        Lobe::Beckmann { roughness } => {
            let facet = facet(from, to, fault);
            let density = beckmann(roughness, facet, fault);
            let mask = |to: Vector| 1.0 / (1.0 + masked_beckmann(roughness, angle(NORMAL, to)));
            facets(density, mask, [from, to], fault) * reflected(angle(facet, from))
        }
        Lobe::Ggx { roughness } => {
            let facet = facet(from, to, fault);
            let density = ggx(roughness, facet, fault);
            let mask = |to: Vector| match fault {
                "Beckmann's masking" => 1.0 / (1.0 + masked_beckmann(roughness, angle(NORMAL, to))),
                _ => 1.0 / (1.0 + masked_ggx(roughness, angle(NORMAL, to))),
            };
            facets(density, mask, [from, to], fault) * reflected(angle(facet, from))
        }
    }
}

/// The Phong lobe (n + 1)/2π cosⁿ of the angle to the mirror direction, of unit integral
/// (Phong 1975).
fn phong(exponent: f64, from: Vector, to: Vector, fault: &str) -> f64 {
    let mirror = turned(from, NORMAL, PI);
    let cosine = match fault {
        "about the half-way vector" => angle(NORMAL, unit(plus(from, 1.0, to))).cos(),
        _ => angle(mirror, to).cos(),
    };
    if cosine <= 0.0 {
        return 0.0;
    }
    let unit = if_planted(fault, "factor (n + 2)/2π", exponent + 2.0, exponent + 1.0);
    unit / (2.0 * PI) * (exponent * cosine.ln()).exp()
}

/// The microfacet normal that reflects one direction into the other.
fn facet(from: Vector, to: Vector, fault: &str) -> Vector {
    let share = if_planted(fault, "facet closer to one direction", 1.1, 1.0);
    unit(plus(from, share, to))
}

/// The microfacet BRDF D G F / (4 cos θi cos θo) without its Fresnel factor F (Cook and
/// Torrance 1982; Walter et al. 2007, Eq. 20).
fn facets(density: f64, mask: impl Fn(Vector) -> f64, [from, to]: [Vector; 2], fault: &str) -> f64 {
    let masks = mask(from) * if_planted(fault, "masking in one direction only", 1.0, mask(to));
    density * masks / (4.0 * from[2] * to[2])
}

/// Beckmann's density of normals. Each slope of the microfacets is normally distributed
/// with variance α²/2. The density of normals per solid angle is the density of slopes times 1/cos⁴
/// and a constant (Beckmann and Spizzichino 1963).
fn beckmann(roughness: f64, facet: Vector, fault: &str) -> f64 {
    let axes = if_planted(fault, "α² is the variance along an axis", 2.0, 1.0);
    let squared = axes * roughness * roughness;
    let slopes = [facet[0] / facet[2], facet[1] / facet[2]];
    let steep = slopes[0] * slopes[0] + slopes[1] * slopes[1];
    (-steep / squared).exp() / (PI * squared) / facet[2].powi(4)
}

/// The distribution of normals of an ellipsoid with half-axes 1, 1 and α (Trowbridge and
/// Reitz 1975).
fn ggx(roughness: f64, facet: Vector, fault: &str) -> f64 {
    let squared = roughness * roughness;
    let [x, y, z] = facet;
    let stretched = (x * x + y * y) / squared + z * z;
    let power = if_planted(fault, "D to the power 3/2", 1.5, 2.0);
    1.0 / (PI * squared * stretched.powf(power))
}

/// Smith's Λ (Smith 1967; Heitz 2014, *Understanding the masking-shadowing function*): ∫ (s
/// − μ) p(s) ds / μ over s > μ. Here s is the slope of a microfacet along a direction, and μ is the
/// cotangent of the angle between this direction and the normal. For Beckmann's distribution, p =
/// exp(−s²/α²)/(α√π), and the integral is over w = s/α.
fn masked_beckmann(roughness: f64, angle: f64) -> f64 {
    let from = 1.0 / (angle.tan() * roughness);
    if from > 6.0 {
        return 0.0; // ∫ is below 10⁻¹⁷
    }
    let exceeds = |w: f64| (w - from) * (-w * w).exp() / PI.sqrt();
    integral([from, from + 7.0], 600, exceeds) / from
}

/// Smith's Λ for GGX, with p = α²/(2 (α² + s²)^(3/2)). The integral is over ψ, where s = α
/// tan ψ.
fn masked_ggx(roughness: f64, angle: f64) -> f64 {
    let cotangent = 1.0 / angle.tan();
    let from = (cotangent / roughness).atan();
    let exceeds = |psi: f64| 0.5 * (roughness * psi.sin() - cotangent * psi.cos());
    integral([from, PI / 2.0], 150, exceeds) / cotangent
}

/// An integral by Simpson's rule, with this many pairs of steps.
fn integral([from, to]: [f64; 2], pairs: u32, value: impl Fn(f64) -> f64) -> f64 {
    let step = (to - from) / f64::from(2 * pairs);
    let at = |i: u32| value(from + step * f64::from(i));
    let inner = (1..2 * pairs).map(|i| at(i) * if i % 2 == 1 { 4.0 } else { 2.0 });
    step / 3.0 * (at(0) + inner.sum::<f64>() + at(2 * pairs))
}

/// The reflectance of unpolarised light: the mean of |r|² for polarisation across (s) and
/// along (p) the plane of incidence (Fresnel 1823; Born and Wolf 1999, 1.5.2 and 14.2). The angle
/// of refraction follows Snell's law, and is complex if the index is complex. The planted fault
/// affects only one polarisation, because swapping both polarisations would not change their
/// mean.
fn reflected(fresnel: &Fresnel, angle: f64, fault: &str) -> f64 {
    let index = match *fresnel {
        Fresnel::White => return 1.0,
        Fresnel::Dielectric { index } => Complex::new(index, 0.0),
        Fresnel::Conductor { n, .. } if fault == "k left out" => Complex::new(n, 0.0),
        Fresnel::Conductor { n, k } => Complex::new(n, k),
    };
    let index = if_planted(fault, "media swapped", 1.0 / index, index);
    let outside = angle.cos();
    let sine = angle.sin() / index;
    let inside = (1.0 - sine * sine).sqrt();
    let s = (outside - index * inside) / (outside + index * inside);
    let p = (index * outside - inside) / (index * outside + inside);
    match fault {
        "s alone" => s.norm_sqr(),
        "p alone" => p.norm_sqr(),
        _ => 0.5 * (s.norm_sqr() + p.norm_sqr()),
    }
}

/// The direction into which a microfacet reflects another direction.
pub(super) fn mirrored(from: Vector, facet: Vector) -> Vector {
    plus(from.map(|c| -c), 2.0 * dot(from, facet), facet)
}
