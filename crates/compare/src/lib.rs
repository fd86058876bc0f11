//! Compares measurement and prediction in units of statistical error.
//!
//! A [`Prediction`] holds everything that is predicted for a plane. The function [`compare`] compares
//! a measurement with the prediction and returns a [`Verdict`]. The [`Residuals`] are the
//! differences, and provide tests of these differences. The test [`TwoSamples`] compares two
//! measurements.
//!
//! This crate knows no scene, and neither traces nor predicts. Its only free parameter is the level
//! α of the test.

mod agreement;
mod bandwidth;
mod class;
mod field;
mod first_order;
mod fisher;
mod full_radial;
mod heavy_rays;
mod hint;
mod lights;
mod noise;
mod normal;
mod plane;
mod power;
mod prediction;
mod radial;
mod report;
mod residuals;
mod score;
mod signs;
mod tail;
mod two_samples;
mod variation;
mod verdict;

pub use bandwidth::{lobe_cutoff, measured_bandwidth, paired_changes};
pub use class::Class;
pub use field::PredictedField;
pub use first_order::{FirstOrder, FirstOrderChain, FirstOrderReport};
pub use fisher::fisher_information;
pub use full_radial::{FullRadialComparison, FullRadialReport};
pub use noise::noise_dof;
pub use normal::{NormalEquations, least_eigenvector, solved};
pub use plane::{MIN_PHOTONS_PER_BATCH, PlaneComparison, compare};
pub use power::PowerReport;
pub use prediction::{PredictedParameter, Prediction};
pub use radial::radial;
pub use report::{
    Azimuths, Bandwidth, Covariance, DirectedPair, HighFrequencyShare, Pair, PlaneReport,
    WedgeShare,
};
pub use residuals::{MIN_DIFFERING, Residuals};
pub use score::{ParameterReport, score};
pub use tail::chi_squared_above;
pub use two_samples::{Estimate, Sample, TwoSamples, pull};
pub use verdict::{TESTS, Test, Verdict, sidak};
