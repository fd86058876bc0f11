//! Carries out a run from scene to verdict, as a library. A run measures a scene, predicts the
//! spectra, tests planes against another tracer, and investigates failures. A run also adds
//! photons until the noise is low enough, stores batches, and uses several processes.
//!
//! The library does not depend on arguments or a terminal. Progress is reported to a [`Reporter`].
//! The entry point is [`Run`].

#![allow(
    clippy::missing_errors_doc,
    reason = "a Failure holds the complete message for the user"
)]

mod checkpoint;
pub mod covariance;
mod enough_photons;
pub mod field;
mod file_rays;
mod follower;
mod inquiry;
mod judge;
mod judged;
pub mod limits;
pub mod load;
mod measure;
pub mod method;
pub mod photons;
pub mod planes;
mod read_case;
mod reporter;
mod run;
mod summary;
mod target;
mod twin;
mod twin_photons;
mod workers;

pub use checkpoint::Checkpointing;
pub use follower::{follow_points, follow_run, report_failure};
pub use judged::{Judged, judged};
pub use measure::{MeasuredScene, measured};
pub use read_case::{PredictionSource, read_case, read_measurement, stored_batches};
pub use reporter::{Progress, Reporter, Silent, Work};
pub use run::{Outcome, Run, Tracing};
pub use summary::{Inquiry, Summary};
pub use workers::{Leader, Packing, Task, Workers, key};
