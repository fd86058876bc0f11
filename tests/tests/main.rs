//! The tests of `etendue-validation`, as one program.

#![allow(clippy::too_many_lines, reason = "a test may be a list of cases")]

mod architecture;
mod common;
mod environments;
mod hostile;
mod lights;
mod physics;
mod precision;
#[path = "../src/scenes.rs"]
#[allow(dead_code, reason = "some of its functions are enough here")]
mod scenes;
#[path = "../src/statistics.rs"]
#[allow(dead_code, reason = "one of its functions is enough here")]
mod statistics;
mod two_samples;
mod wild;
