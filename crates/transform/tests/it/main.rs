//! The transforms of this crate against plain sums.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod fft;
mod random;
mod slices;
