//! BSDFs for the tracers of bench scenes and of worlds. Each BSDF provides its value, a sampler
//! of directions, and the density of the sampler.
//!
//! Directions are unit vectors away from the surface, in a frame with its normal along Z: light
//! comes from `wi` and leaves along `wo`. `wo` is given and `wi` is sampled, as for a ray from a
//! camera. A tracer of photons exchanges `wi` and `wo`, which is allowed for reciprocal BSDFs.
//!
//! Values are per steradian and without the cosine of `wi`; densities are per solid angle of `wi`.
//! Random numbers are in (0, 1). The tracers evaluate patterns, textures and mixtures; in this
//! crate, all numbers refer to one point.

mod bsdf;
mod conductor;
mod dielectric;
mod diffuse_transmission;
mod fresnel;
pub mod lambertian;
mod metallic_roughness;
mod microfacet;
mod phong;
mod plastic;
mod principled;

pub use bsdf::{Bsdf, BsdfSample};
pub use conductor::{Conductor, mirror};
pub use dielectric::{RoughDielectric, SmoothDielectric};
pub use diffuse_transmission::DiffuseTransmission;
pub use fresnel::reflectance;
pub use metallic_roughness::MetallicRoughness;
pub use microfacet::Microfacets;
pub use phong::{ModifiedPhong, Phong};
pub use plastic::{Coat, Plastic};
pub use principled::{Principled, PrincipledInside};

#[cfg(test)]
mod tests;
