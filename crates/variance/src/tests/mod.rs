//! Tests of the crate: spectra of point sets, and predictions of known integrands.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod periodograms;
