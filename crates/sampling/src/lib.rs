//! Sampling of points and directions from random numbers, for the tracers of bench scenes and of
//! worlds.
//!
//! Random numbers are in (0, 1). Directions have unit length, and densities of directions are per steradian.
//!
//! This crate draws no random numbers and knows no BSDFs; those are in `etendue_scatter`.

pub mod chi_square;
mod cone;
mod discrete;
mod lat_long;
mod warp;

pub use cone::Cone;
pub use discrete::DiscreteDistribution;
pub use lat_long::LatLongSampler;
pub use warp::{
    about, cosine_hemisphere, cosine_hemisphere_density, disc, polar, sphere, triangle,
};

#[cfg(test)]
mod tests;
