//! The results of a probe at a plane.

use super::covariance::FoundCovariance;
use etendue_compare::{PlaneComparison, Verdict};
use etendue_spectrum::Uncertain;
use etendue_spectrum::bandwidth::Widest;
use etendue_studies::variance::PlaneVariance;

/// The results at a plane.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) comparison: PlaneComparison,
    /// The bandwidths of the light after its mean is subtracted.
    pub(super) nu: Option<Widest<Uncertain>>,
    pub(super) rho: Option<Widest<Uncertain>>,
    pub(super) judge: SecondEstimate,
    /// The number of backward rays, and the number of rays or photons of the judge.
    pub(super) counts: [u64; 2],
    /// The numbers with which the noise would allow a verdict; infinite if not known.
    pub(super) needed: [f64; 2],
    /// The reason why photons do not find all light of the plane.
    pub(super) misses: Option<&'static str>,
    /// The covariance of the plane's spectrum, if requested.
    pub(super) covariance: Option<FoundCovariance>,
    /// The variances of samplers, if requested. A dark plane and one of constant radiance have none.
    pub(super) variance: Option<PlaneVariance>,
}

/// The measurement with which the backward rays are compared; below it is called the judge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SecondEstimate {
    /// Photons from the lights.
    Photons,
    /// Backward rays that find lights only by directions sampled from BSDFs.
    BsdfRays,
}

impl SecondEstimate {
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Photons => "photons",
            Self::BsdfRays => "BSDF rays",
        }
    }
}

/// The verdict on a plane. The plane is undecided if the judge does not find all light. The
/// plane passes if neither the rays nor the judge find light.
pub(super) fn verdict(found: &Found) -> Verdict {
    match found.misses {
        Some(_) if found.judge == SecondEstimate::Photons => Verdict::Undecided,
        _ if found.is_dark() => Verdict::Pass,
        _ => found.comparison.report.verdict,
    }
}

impl Found {
    /// Checks whether the plane is dark: rays found no light, and photons found none.
    pub(super) fn is_dark(&self) -> bool {
        self.comparison.measured.is_dark() && self.comparison.predicted.is_dark()
    }
}
