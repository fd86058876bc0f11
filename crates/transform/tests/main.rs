//! Tests of this crate's transforms against plain sums.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod fft;
mod random;
mod slices;
