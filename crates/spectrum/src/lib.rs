//! From photons that cross virtual planes to spectra with statistical errors.
//!
//! In: a [`PhotonSource`](etendue_field::PhotonSource) and the virtual planes. [`measure`] runs batches of
//! photons and keeps, for each batch and plane, the [`Slices`](etendue_field::Slices) of the windowed light
//! field, its projection on (x, u) and the tally of the window. Out: a [`Measurement`], partial or whole,
//! and the estimates made from its independent batches: mean slices with their variance
//! ([`estimate::slices`]), radial power without the photons' noise ([`CrossPower`]), slopes ([`moments`]) and
//! bandwidths ([`bandwidth`](mod@bandwidth)) with jackknife errors. The field itself on a 4D grid, with its full radial spectrum, is [`field`]'s.
//!
//! The transform is [`SliceTransform`], held against the plain sums of [`direct`]. Nothing here traces or
//! predicts, and nothing judges: comparing with a prediction is another crate's.
//!
//! ```
//! use etendue_field::{FrequencyAxis, SliceGrid, TwoPlane};
//! use etendue_spectrum::SliceTransform;
//!
//! let grid = SliceGrid {
//!     azimuths: 1,
//!     rho: FrequencyAxis { half: 2, spacing: 1.0 },
//!     nu: FrequencyAxis { half: 2, spacing: 1.0 },
//! };
//! let plan = SliceTransform::new(&grid);
//! let mut sum = plan.accumulator();
//! sum.deposit(&TwoPlane { x: 0.25, ..TwoPlane::default() }, 3.0);
//! let slices = sum.finish(1.0);
//! // At ρ = 1 cycle per metre, a ray at x = 1/4 m has the phase −π/2.
//! assert!((slices.half[[0, 1, 2]].im + 3.0).abs() < 1e-6); // 2e-7 of the weight
//! ```

pub mod bandwidth;
mod batch;
mod covariance;
pub mod direct;
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
pub use etendue_field::transform::{Accumulator, SliceTransform};
pub use histogram::ProjectionHistogram;
pub use jackknife::Uncertain;
pub use measure::{PROJECTION_BINS, Watch, measure, measure_watched};
pub use measurement::{Measurement, MergeError};
pub use radial::{CrossPower, RadialPower};
pub use ray_moments::RayMoments;
