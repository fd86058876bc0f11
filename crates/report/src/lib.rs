//! Writes the readable output of a run: tables, pictures of its planes and path, and a page that
//! shows everything. It also compares the results of two runs.
//!
//! This crate measures nothing; it shows what `etendue_pipeline` has found.

#![allow(
    clippy::missing_errors_doc,
    reason = "a Failure holds the complete message for the user"
)]

pub mod covariance;
pub mod diff;
mod drawing;
mod explorer;
pub mod page;
pub mod pictures;
pub mod ray_file;
mod shell;
pub mod table;
mod timing;
mod write_result;

pub use shell::shell_word;
pub use timing::Stopwatch;
pub use write_result::{OutputOptions, announcement, check_explorer, plan, save, write_result};
