//! Predicts the Monte Carlo error of the mean radiance over the window of a virtual plane, from
//! the measured 4D spectrum of the light field, and measures the error really made.
//!
//! Window coordinates z ∈ \[0, 1\]⁴ have the order (x, u, y, v), with z = (x + h)/2h on each axis of
//! half-width h. The windows of the plane are replaced by Box windows ([`with_box_window`]). A mean
//! over N points that are shifted on the torus at random has the variance Σ_(m≠0) |f_m|² E|S_m|²,
//! exactly. [`MeasuredPower`] has |f_m|² from photons, [`ExpectedPower`] has E|S_m|² of samplers,
//! [`PredictedVariance`] has the sum, and [`WindowStudy`] compares it with the variance of means
//! over rays traced back.
//!
//! Without shifts the sum is over dyadic bands of the window instead of frequencies, for samplers
//! whose cells are dyadic blocks ([`dyadic_power`]). The border of the window is then no edge.

mod dyadic_power;
mod error;
mod expected_power;
pub mod figure;
mod found;
mod light_points;
mod measured_power;
mod point_counts;
pub mod point_file;
mod points;
mod power_estimate;
mod power_law;
mod prediction;
mod radiance;
mod report;
mod response;
mod sampler;
mod study;
pub mod table;
#[cfg(test)]
mod tests;

pub use dyadic_power::dyadic_power;
pub use error::VarianceError;
pub use expected_power::ExpectedPower;
pub use found::{DEFAULT_SETS, SETS, SetFamily, variance_of};
pub use light_points::LightPoints;
pub use measured_power::{
    DEFAULT_FREQUENCIES, FREQUENCIES, MeasuredPower, box_window, field_options, with_box_window,
};
pub use point_counts::{MAX_COUNTS, PointCounts};
pub use points::{points, shift};
pub use power_estimate::PowerEstimate;
pub use power_law::fitted_slope;
pub use prediction::{MAX_FILE_TAIL, PredictedVariance};
pub use radiance::{RayRadiance, WindowMoments, WindowRadiance};
pub use report::{
    AXES, AxisSetPower, CountReport, MAX_WORST, SamplerReport, VarianceCurve, WindowStudy,
    WorsePower, WorstFrequency, axis_sets,
};
pub use response::SamplerResponse;
pub use sampler::{AxisPairs, MAX_POINTS, PointFile, PointFileError, Sampler, WindowPoint};
pub use study::{CONSTANT, PlaneVariance, VarianceOptions, VarianceStudy, WindowLight};
