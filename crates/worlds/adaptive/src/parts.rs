//! Defines the methods to distribute shading samples. A method is a choice of parts.

use crate::criterion::BandwidthCriterion;
use crate::reconstruct::SampleFit;

/// The distribution of shading samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleMethod {
    /// Samples are uniform over all shaded pixels.
    Uniform,
    /// Samples follow the criteria of Durand et al. 2005, Eqs. 20 and 21, with corrections.
    Predicted,
    /// The algorithm of Durand et al. 2005, section 6.2, as printed.
    Paper,
    /// Half of the samples follow the criteria, and half follow the measured light. The first
    /// quarter of the samples measures the light: planes are fitted to one half of this quarter,
    /// and their error is evaluated at the other half.
    Weighted,
    /// The default. The first samples are evenly distributed. Half of the remaining samples follow
    /// the criteria, and half follow the errors at the first samples. The errors at the first
    /// samples also calibrate the criteria for each object.
    Auto,
    /// Samples follow only the measured light. The first quarter of the samples is uniform, and the
    /// rest follow the relative standard deviation of this quarter.
    Variance,
}

/// The parts of a method, in the order of the algorithm of Durand et al. 2005, section 6.2: a
/// criterion gives a bandwidth, the bandwidth gives a density, samples are placed with this
/// density, they are shaded, and the picture is reconstructed between them. All methods shade
/// samples by the same paths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MethodParts {
    /// The criterion that bounds the bandwidth; `None` if the first samples are even.
    pub(crate) criterion: Option<BandwidthCriterion>,
    /// The density of samples is proportional to B² to this power, for a bandwidth B.
    pub(crate) power: f64,
    /// What places samples, besides this density.
    pub(crate) placing: SamplePlacing,
    /// The reconstruction between samples.
    pub(crate) fit: SampleFit,
}

/// The influence of first samples on the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SamplePlacing {
    /// All samples are placed together.
    Together,
    /// The others follow the contrast of the first samples.
    ByContrast,
    /// Half of the others follow the errors at the first samples.
    ByErrors,
    /// Like `ByErrors`; the errors also calibrate the criterion, and a guide.
    Calibrated,
}

/// The squared error of a plane fitted to samples is proportional to the fourth power of their
/// spacing, and therefore to 1/n² for a density n of samples. Let c be the contrast and B the
/// bandwidth. For a fixed number of samples, the sum of this error over the picture is minimal if n
/// ∝ (c² B⁴)^(1/3).
pub(crate) const POWER: f64 = 2.0 / 3.0;

impl SampleMethod {
    /// The parts of the method.
    pub(crate) fn parts(self) -> MethodParts {
        let even = MethodParts {
            criterion: None,
            power: 1.0,
            placing: SamplePlacing::Together,
            fit: SampleFit::Plane,
        };
        let predicted = MethodParts {
            criterion: Some(BandwidthCriterion::Corrected),
            power: POWER,
            ..even
        };
        let placed = |parts, placing| MethodParts { placing, ..parts };
        match self {
            Self::Uniform => even,
            Self::Variance => placed(even, SamplePlacing::ByContrast),
            Self::Predicted => predicted,
            Self::Weighted => placed(predicted, SamplePlacing::ByErrors),
            Self::Auto => placed(predicted, SamplePlacing::Calibrated),
            // A signal of bandwidth B requires 2B samples along each direction (Shannon), so their
            // density is proportional to B².
            Self::Paper => MethodParts {
                criterion: Some(BandwidthCriterion::Printed),
                fit: SampleFit::Mean,
                ..even
            },
        }
    }

    /// The default number of rays from a point that measure the distance of blockers.
    #[must_use]
    pub fn blocker_rays(self) -> u32 {
        match self {
            Self::Paper => 100,
            // A hundred rays would take most of the time.
            _ => 16,
        }
    }
}
