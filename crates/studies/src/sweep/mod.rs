//! Runs a scene with fields that take several values, and collects the numbers of every plane as a
//! table and as curves.
//!
//! Each point is a separate run, stored below `points` in a folder named by the hash of its scene.
//! A sweep that was stopped, or whose values have changed, reuses the existing points.

mod bandwidth;
mod differences;
mod pictures;
mod points;
mod quiet_reporter;
mod request;
mod run;
pub(crate) mod table;
pub mod values;

pub use bandwidth::{BandwidthRow, bandwidths};
pub(crate) use points::given_twice;
pub use points::{SweepPoints, scene_at};
pub use request::SweepRequest;
pub(crate) use run::begin;
pub use run::{FinishedSweep, run};
