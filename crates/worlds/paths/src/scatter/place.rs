//! Converts materials at a surface point to BSDFs of `etendue_scatter`, names their kinds of
//! reflection, and flips directions to the front.

use etendue_field::{Fresnel, Lobe, MicrofacetDistribution};
use etendue_scatter::{
    Bsdf, Coat, Conductor, DiffuseTransmission, MetallicRoughness, Microfacets, ModifiedPhong,
    Phong, Plastic, Principled, RoughDielectric, SmoothDielectric,
};
use etendue_world::{self as world, Roughness, Texture, TexturePoint};
use glam::DVec3;

/// A diffuse base below a dielectric coat.
#[derive(Clone, Debug)]
pub(crate) struct Coated {
    pub(super) coat: Coat,
    diffuse: Texture,
    pub(super) specular: Texture,
    is_nonlinear: bool,
}

impl Coated {
    pub(super) fn new(plastic: &world::Plastic) -> Self {
        // The table of the coat needs only one roughness, because the roughness is constant.
        let facets = facets(plastic.roughness.as_ref(), &TexturePoint::default());
        Self {
            coat: Coat::new(plastic.index, facets),
            diffuse: plastic.diffuse.clone(),
            specular: plastic.specular.clone(),
            is_nonlinear: plastic.is_nonlinear,
        }
    }

    /// The plastic at a point.
    pub(super) fn at(&self, point: &TexturePoint) -> Plastic<'_> {
        Plastic {
            coat: &self.coat,
            diffuse: self.diffuse.value(point),
            specular: self.specular.value(point),
            is_nonlinear: self.is_nonlinear,
        }
    }

    /// The share of the base in scattered light. The share is 0 in the mirror direction of
    /// a smooth coat, whose reflection is a delta component.
    pub(super) fn base_share(&self, point: &TexturePoint, wi: DVec3, wo: DVec3) -> f64 {
        if self.coat.facets().is_none() && is_mirrored(wi, wo) {
            return 0.0;
        }
        let plastic = self.at(point);
        share(plastic.base_value(wi, wo), plastic.value(wi, wo))
    }
}

/// The kind of reflection of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflects {
    /// The surface is black on this side.
    Nothing,
    /// Diffuse.
    Diffuse,
    /// A mirror.
    Mirror,
    /// A lobe around the mirror direction, possibly above a diffuse base.
    Lobe(Lobe),
}

/// The microfacet distribution at a point, or `None` for a smooth surface.
pub(super) fn facets(roughness: Option<&Roughness>, point: &TexturePoint) -> Option<Microfacets> {
    roughness.map(|of| Microfacets {
        distribution: of.distribution,
        // Directions in f64 do not resolve a roughness below this minimum.
        alpha: [0, 1].map(|axis: usize| of.alpha[axis].value(point).max(1e-4)),
    })
}

/// A rough metal at a point, or `None` for a mirror.
pub(super) fn conductor(of: &world::Conductor, point: &TexturePoint) -> Option<Conductor> {
    facets(of.roughness.as_ref(), point).map(|facets| Conductor {
        facets,
        fresnel: fresnel(of),
    })
}

/// The Fresnel reflectance of a metal.
pub(super) fn fresnel(of: &world::Conductor) -> Fresnel {
    of.index
        .map_or(Fresnel::White, |[n, k]| Fresnel::Conductor { n, k })
}

/// The modified Phong BRDF at a point.
pub(super) fn phong(
    [diffuse, specular, exponent]: &[Texture; 3],
    point: &TexturePoint,
) -> ModifiedPhong {
    ModifiedPhong {
        diffuse: diffuse.value(point),
        specular: specular.value(point),
        lobe: Phong {
            exponent: exponent.value(point),
        },
    }
}

/// The index on the far side of an interface divided by the index on the side of `wo`. A
/// thin sheet has the same medium on both sides.
fn index(of: &world::Dielectric, wo: DVec3) -> f64 {
    if of.is_thin || wo.z > 0.0 {
        of.index
    } else {
        1.0 / of.index
    }
}

/// A rough interface as seen from the side of `wo`, or `None` if the interface is smooth.
pub(super) fn rough_dielectric(
    of: &world::Dielectric,
    point: &TexturePoint,
    wo: DVec3,
) -> Option<RoughDielectric> {
    let facets = facets(of.roughness.as_ref().filter(|_| !of.is_thin), point)?;
    let index = index(of, wo);
    Some(RoughDielectric { facets, index })
}

/// A smooth interface as seen from the side of `wo`.
pub(super) fn smooth_dielectric(of: &world::Dielectric, wo: DVec3) -> SmoothDielectric {
    SmoothDielectric {
        index: index(of, wo),
        is_thin: of.is_thin,
    }
}

/// The factor that multiplies light. The light is reflected if wi is in front, as wo is;
/// otherwise it is transmitted.
pub(super) fn factor(of: &world::Dielectric, point: &TexturePoint, wi: DVec3) -> f64 {
    if wi.z > 0.0 {
        of.reflectance.value(point)
    } else {
        of.transmittance.value(point)
    }
}

/// A metal and a base at a point.
pub(super) fn principled(of: &world::Principled, point: &TexturePoint) -> Principled {
    let roughness = of.roughness.value(point);
    let squared = roughness * roughness;
    let aspect = (1.0 - 0.9 * of.anisotropic.value(point)).sqrt();
    Principled {
        facets: Microfacets {
            distribution: MicrofacetDistribution::Ggx,
            // Mitsuba uses the same minimum of α.
            alpha: [squared / aspect, squared * aspect].map(|alpha| alpha.max(1e-3)),
        },
        index: of.index,
        color: of.color.value(point),
        metallic: of.metallic.value(point),
        transmission: of.transmission.value(point),
        roughness,
        tint: of.tint.value(point),
        flatness: of.flatness.value(point),
        sheen: of.sheen.value(point),
        clearcoat: of.clearcoat.value(point),
        coat_alpha: 0.1 - 0.099 * of.gloss.value(point),
    }
}

/// Returns diffuse reflection and transmission at a point.
pub(super) fn diffuse_transmission(
    [reflectance, transmittance]: &[Texture; 2],
    point: &TexturePoint,
) -> DiffuseTransmission {
    DiffuseTransmission {
        reflectance: reflectance.value(point),
        transmittance: transmittance.value(point),
    }
}

/// Returns glTF's mixture of a metal and a coated base at a point.
pub(super) fn metallic_roughness(
    of: &world::MetallicRoughness,
    point: &TexturePoint,
) -> MetallicRoughness {
    MetallicRoughness {
        facets: facets(of.roughness.as_ref(), point),
        color: of.color.value(point),
        metallic: of.metallic.value(point),
        coat: of.coat,
    }
}

/// Checks whether directions are mirror directions of each other.
pub(super) fn is_mirrored(wi: DVec3, wo: DVec3) -> bool {
    (wi + wo).truncate().length_squared() < 1e-24
}

/// The ratio of a part to the whole value, or 0 if the value is 0.
pub(super) fn share(part: f64, value: f64) -> f64 {
    if value > 0.0 { part / value } else { 0.0 }
}

/// The flip after which `wo` is in front.
#[inline]
pub(super) fn to_front(wo: DVec3) -> impl Fn(DVec3) -> DVec3 + Copy {
    let side = if wo.z > 0.0 { 1.0 } else { -1.0 };
    move |v| v.with_z(side * v.z)
}
