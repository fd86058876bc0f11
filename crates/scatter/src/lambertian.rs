//! Lambert's BRDF of albedo 1, the same in all directions in front of the surface. Directions are
//! sampled in proportion to their cosine.

pub use etendue_sampling::{cosine_hemisphere as sample, cosine_hemisphere_density as density};
use std::f64::consts::FRAC_1_PI;

/// The BRDF between two directions in front of the surface.
pub const VALUE: f64 = FRAC_1_PI;
