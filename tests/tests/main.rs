//! The tests of `etendue-validation`, one program for all.

mod architecture;
mod environments;
mod fuzz;
mod hostile;
mod physics;
#[path = "../src/statistics.rs"]
#[allow(dead_code, reason = "one of its functions is enough here")]
mod statistics;
mod two_samples;
mod wild;
