//! BRDFs at one place: their value, and beside it a way to sample a direction with its density.
//!
//! Directions are unit vectors away from the surface, in a frame with the normal along Z: light comes from wi and goes to wo.
//! [`Brdf`] says what each lobe is.

mod fresnel;
mod lambertian;
mod microfacet;
mod mixture;
mod phong;

#[cfg(test)]
mod tests;

use etendue_field::{AngleTable, Brdf, Lobe};
pub use fresnel::reflected_share;
use glam::DVec3;
use microfacet::{Distribution, Microfacets};
pub use mixture::sum;
pub(crate) use mixture::{densities, towards};

/// The BRDF, sr⁻¹.
#[inline]
#[must_use]
pub fn value(brdf: &Brdf, wi: DVec3, wo: DVec3) -> f64 {
    if wi.z <= 0.0 || wo.z <= 0.0 {
        return 0.0;
    }
    let (lobe, cosine) = match brdf.lobe {
        Lobe::Lambertian => (lambertian::value(), wi.z),
        Lobe::Phong { exponent } => (phong::value(exponent, wi, wo), wi.z),
        Lobe::Beckmann { .. } | Lobe::Ggx { .. } => {
            let half = (wi + wo).normalize();
            let cosine = half.dot(wi).min(1.0);
            (microfacets(brdf).map_or(0.0, |m| m.value(wi, wo)), cosine)
        }
    };
    brdf.albedo
        * lobe
        * reflected_share(&brdf.fresnel, cosine)
        * factor(brdf.incoming.as_ref(), wi)
        * factor(brdf.outgoing.as_ref(), wo)
}

/// What a table says of a direction; 1 where there is none.
#[inline]
fn factor(table: Option<&AngleTable>, direction: DVec3) -> f64 {
    table.map_or(1.0, |table| table.value(direction.z))
}

/// A direction wo for wi in front of the surface, from two numbers in (0, 1). It may lie below the surface: then it carries nothing.
///
/// Backward rays draw wi for wo by the same lobes, which are symmetric. Albedo and factors of angles are left to the weight.
#[inline]
pub(crate) fn sample(brdf: &Brdf, wi: DVec3, random: [f64; 2]) -> DVec3 {
    match brdf.lobe {
        Lobe::Lambertian => lambertian::sample(random),
        Lobe::Phong { exponent } => phong::sample(exponent, wi, random),
        Lobe::Beckmann { .. } | Lobe::Ggx { .. } => {
            microfacets(brdf).map_or(DVec3::Z, |m| m.sample(wi, random))
        }
    }
}

/// The density of [`sample`] per solid angle, over the whole sphere: what falls below the surface is a part of it.
#[inline]
pub(crate) fn density(brdf: &Brdf, wi: DVec3, wo: DVec3) -> f64 {
    match brdf.lobe {
        Lobe::Lambertian => lambertian::density(wo),
        Lobe::Phong { exponent } => phong::density(exponent, wi, wo),
        Lobe::Beckmann { .. } | Lobe::Ggx { .. } => {
            microfacets(brdf).map_or(0.0, |m| m.density(wi, wo))
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
