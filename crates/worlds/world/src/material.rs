//! Materials of surfaces.

use crate::Texture;
use etendue_field::MicrofacetDistribution;

/// The material of a surface.
///
/// The front is the side to which the normal of the [`Shape`](crate::Shape) points. A material that
/// scatters light only on its front is opaque, and its back is black.
#[derive(Clone, Debug)]
pub enum Material {
    /// Lambert's BRDF on the front, reflectance / π.
    Diffuse {
        /// The fraction of light that is reflected.
        reflectance: Texture,
    },
    /// Lambert's BRDF on both sides, with a part of the light transmitted diffusely.
    DiffuseTransmission {
        /// The fraction of light that is reflected.
        reflectance: Texture,
        /// The fraction of light that is transmitted.
        transmittance: Texture,
    },
    /// A metal on the front.
    Conductor(Conductor),
    /// An interface between two media, which reflects and transmits light on both sides.
    Dielectric(Dielectric),
    /// A diffuse base below a dielectric coat, on the front.
    Plastic(Plastic),
    /// A mixture of a metal and a coated diffuse base, on the front.
    MetallicRoughness(Box<MetallicRoughness>),
    /// A mixture of a metal and a diffuse base below a dielectric interface, on the front, and of
    /// an interface that transmits light, on both sides.
    Principled(Box<Principled>),
    /// The modified Phong BRDF on the front: kd / π + ks (n + 2)/(2π) cosⁿ α, where α is the angle
    /// to the mirror direction (Lafortune and Willems 1994).
    Phong {
        /// kd.
        diffuse: Texture,
        /// ks.
        specular: Texture,
        /// n.
        exponent: Texture,
    },
    /// Two opaque materials, one on each side of the surface; each material scatters as on its own
    /// front.
    TwoSided(Box<[Self; 2]>),
    /// A partly transparent surface. A fraction of the light hits the material. The rest passes
    /// unchanged, as if there were no surface: the depth of a world does not count it.
    Mask {
        /// The fraction of the light that hits the material.
        opacity: Texture,
        /// The material.
        of: Box<Self>,
    },
    /// A mixture of two materials with weights 1 − w and w.
    Blend {
        /// w.
        weight: Texture,
        /// Both materials.
        of: Box<[Self; 2]>,
    },
}

impl Material {
    /// Creates Lambert's BRDF with a constant reflectance.
    #[must_use]
    pub fn diffuse(reflectance: f64) -> Self {
        Self::Diffuse {
            reflectance: Texture::Constant(reflectance),
        }
    }

    /// The material that has this opaque material on both sides.
    #[must_use]
    pub fn on_both_sides(self) -> Self {
        Self::TwoSided(Box::new([self.clone(), self]))
    }

    /// Checks whether a part of the material is a mirror or smooth glass.
    #[must_use]
    pub fn has_smooth_part(&self) -> bool {
        match self {
            Self::Conductor(of) => of.roughness.is_none(),
            Self::Dielectric(of) => of.is_thin || of.roughness.is_none(),
            Self::TwoSided(of) | Self::Blend { of, .. } => of.iter().any(Self::has_smooth_part),
            Self::Mask { of, .. } => of.has_smooth_part(),
            _ => false,
        }
    }
}

/// A metal: a mirror, or mirror-like microfacets (Walter et al. 2007).
#[derive(Clone, Debug)]
pub struct Conductor {
    /// Index of refraction n + i k, relative to the medium outside; `None` is a perfect reflector.
    pub index: Option<[f64; 2]>,
    /// A factor on the reflected light.
    pub reflectance: Texture,
    /// The roughness; `None` for a mirror.
    pub roughness: Option<Roughness>,
}

/// An interface that reflects and refracts light.
#[derive(Clone, Debug)]
pub struct Dielectric {
    /// The index of refraction behind the surface, divided by the index in front of it.
    pub index: f64,
    /// A factor on the reflected light.
    pub reflectance: Texture,
    /// A factor on the transmitted light.
    pub transmittance: Texture,
    /// The roughness; `None` for a smooth interface.
    pub roughness: Option<Roughness>,
    /// Whether the surface is a thin sheet with such an interface on either side. Light passes the
    /// sheet in a straight line, and all internal reflections are summed.
    pub is_thin: bool,
}

/// A diffuse base below a dielectric coat. Light scattered by the base is refracted on its way in
/// and out, and reflected internally.
#[derive(Clone, Debug)]
pub struct Plastic {
    /// The index of refraction of the coat, divided by the index outside.
    pub index: f64,
    /// Reflectance of the base.
    pub diffuse: Texture,
    /// A factor on the light reflected by the coat.
    pub specular: Texture,
    /// Whether each internal reflection is multiplied by the colour of the base.
    pub is_nonlinear: bool,
    /// Roughness of the coat, which does not affect the base; `None` for a smooth coat.
    pub roughness: Option<Roughness>,
}

/// A mixture of a metal and a diffuse base below a coat, with Schlick's reflectances (glTF 2.0,
/// Appendix B). At grazing angles it may reflect more light than it receives.
#[derive(Clone, Debug)]
pub struct MetallicRoughness {
    /// Albedo of the base, and reflectance of the metal at normal incidence.
    pub color: Texture,
    /// The share of the metal, 0 to 1.
    pub metallic: Texture,
    /// Roughness of the metal and of the coat; `None` if both are smooth.
    pub roughness: Option<Roughness>,
    /// Reflectance of the coat at normal and at grazing incidence.
    pub coat: [f64; 2],
}

/// A mixture of a metal, a diffuse base below a dielectric interface, and such an interface that
/// transmits light (Burley 2012, *Physically Based Shading at Disney*). GGX microfacets have
/// α = roughness² / q along u and roughness² q along v, with q = √(1 − 0.9 anisotropic).
#[derive(Clone, Debug)]
pub struct Principled {
    /// Albedo of the base, and reflectance of the metal at normal incidence.
    pub color: Texture,
    /// The share of the metal, 0 to 1.
    pub metallic: Texture,
    /// The share of transmission in the rest, 0 to 1.
    pub transmission: Texture,
    /// The roughness, 0 to 1.
    pub roughness: Texture,
    /// The anisotropy, 0 to 1.
    pub anisotropic: Texture,
    /// The share of Schlick's approximation in the reflectance of the interface, 0 to 1.
    pub tint: Texture,
    /// The share of flat subsurface scattering in the base, 0 to 1.
    pub flatness: Texture,
    /// The strength of the reflection at grazing angles, 0 to 1.
    pub sheen: Texture,
    /// The strength of the clear coat, 0 to 1.
    pub clearcoat: Texture,
    /// The gloss of the clear coat, 0 to 1. The α of the coat decreases from 0.1 to 0.001.
    pub gloss: Texture,
    /// Index of refraction of the interface relative to the outside, at least 1.
    pub index: f64,
}

/// The distribution of microfacet normals.
#[derive(Clone, Debug)]
pub struct Roughness {
    /// The distribution.
    pub distribution: MicrofacetDistribution,
    /// The roughness α along the tangents of u and v; for Beckmann's distribution, √2 times the
    /// root mean square slope.
    pub alpha: [Texture; 2],
}
