//! From photons that cross virtual planes to spectra with statistical errors.
//!
//! In: a [`PhotonSource`](etendue_field::PhotonSource) and the virtual planes. [`measure`] runs batches of
//! photons and keeps, for each batch and plane, the [`Slices`](etendue_field::Slices) of the windowed light
//! field, its projection on (x, u) and the tally of the window. Out: a [`Measurement`], partial or whole,
//! and the estimates made from its independent batches: mean slices with their variance
//! ([`estimate::slices`]), radial power without the photons' noise ([`CrossPower`]), slopes ([`moments`]) and
//! bandwidths ([`bandwidth`](mod@bandwidth)) with jackknife errors. The field itself on a 4D grid, with its full radial spectrum, is [`field`]'s.
//!
//! The transform is [`SliceTransform`](etendue_transform::SliceTransform). Nothing here traces or
//! predicts, and nothing judges: comparing with a prediction is another crate's.

pub mod bandwidth;
mod batch;
mod covariance;
pub mod estimate;
pub mod field;
mod histogram;
mod jackknife;
mod measure;
mod measurement;
pub mod moments;
mod radial;
mod ray_moments;

pub use batch::{Batch, PartialBatch, PlaneBatch};
pub use covariance::{CovarianceEstimate, covariance};
pub use histogram::ProjectionHistogram;
pub use jackknife::Uncertain;
pub use measure::{PROJECTION_BINS, Watch, measure, measure_watched};
pub use measurement::{Measurement, MergeError};
pub use radial::{CrossPower, RadialPower};
pub use ray_moments::RayMoments;
