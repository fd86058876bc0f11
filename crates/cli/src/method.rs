use crate::failure::Failure;
use clap::ValueEnum;
use etendue_compare::Applicability;
use etendue_field::PhotonSource;
use etendue_scene::Scene;
use etendue_trace::{Backward, PointLight, Tracer};
use serde::{Deserialize, Serialize};

/// How light is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Method {
    /// Photons from the light, forward
    Photons,
    /// Rays drawn in the window of each plane, traced back to the light
    Backward,
}

/// The photons that `method` sends through a scene.
pub(crate) fn source(scene: &Scene, method: Method) -> Result<Box<dyn PhotonSource>, Failure> {
    Ok(match method {
        Method::Photons => Box::new(Tracer::new(scene)),
        Method::Backward => Box::new(Backward::new(scene).map_err(Failure::bad_input)?),
    })
}

/// Fails, before anything is written, when a scene cannot be measured by `method`, or needs the other one as a
/// reference that it cannot have.
pub(crate) fn check(
    scene: &Scene,
    theories: &[Applicability],
    method: Method,
) -> Result<(), Failure> {
    if scene.light.has_extent() {
        return Ok(());
    }
    if method == Method::Backward {
        return Err(Failure::bad_input(PointLight));
    }
    for (plane, Applicability { reasons, .. }) in scene.planes.iter().zip(theories) {
        if !reasons.is_empty() {
            return Err(Failure::bad_input(format!(
                "{} has no prediction ({}), and nothing to compare with: {PointLight}",
                plane.name,
                reasons.join(", ")
            )));
        }
    }
    Ok(())
}

impl Method {
    /// Whether it knows what becomes of all flux: only photons that leave the light do.
    pub(crate) fn keeps_ledger(self) -> bool {
        match self {
            Self::Photons => true,
            Self::Backward => false,
        }
    }

    /// The other, independent one.
    pub(crate) fn other(self) -> Self {
        match self {
            Self::Photons => Self::Backward,
            Self::Backward => Self::Photons,
        }
    }
}
