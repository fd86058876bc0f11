//! Writes the readable output of a run: pictures of its planes and path, and a page that shows
//! everything.
//!
//! This crate measures and judges nothing; it shows what `etendue_pipeline` has found.

#![allow(
    clippy::missing_errors_doc,
    reason = "a Failure holds the complete message for the user"
)]

pub mod covariance;
mod drawing;
mod explorer;
pub mod page;
pub mod pictures;
mod shell;
pub mod variance;
mod write_result;

pub use shell::shell_word;
pub use write_result::{OutputOptions, check_explorer, plan, save, write_result};
