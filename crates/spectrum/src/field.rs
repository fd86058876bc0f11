//! Measures the windowed light field on a 4D grid, and computes its transform and its full radial
//! spectrum.
//!
//! The slices need no grid and have no aliasing. Two results need all four dimensions together and
//! use a grid: the field that is written to a file, and the power over (|Ωxy|, |Ωuv|), averaged
//! over both azimuths. The function [`measure_field`] traces the photons of one plane onto a
//! [`FieldGrid`](etendue_field::FieldGrid). The method [`FieldSpectrum::aliasing`] estimates the
//! error due to the grid.

mod aliasing;
mod bins;
mod cells;
mod covariance;
mod cross;
mod measure;
mod products;
mod spectrum;
mod spline;

pub use aliasing::Aliasing;
pub use bins::{RadialBins, full_radial_of};
pub use cells::{FieldCells, FieldTransform};
pub use covariance::{FieldCovariance, MatrixEstimate, Moments, PowerMoments};
pub use cross::FullRadial;
pub use measure::{FieldGroup, FieldMeasurement, FieldOptions, measure_field};
pub use spectrum::FieldSpectrum;
