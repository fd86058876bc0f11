//! Measured against predicted, in units of statistical error.
//!
//! [`chain()`] reads theory's chain off a scene: the only code that sees both. A [`Prediction`] is all that
//! theory says about a plane; [`compare`] holds a measurement against it and comes to a [`Verdict`].
//! [`Residuals`] are the difference, batch by batch, with the tests made on it.
//!
//! Nothing here traces, and nothing tunes: the only freedom is the level α of the test, set in the scene.

mod bandwidth;
mod chain;
mod class;
mod converge;
mod first_order;
mod memory;
mod plane;
mod prediction;
mod report;
mod residuals;
mod scattering;
mod score;
mod system;
mod work;

pub use bandwidth::{criterion, exact_bandwidth, measured_bandwidth};
pub use chain::{chain, stands_before};
pub use class::Class;
pub use converge::{Convergence, converge};
pub use first_order::{FirstOrder, FirstOrderChain, FirstOrderReport, affine_chain};
pub use memory::Memory;
pub use plane::{PlaneComparison, compare};
pub use prediction::{PredictedParameter, Prediction, steps};
pub use report::{Bandwidth, Covariance, HighFrequencyShare, Pair, PlaneReport, Verdict, sidak};
pub use residuals::Residuals;
pub use scattering::scattered;
pub use score::ParameterReport;
pub use system::system;
pub use work::{TooMuchWork, too_much_work, work};
