//! What surfaces of a world do to light.

use crate::Texture;
use etendue_field::MicrofacetDistribution;

/// What a surface does to light.
///
/// The front is the side that the normal of the [`Shape`](crate::Shape) points to. What scatters light on its front alone lets none through: its back is black.
#[derive(Clone, Debug)]
pub enum Material {
    /// The same radiance to all directions of the front: Lambert's BRDF, reflectance / π.
    Diffuse {
        /// The share of light that is reflected.
        reflectance: Texture,
    },
    /// A metal, on its front.
    Conductor(Conductor),
    /// An interface between two media that let light through, on both sides.
    Dielectric(Dielectric),
    /// A diffuse base below a dielectric coat, on its front.
    Plastic(Plastic),
    /// The modified Phong BRDF on the front: kd / π + ks (n + 2)/(2π) cosⁿ α, with α the angle to the mirror direction (Lafortune and Willems 1994).
    Phong {
        /// kd.
        diffuse: Texture,
        /// ks.
        specular: Texture,
        /// n.
        exponent: Texture,
    },
    /// One material on each side: what both do on their fronts. Neither lets light through.
    TwoSided(Box<[Self; 2]>),
    /// Light goes on as if nothing were there, but for a share that meets the material within.
    Mask {
        /// That share.
        opacity: Texture,
        /// What is met.
        of: Box<Self>,
    },
    /// A mixture: the first with weight 1 − w, the second with w.
    Blend {
        /// w.
        weight: Texture,
        /// Both.
        of: Box<[Self; 2]>,
    },
}

/// A metal: a mirror, or microfacets that are mirrors (Walter et al. 2007).
#[derive(Clone, Debug)]
pub struct Conductor {
    /// Index of refraction n + i k, relative to the medium outside; `None` reflects all.
    pub index: Option<[f64; 2]>,
    /// A factor on what is reflected.
    pub reflectance: Texture,
    /// `None` for a mirror.
    pub roughness: Option<Roughness>,
}

/// An interface that light is reflected by and refracted through.
#[derive(Clone, Debug)]
pub struct Dielectric {
    /// Index of refraction behind the front over that before it.
    pub index: f64,
    /// A factor on what is reflected.
    pub reflectance: Texture,
    /// A factor on what goes through.
    pub transmittance: Texture,
    /// `None` for a smooth interface.
    pub roughness: Option<Roughness>,
    /// A thin sheet of such an interface on both sides: light goes straight through, with all reflections within summed.
    pub is_thin: bool,
}

/// A diffuse base below a dielectric coat. Light that the base scatters is refracted on its way in and out, and reflected within.
#[derive(Clone, Debug)]
pub struct Plastic {
    /// Index of refraction of the coat over that outside.
    pub index: f64,
    /// Reflectance of the base.
    pub diffuse: Texture,
    /// A factor on what the coat reflects.
    pub specular: Texture,
    /// Whether each reflection within takes the colour of the base once more.
    pub is_nonlinear: bool,
    /// Of the coat, which the base does not see; `None` for a smooth one.
    pub roughness: Option<Roughness>,
}

/// How normals of microfacets are distributed.
#[derive(Clone, Debug)]
pub struct Roughness {
    /// The distribution.
    pub distribution: MicrofacetDistribution,
    /// α along the tangents of u and v: for Beckmann √2 times the root mean square slope.
    pub alpha: [Texture; 2],
}
