//! The closed form of light between parallel planes (docs/theory.md, sections 1 to 4).
//!
//! A [`Chain`] lists the operators on a light field as in Durand et al. 2005: travel (Eq. 3),
//! masks (Eq. 4), and the cosine and diffuse reflection of a receiver (Eqs. 6 and 7). Travel is a
//! shear of (position, slope), so every edge stays a straight line and every field is a signed sum
//! of products of convex polygons.
//!
//! | what | where |
//! |---|---|
//! | the chain as a model, and in words | `chain`, `model`, `describe` |
//! | its spectra: slices, one frequency, derivatives, pictures, harmonics on a 4D grid | `slices`, `at`, `with_derivatives`, `projection`, `harmonics` |
//! | terms of the product over masks, as polygons | `expansion`, `weighted_rectangle`, `disc`, `polygon`, `corners` |
//! | windows, gratings and factors that depend on slopes, as waves | `wave`, `slope`, `row` |
//! | a diffuse receiver | `receiver` |
//! | a curved glossy receiver at normal incidence, in flatland | `images`, `gloss` |
//! | prediction by nets of rays | `sampled` |
//! | light of finitely many rays | `ray_list` |

mod at;
pub(crate) mod chain;
mod corners;
mod derivative;
mod describe;
mod disc;
mod disc_resolution;
mod error;
pub(crate) mod expansion;
mod harmonics;
mod images;
#[cfg(test)]
mod laws;
mod model;
mod polygon;
mod projection;
mod ray_list;
mod receiver;
mod row;
mod sampled;
mod slices;
mod slope;
mod wave;
mod weighted_rectangle;
pub(crate) mod work;

pub use at::at;
pub use chain::{Chain, Operator, Source};
pub use derivative::with_derivatives;
pub use error::quadrature_error;
pub use harmonics::Harmonics;
pub use projection::projection;
pub use slices::slices;
use work::work;
