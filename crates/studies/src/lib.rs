//! Studies that make many runs or none: sweeps over fields of a scene, fits of fields to a
//! measurement, and Monte Carlo errors of pixels, predicted from measured spectra.
//!
//! This crate judges nothing: each point of a sweep is a run of `etendue_pipeline`.

#![allow(
    clippy::missing_errors_doc,
    reason = "a Failure holds the complete message for the user"
)]

pub mod derivative;
pub mod fit;
mod index;
pub mod sweep;
pub mod variance;
