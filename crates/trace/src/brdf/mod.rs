//! BRDFs at one place: their value, and beside it a way to sample a direction with its density.
//!
//! Directions are unit vectors away from the surface, in a frame with the normal along Z. [`Brdf`] says what each lobe is.

mod fresnel;
mod lambertian;
mod microfacet;
mod phong;

#[cfg(test)]
mod tests;

use etendue_field::{Brdf, Lobe};
use fresnel::reflected_share;
use glam::DVec3;
use microfacet::{Distribution, Microfacets};

/// The BRDF for light that comes from one direction and goes to another, sr⁻¹.
#[inline]
#[must_use]
pub fn value(brdf: &Brdf, from: DVec3, to: DVec3) -> f64 {
    if from.z <= 0.0 || to.z <= 0.0 {
        return 0.0;
    }
    let (lobe, cosine) = match brdf.lobe {
        Lobe::Lambertian => (lambertian::value(), from.z),
        Lobe::Phong { exponent } => (phong::value(exponent, from, to), from.z),
        Lobe::Beckmann { .. } | Lobe::Ggx { .. } => {
            let half = (from + to).normalize();
            let cosine = half.dot(from).min(1.0);
            (microfacets(brdf).map_or(0.0, |m| m.value(from, to)), cosine)
        }
    };
    brdf.albedo * lobe * reflected_share(&brdf.fresnel, cosine)
}

/// A direction, drawn for another one in front of the surface, from two numbers in (0, 1). It may lie below the surface: then it carries nothing.
///
/// Lobes are drawn alike from light to eye and from eye to light; Fresnel factor and albedo are left to the weight.
#[inline]
pub(crate) fn sample(brdf: &Brdf, given: DVec3, random: [f64; 2]) -> DVec3 {
    match brdf.lobe {
        Lobe::Lambertian => lambertian::sample(random),
        Lobe::Phong { exponent } => phong::sample(exponent, given, random),
        Lobe::Beckmann { .. } | Lobe::Ggx { .. } => {
            microfacets(brdf).map_or(DVec3::Z, |m| m.sample(given, random))
        }
    }
}

/// The density of [`sample`] per solid angle, over the whole sphere: what falls below the surface is a part of it.
#[inline]
pub(crate) fn density(brdf: &Brdf, given: DVec3, drawn: DVec3) -> f64 {
    match brdf.lobe {
        Lobe::Lambertian => lambertian::density(drawn),
        Lobe::Phong { exponent } => phong::density(exponent, given, drawn),
        Lobe::Beckmann { .. } | Lobe::Ggx { .. } => {
            microfacets(brdf).map_or(0.0, |m| m.density(given, drawn))
        }
    }
}

fn microfacets(brdf: &Brdf) -> Option<Microfacets> {
    let (distribution, roughness) = match brdf.lobe {
        Lobe::Beckmann { roughness } => (Distribution::Beckmann, roughness),
        Lobe::Ggx { roughness } => (Distribution::Ggx, roughness),
        Lobe::Lambertian | Lobe::Phong { .. } => return None,
    };
    Some(Microfacets {
        distribution,
        roughness,
    })
}
