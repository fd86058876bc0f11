//! What a comparison comes to.

use serde::Serialize;

/// What a plane or a run comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Measured and predicted agree.
    Pass,
    /// They do not.
    Fail,
    /// No disagreement was seen, but noise would have hidden one: the plane needs more photons.
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
