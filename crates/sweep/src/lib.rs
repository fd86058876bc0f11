//! A scene with fields that take several values: every plane's numbers as one table, and curves.
//!
//! Each point is a run of its own, kept below `points` in a folder named by the hash of its scene. A
//! sweep that was stopped, or that has other values now, goes on from what is there.

#![allow(
    clippy::missing_errors_doc,
    reason = "a Failure carries the whole message for the user, written where it occurs"
)]

mod pictures;
mod points;
mod quiet_reporter;
mod request;
mod run;
mod table;
pub mod values;

pub use points::{SweepPoints, scene_at};
pub use request::SweepRequest;
pub use run::{FinishedSweep, run};
