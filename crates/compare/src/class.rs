//! The three kinds of prediction.

use serde::{Deserialize, Serialize};
use std::fmt;

/// What kind of prediction a plane has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// Equals the expectation of the measurement, in closed form or by quadrature.
    Exact,
    /// The paper's linearised chain, its error computed beside it: first order minus the exact ray-space prediction.
    FirstOrder,
    /// There is no theory: the other tracer's measurement takes its place.
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
