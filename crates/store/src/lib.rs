//! Manages folders of results: which files Étendue owns, how new files replace old files, and what
//! the files contain.
//!
//! [`Results`] claims a folder, writes files and an index of their hashes, and puts all files in
//! place together. The other modules define the content of files: arrays, batches, predictions, and
//! the indices that a later stage reads.
//!
//! This crate neither computes nor draws results.

#![allow(
    clippy::missing_errors_doc,
    reason = "a Failure holds the complete message for the user"
)]

mod argument_style;
pub mod arrays;
pub mod batches;
pub mod checkpoints;
pub mod exr;
mod failure;
pub mod fields;
pub mod file_seal;
pub mod framing;
mod lock;
pub mod machine;
mod method;
pub mod npz;
pub mod output;
pub mod predictions;
mod results;
pub mod sealed;
pub mod stored;
pub mod theory;
pub mod unfinished;
mod version;

pub use argument_style::ArgumentStyle;
pub use failure::{Failure, FailureKind};
pub use method::Method;
pub use results::{
    COVARIANCE, EXPORT, FIGURE, FIT, Finished, MAX_INDEX_BYTES, MEASUREMENT, PICTURE, PREDICTION,
    PROBE, Plan, Results, SUMMARY, SWEEP, TIMING, VARIANCE, below, hash_of,
};
pub use version::{COMMIT, VERSION};
