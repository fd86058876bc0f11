//! The BRDFs of `etendue_field::Brdf`, implemented independently for theory.

use crate::shading::unpolarised_reflectance;
use etendue_field::{AngleTable, Brdf, Fresnel, Lobe, Mixture};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Returns the weighted sum of BRDFs in sr⁻¹, for light that arrives from `from` and leaves
/// towards `to`; both are unit vectors away from the surface, and `normal` is the surface's unit
/// normal.
#[must_use]
pub fn sum(mixture: &Mixture<'_>, normal: DVec3, from: DVec3, to: DVec3) -> f64 {
    let each = mixture.weighted();
    each.map(|(weight, brdf)| weight * value(brdf, normal, from, to))
        .sum()
}

/// The value of a single BRDF, for the same directions and normal as in [`sum`].
#[must_use]
pub fn value(brdf: &Brdf, normal: DVec3, from: DVec3, to: DVec3) -> f64 {
    factors(brdf, normal.dot(from), normal.dot(to)) * lobe(brdf, normal, from, to)
}

/// Returns f(θi) h(θo), from the cosines of both angles.
pub(super) fn factors(brdf: &Brdf, cos_from: f64, cos_to: f64) -> f64 {
    let factor = |table: &Option<AngleTable>, cos: f64| {
        table.as_ref().map_or(1.0, |table| between(table, cos))
    };
    factor(&brdf.incoming, cos_from) * factor(&brdf.outgoing, cos_to)
}

/// Interpolates a table linearly at the angle with the given cosine. The interpolation is a sum of
/// hat functions about the table's nodes.
fn between(table: &AngleTable, cos: f64) -> f64 {
    let steps = (table.values.len() - 1) as f64;
    let at = libm::acos(cos.clamp(0.0, 1.0)) * steps / FRAC_PI_2;
    let nodes = table.values.iter().zip(0_u32..);
    nodes
        .map(|(value, node)| value * (1.0 - (at - f64::from(node)).abs()).max(0.0))
        .sum()
}

/// A BRDF without its factors f and h.
pub(super) fn lobe(brdf: &Brdf, normal: DVec3, from: DVec3, to: DVec3) -> f64 {
    let (cos_from, cos_to) = (normal.dot(from), normal.dot(to));
    if cos_from <= 0.0 || cos_to <= 0.0 {
        return 0.0;
    }
    let lobe = match brdf.lobe {
        Lobe::Lambertian => reflectance(brdf.fresnel, cos_from) / PI,
        Lobe::Phong { exponent } => {
            // The cosine between `to` and the mirror direction of `from`.
            let cos = 2.0 * cos_from * cos_to - from.dot(to);
            let lobe = (exponent + 1.0) / TAU * libm::pow(cos.max(0.0), exponent);
            lobe * reflectance(brdf.fresnel, cos_from)
        }
        Lobe::Beckmann { roughness } => {
            let [slope_squared, cos_half] = half_way(normal, from, to);
            let width = roughness * roughness;
            let normals = libm::exp(-slope_squared / width) / (PI * width);
            let shadow = |cos: f64| beckmann_shadow(cos, roughness);
            microfacets(
                brdf,
                normals,
                slope_squared,
                cos_half,
                shadow,
                cos_from,
                cos_to,
            )
        }
        Lobe::Ggx { roughness } => {
            let [slope_squared, cos_half] = half_way(normal, from, to);
            let width = roughness * roughness;
            let normals = 1.0 / (PI * width * (1.0 + slope_squared / width).powi(2));
            let shadow = |cos: f64| {
                let slope_squared = (1.0 - cos * cos).max(0.0) / (cos * cos);
                2.0 / (1.0 + (1.0 + width * slope_squared).sqrt())
            };
            microfacets(
                brdf,
                normals,
                slope_squared,
                cos_half,
                shadow,
                cos_from,
                cos_to,
            )
        }
    };
    brdf.albedo * lobe
}

/// The smallest [`angular_width`] of several BRDFs, or `None` if none of them has a width.
pub(crate) fn narrowest<'a>(brdfs: impl Iterator<Item = &'a Brdf>) -> Option<f64> {
    brdfs.filter_map(angular_width).min_by(f64::total_cmp)
}

/// The angle from the mirror direction, in radians, within which most of a lobe lies, or
/// `None` if the lobe covers all directions.
fn angular_width(brdf: &Brdf) -> Option<f64> {
    match brdf.lobe {
        Lobe::Lambertian => None,
        Lobe::Phong { exponent } => Some((2.0 / (exponent + 1.0)).sqrt()),
        Lobe::Beckmann { roughness } | Lobe::Ggx { roughness } => Some(2.0 * roughness),
    }
}

/// Returns tan² of the tilt of the microfacets that reflect `from` into `to`, and the cosine of
/// the angle of incidence on these microfacets.
fn half_way(normal: DVec3, from: DVec3, to: DVec3) -> [f64; 2] {
    let half = (from + to).normalize();
    let cos = half.dot(normal);
    [(1.0 - cos * cos).max(0.0) / (cos * cos), half.dot(from)]
}

/// The microfacet BRDF D G F / (4 cos θi cos θo), where D follows from the density of
/// slopes P(tan² tilt) = D cos⁴.
fn microfacets(
    brdf: &Brdf,
    slopes: f64,
    slope_squared: f64,
    cos_half: f64,
    shadow: impl Fn(f64) -> f64,
    cos_from: f64,
    cos_to: f64,
) -> f64 {
    let normals = slopes * (1.0 + slope_squared).powi(2);
    normals * shadow(cos_from) * shadow(cos_to) * reflectance(brdf.fresnel, cos_half)
        / (4.0 * cos_from * cos_to)
}

/// Smith's shadowing of Beckmann slopes, 2/(1 + erf a + e^(−a²)/(a√π)) with a = 1/(α tan θ)
/// (Walter et al. 2007, Eq. 26).
fn beckmann_shadow(cos: f64, roughness: f64) -> f64 {
    let sine = (1.0 - cos * cos).max(0.0).sqrt();
    if sine <= 0.0 {
        return 1.0;
    }
    let a = cos / (roughness * sine);
    2.0 / (1.0 + libm::erf(a) + libm::exp(-a * a) / (a * PI.sqrt()))
}

/// The fraction of unpolarised light that is reflected at the angle of incidence with the
/// given cosine.
pub(super) fn reflectance(fresnel: Fresnel, cos: f64) -> f64 {
    unpolarised_reflectance(fresnel, cos, 1.0 - cos * cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fresnel_is_known() {
        let glass = Fresnel::Dielectric { index: 1.5 };
        let aluminium = Fresnel::Conductor { n: 0.96, k: 6.69 };
        for (angle, a, b) in [
            (0.0_f64, 0.04, 0.920_983_914_876_63),
            (0.7, 0.045_807_898_596_632_76, 0.918_696_850_446_167_8),
            (1.4, 0.395_131_394_819_772_3, 0.867_438_841_447_289_3),
        ] {
            let cos = libm::cos(angle);
            assert!((reflectance(glass, cos) - a).abs() < 1e-14); // rounding
            assert!((reflectance(aluminium, cos) - b).abs() < 1e-14); // rounding
        }
        // From the denser side all light is reflected beyond the critical angle.
        let inside = reflectance(Fresnel::Dielectric { index: 1.0 / 1.5 }, 0.3);
        assert!((inside - 1.0).abs() < 1e-14); // rounding
    }

    /// Tests ∫ D cos dω = 1 by the albedo of each lobe at normal incidence, where f = D G₁/(4 cos).
    /// This is the weak white furnace test for lobes with almost no shadowing.
    #[test]
    fn lobes_hold_what_they_say() {
        let normal = DVec3::Z;
        let total = |lobe: Lobe, cosine: bool| {
            let brdf = Brdf::new(lobe, 1.0, Fresnel::White);
            crate::quadrature::integrate(400, [0.0, PI / 2.0], |theta| {
                let (sin, cos) = libm::sincos(theta);
                let to = DVec3::new(sin, 0.0, cos);
                let factor = if cosine { cos } else { 1.0 };
                TAU * sin * factor * value(&brdf, normal, normal, to)
            })
        };
        let phong = total(Lobe::Phong { exponent: 40.0 }, false);
        assert!((phong - 1.0).abs() < 1e-12); // quadrature of a polynomial in cos θ
        assert!((total(Lobe::Lambertian, true) - 1.0).abs() < 1e-12); // the same quadrature
        for lobe in [
            Lobe::Beckmann { roughness: 0.1 },
            Lobe::Ggx { roughness: 0.02 },
        ] {
            let albedo = total(lobe, true);
            // At normal incidence, smooth microfacets shadow almost no light.
            assert!((0.99..=1.0 + 1e-9).contains(&albedo), "{lobe:?} {albedo}");
        }
    }
}
