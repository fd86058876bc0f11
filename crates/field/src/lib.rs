//! The data types that all stages of Étendue share.
//!
//! A local light field is the radiance around a central ray, a function of the four coordinates of
//! a ray at a [virtual plane](VirtualPlane): position (x, y) and slopes (u, v), see [`TwoPlane`]. A
//! plane multiplies the light field by a [`Window`] and samples the spectrum of the product on a
//! [`SliceGrid`] of frequencies. The result, measured or predicted, is a set of [`Slices`]. A
//! [`FieldGrid`] divides the support of the window into cells.
//!
//! This crate contains plain values: it does not trace, transform, predict or access files.
//!
//! The Fourier transform is always F(Ω) = ∫ f(z) e^(−2πi Ω·z) dz, with frequencies in cycles per
//! unit (`docs/conventions.md`).

mod brdf;
mod crossing;
mod environment;
mod field_grid;
mod frame;
mod frequency;
mod hole;
mod image;
mod light;
mod mask;
mod number;
mod patch;
mod pattern;
mod plane;
mod portable;
mod projection;
mod raster;
mod ray_light;
mod rectangle;
mod reflectance;
mod shape;
mod slices;
mod window;

pub use brdf::{AngleTable, Brdf, Fresnel, Lobe, MicrofacetDistribution};
pub use crossing::{Crossing, Ledger, PhotonSource, PlaneTally};
pub use environment::{Environment, EnvironmentMap, LatLong, SphericalGaussian};
pub use field_grid::{Assignment, FieldGrid};
pub use frame::{Frame, TwoPlane, box_corners, enclosing};
pub use frequency::{FrequencyAxis, SliceGrid};
pub use hole::{ConvexPolygon, Hole, HoleMoments};
pub use image::Image;
pub use light::{EmittedRays, Light, LightValues};
pub use mask::Mask;
pub use number::{
    brief, byte_size, decimals, fixed, grouped, percent, sinc, tidy, uncertain, whole,
};
pub use patch::{Patch, Specular};
pub use pattern::{Pattern, Picture};
pub use plane::{Orientation, Quantity, Side, VirtualPlane};
pub use portable::{Complex, cis, modulus, power, sincos_turns, square_root};
pub use projection::{Projection, ProjectionGrid};
pub use raster::Raster;
pub use ray_light::{FluxRay, RayLight};
pub use rectangle::Rectangle;
pub use reflectance::{MOST_TERMS, Mixture, Reflectance, Term, Weight};
pub use shape::{
    Disc, Grating, HalfPlane, Shape, facet_ratio, interpolated_normal, triangle_distance,
    triangle_is_met,
};
pub use slices::Slices;
pub use window::{CosineTerm, Profile, Window};
