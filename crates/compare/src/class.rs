//! The three kinds of prediction.

use serde::{Deserialize, Serialize};
use std::fmt;

/// The kind of prediction that a plane has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// The prediction equals the expectation of the measurement, in closed form or by quadrature.
    Exact,
    /// Two predictions exist: an exact prediction by rays, and the paper's first-order chain with
    /// its computed error.
    FirstOrder,
    /// No theory applies. The other tracer's measurement serves as the prediction.
    Reference,
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exact => "exact",
            Self::FirstOrder => "first-order",
            Self::Reference => "reference",
        })
    }
}
