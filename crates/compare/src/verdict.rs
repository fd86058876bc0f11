//! The verdict of a comparison.

use serde::{Deserialize, Serialize};

/// The parameters of the test of each plane of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Test {
    /// A plane agrees with its prediction when the p-value is not below this level.
    pub level: f64,
    /// A plane can pass only if its noise, as a share of the spectrum, does not exceed this
    /// resolution.
    pub resolution: f64,
    /// The seed of the random signs of the p-value.
    pub seed: u64,
}

/// The number of tests of a plane: a test of the slices, and a test of the radial spectrum.
pub const TESTS: usize = 2;

impl Test {
    /// Checks whether a p-value is not below the level. Residuals that are all zero agree, and have
    /// no p-value.
    pub(crate) fn accepts(&self, p_value: Option<f64>) -> bool {
        p_value.is_none_or(|p| p >= self.level)
    }
}

/// The verdict on a plane or a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Measured and predicted agree.
    Pass,
    /// Measured and predicted differ by more than noise.
    Fail,
    /// Noise, or the error of the prediction, is too large for a decision.
    Undecided,
}

impl Verdict {
    /// The worse of two verdicts. A failure is worse than an undecided result, which is
    /// worse than a pass.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Fail, _) | (_, Self::Fail) => Self::Fail,
            (Self::Undecided, _) | (_, Self::Undecided) => Self::Undecided,
            (Self::Pass, Self::Pass) => Self::Pass,
        }
    }
}

/// The level of each of `tests` tests for which the probability that all tests pass is 1 −
/// `alpha` (Šidák 1967).
#[must_use]
pub fn sidak(alpha: f64, tests: usize) -> f64 {
    1.0 - libm::pow(1.0 - alpha, 1.0 / tests as f64)
}
