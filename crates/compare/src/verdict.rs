//! What a comparison comes to.

use serde::Serialize;

/// The verdict on a plane or a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Measured and predicted agree.
    Pass,
    /// Measured and predicted differ by more than noise.
    Fail,
    /// Noise, or the error of the prediction, leaves the question open.
    Undecided,
}

impl Verdict {
    /// The worse of two: fail before undecided before pass.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Fail, _) | (_, Self::Fail) => Self::Fail,
            (Self::Undecided, _) | (_, Self::Undecided) => Self::Undecided,
            (Self::Pass, Self::Pass) => Self::Pass,
        }
    }
}
