//! Predicts the Monte Carlo error of the mean radiance over the window of a virtual plane, from
//! the measured 4D spectrum of the light field, and measures the error really made.

mod expected_power;
mod points;
mod sampler;
#[cfg(test)]
mod tests;

pub use expected_power::ExpectedPower;
pub use points::{points, shift};
pub use sampler::{AxisPairs, MAX_POINTS, PointFile, PointFileError, Sampler, WindowPoint};
