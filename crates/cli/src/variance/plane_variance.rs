//! The numbers that `etendue variance` prints, draws and writes.

use etendue_spectrum::Uncertain;
use etendue_variance::{AxisSetPower, SamplerReport, WindowMoments};

/// The predicted and found variances at a plane.
pub(super) struct PlaneVariance {
    /// Name of the plane.
    pub(super) plane: String,
    /// Half-widths of the window along (x, u, y, v), in metres and slope.
    pub(super) half_widths: [f64; 4],
    /// The mean of the radiance over the window, by photons.
    pub(super) mean_by_photons: Uncertain,
    /// The moments of the radiance over the window, by rays traced back.
    pub(super) moments: WindowMoments,
    /// The power at the measured frequencies, as a share of σ².
    pub(super) inside: f64,
    /// The power by set of nonzero axes.
    pub(super) axis_sets: Vec<AxisSetPower>,
    /// The variances of each sampler.
    pub(super) samplers: Vec<SamplerReport>,
}
