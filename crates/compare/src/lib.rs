//! Measured against predicted, in units of statistical error.
//!
//! [`chain()`] reads theory's chain off a scene: the only code that sees both. A [`Prediction`] is all that
//! theory says about a plane; [`compare`] holds a measurement against it and comes to a [`Verdict`].
//! [`Residuals`] are the difference, batch by batch, with the tests made on it.
//!
//! Nothing here traces, and nothing tunes: the only freedom is the level α of the test, set in the scene.

mod agreement;
mod applicability;
mod bandwidth;
mod chain;
mod class;
mod converge;
mod dark;
mod first_order;
mod memory;
mod parallel;
mod plane;
mod prediction;
mod report;
mod residuals;
mod scattering;
mod score;
mod system;
mod verdict;
mod ways;
mod work;

pub use applicability::{Applicability, Theory};
pub use bandwidth::{criterion, exact_bandwidth, measured_bandwidth};
pub use chain::{chain, stands_before};
pub use class::Class;
pub use converge::{Convergence, converge};
pub use first_order::{FirstOrder, FirstOrderChain, FirstOrderReport};
pub use memory::Memory;
pub use plane::{PlaneComparison, compare};
pub use prediction::{PredictedParameter, Prediction};
pub use report::{Bandwidth, Covariance, HighFrequencyShare, Pair, PlaneReport, sidak};
pub use residuals::Residuals;
pub use score::ParameterReport;
pub use system::{scattered, system};
pub use verdict::Verdict;
pub use work::{TooMuchWork, too_much_work};
