//! The reasons why the variance at a plane cannot be studied.

use etendue_spectrum::estimate::TooFewBatches;
use etendue_trace::LightNotFound;

/// The reason why the variance at a plane cannot be studied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VarianceError {
    /// The plane sees light without extent directly.
    #[error(
        "{0} sees a point, a projector or a beam directly, so its radiance is infinite along single rays; allowed: light with an area, an environment, or a plane after a surface that scatters"
    )]
    NoRadiance(String),
    /// Points on the light cannot be coordinates.
    #[error("{plane}: points on the light cannot be coordinates, because {because}")]
    NoLightPoints {
        /// Name of the plane.
        plane: String,
        /// The reason.
        because: &'static str,
    },
    /// Rays traced back do not find the light.
    #[error(transparent)]
    LightNotFound(#[from] LightNotFound),
    /// There are too few batches for errors.
    #[error(transparent)]
    TooFewBatches(#[from] TooFewBatches),
}
