//! Fits free fields of a scene to a measurement, by least squares on its slices.
//!
//! χ² is the sum of |S − F|²/σ² over the independent frequencies of all planes. Damped Gauss–Newton
//! steps descend from several starts, from low frequencies to all. Derivatives of the predictions F
//! are central differences. Errors come from the spread of batches, so they contain the
//! correlations between frequencies and between planes that the weights 1/σ² leave out.

mod data;
pub mod figure;
mod model;
mod plan;
mod request;
mod result;
mod search;
pub mod table;

pub use data::{FitData, FitPlane};
pub use model::FitModel;
pub(crate) use model::size;
pub use plan::{FitPlan, PlannedPlane, plan};
pub use request::{FitRequest, index, range};
pub(crate) use result::spread;
pub use result::{Degeneracy, FitMinimum, Fitted, FittedField, fit};
pub use search::FitStarts;
