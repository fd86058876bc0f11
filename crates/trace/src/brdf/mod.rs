//! BRDFs as scenes have them, by the lobes of `etendue_scatter`: light comes from wi and goes to wo.
//!
//! Directions are unit vectors away from the surface, in a frame with the normal along Z. [`Brdf`] says what each lobe is.

mod mixture;

use etendue_field::{AngleTable, Brdf, Lobe, MicrofacetDistribution};
use etendue_scatter::{Microfacets, Phong, lambertian, reflectance};
use glam::DVec3;
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
        Lobe::Lambertian => (lambertian::VALUE, wi.z),
        Lobe::Phong { exponent } => (Phong { exponent }.value(wo, wi), wi.z),
        Lobe::Beckmann { roughness } => beckmann(roughness).value(wo, wi),
        Lobe::Ggx { roughness } => ggx(roughness).value(wo, wi),
    };
    brdf.albedo
        * lobe
        * reflectance(&brdf.fresnel, cosine)
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
        Lobe::Phong { exponent } => Phong { exponent }.sample(wi, random),
        Lobe::Beckmann { roughness } => beckmann(roughness).sample_unmasked(wi, random),
        Lobe::Ggx { roughness } => ggx(roughness).sample(wi, random),
    }
}

/// The density of [`sample`] per solid angle, over the whole sphere: what falls below the surface is a part of it.
#[inline]
pub(crate) fn density(brdf: &Brdf, wi: DVec3, wo: DVec3) -> f64 {
    match brdf.lobe {
        Lobe::Lambertian => lambertian::density(wo),
        Lobe::Phong { exponent } => Phong { exponent }.value(wo, wi),
        Lobe::Beckmann { roughness } => beckmann(roughness).unmasked_density(wo, wi),
        Lobe::Ggx { roughness } => ggx(roughness).density(wo, wi),
    }
}

#[inline]
fn beckmann(roughness: f64) -> Microfacets {
    Microfacets::isotropic(MicrofacetDistribution::Beckmann, roughness)
}

#[inline]
fn ggx(roughness: f64) -> Microfacets {
    Microfacets::isotropic(MicrofacetDistribution::Ggx, roughness)
}
