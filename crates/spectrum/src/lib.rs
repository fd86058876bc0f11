//! Converts photons that cross virtual planes to spectra with statistical errors.
//!
//! The input is a [`PhotonSource`](etendue_field::PhotonSource) and the virtual planes. The
//! function [`measure`] runs batches of photons. For each batch and plane, the function records the
//! [`Slices`](etendue_field::Slices) of the windowed light field and the projection of this field
//! on (x, u). It also records the numbers of photons inside and outside the window. The output is a
//! complete or partial [`Measurement`]. The independent batches of a measurement give estimates.
//! [`estimate::slices`] returns the mean slices with their variance, and [`CrossPower`] computes
//! the radial power without the photons' noise. Slopes ([`moments`]) and bandwidths
//! ([`bandwidth`](mod@bandwidth)) have jackknife errors. The module [`field`] measures the light
//! field on a 4D grid, with its full radial spectrum.
//!
//! [`SliceTransform`](etendue_transform::SliceTransform) computes the transform of rays to slices.
//! This crate does not trace photons or predict spectra, and another crate compares the results
//! with a prediction.

pub mod bandwidth;
mod batch;
mod covariance;
pub mod directional;
pub mod estimate;
pub mod field;
mod histogram;
mod jackknife;
mod mapped;
mod measure;
mod measurement;
pub mod moments;
mod radial;
mod ray_moments;
mod recorder;
mod variation;

pub use batch::{Batch, PartialBatch, PlaneBatch};
pub use covariance::{CovarianceEstimate, covariance};
pub use jackknife::Uncertain;
pub use mapped::mapped_photons;
pub use measure::{Watch, measure, measure_watched};
pub use measurement::{Measurement, MergeError};
pub use radial::{CrossPower, RadialPower};
pub use ray_moments::RayMoments;
pub use recorder::PROJECTION_BINS;
pub use variation::WindowedMean;
