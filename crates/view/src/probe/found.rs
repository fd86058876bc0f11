//! What a probe finds at a plane.

use super::covariance::FoundCovariance;
use etendue_compare::{PlaneComparison, Verdict};
use etendue_spectrum::Uncertain;
use etendue_spectrum::bandwidth::Widest;

/// What came of a plane.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) comparison: PlaneComparison,
    pub(super) nu: Option<Widest<Uncertain>>,
    pub(super) rho: Option<Widest<Uncertain>>,
    /// Why photons do not find all its light.
    pub(super) misses: Option<&'static str>,
    /// The covariance of its spectrum, if it was asked for.
    pub(super) covariance: Option<FoundCovariance>,
}

/// Where photons do not find all light, nothing is judged. Where neither finds any, they agree.
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
