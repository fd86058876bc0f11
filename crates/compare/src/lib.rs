//! Compares measurement and prediction in units of statistical error.
//!
//! [`Applicability`] states which theory applies to a plane of a scene, or why no theory applies.
//! It also holds the facts of the scene that this theory needs. A [`Prediction`] holds everything
//! that the theory predicts for the plane. The function [`compare`] compares a measurement with the
//! prediction and returns a [`Verdict`]. The [`Residuals`] are the differences, and provide tests
//! of these differences. The test [`TwoSamples`] compares two measurements.
//!
//! This crate traces no photons. Its only free parameter is the level α of the test, which the
//! scene sets.

mod agreement;
mod applicability;
mod bandwidth;
mod budget;
mod chain;
mod class;
mod converge;
mod covariance;
mod depth;
mod field;
mod first_order;
mod full_radial;
mod heavy_rays;
mod lights;
mod memory;
mod noise;
mod off_parallel;
mod off_patches;
mod plane;
mod power;
mod prediction;
mod radial;
mod report;
mod residuals;
mod score;
mod tail;
mod theories;
mod theory_input;
mod two_samples;
mod unlit;
mod variation;
mod verdict;
mod work;

pub use applicability::Applicability;
pub use bandwidth::{criterion, exact_bandwidth, lobe_cutoff, measured_bandwidth};
pub use chain::{chain, stands_before};
pub use class::Class;
pub use converge::{Convergence, ConvergenceStep, converge, converge_to};
pub use covariance::{AXES, CovarianceReport, SliceMoment, TracedPlane};
pub use field::PredictedField;
pub use first_order::{FirstOrder, FirstOrderChain, FirstOrderReport};
pub use full_radial::{FullRadialComparison, FullRadialReport};
pub use memory::Memory;
pub use noise::noise_dof;
pub use off_patches::OffPatches;
pub use plane::{MIN_PHOTONS_PER_BATCH, PlaneComparison, compare};
pub use power::PowerReport;
pub use prediction::{PredictedParameter, Prediction};
pub use radial::radial;
pub use report::{
    Azimuths, Bandwidth, Covariance, DirectedPair, HighFrequencyShare, Pair, PlaneReport,
    WedgeShare,
};
pub use residuals::Residuals;
pub use score::ParameterReport;
pub use theories::Theory;
pub use theory_input::path;
pub use two_samples::{Estimate, Sample, TwoSamples, pull};
pub use verdict::{TESTS, Test, Verdict, sidak};
pub use work::{TooMuchWork, seconds, too_much_work};
