//! The results of a probe at a plane.

use super::covariance::FoundCovariance;
use etendue_compare::{PlaneComparison, Verdict};
use etendue_spectrum::Uncertain;
use etendue_spectrum::bandwidth::Widest;

/// The results at a plane.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) comparison: PlaneComparison,
    /// The bandwidths of the light less its mean.
    pub(super) nu: Option<Widest<Uncertain>>,
    pub(super) rho: Option<Widest<Uncertain>>,
    /// Why photons do not find all light of the plane.
    pub(super) misses: Option<&'static str>,
    /// The covariance of the plane's spectrum, if requested.
    pub(super) covariance: Option<FoundCovariance>,
}

/// Returns the verdict on a plane: undecided if photons do not find all light, and pass if neither
/// rays nor photons find light.
pub(super) fn verdict(found: &Found) -> Verdict {
    match found.misses {
        Some(_) => Verdict::Undecided,
        None if found.is_dark() => Verdict::Pass,
        None => found.comparison.report.verdict,
    }
}

impl Found {
    /// Whether neither rays nor photons found light.
    pub(super) fn is_dark(&self) -> bool {
        self.comparison.measured.is_dark() && self.comparison.predicted.is_dark()
    }
}
