use crate::failure::Failure;
use clap::ValueEnum;
use etendue_field::{PhotonSource, VirtualPlane};
use etendue_scene::Scene;
use etendue_trace::{Backward, Tracer, finds};
use serde::{Deserialize, Serialize};

/// How light is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Photons from the light, forward
    Photons,
    /// Rays drawn in the window of each plane, traced back to the light
    Backward,
    /// Photons that are not aimed at windows, to judge others.
    #[value(skip)]
    Even,
}

/// The photons that `method` sends through a scene.
pub(crate) fn source(scene: &Scene, method: Method) -> Result<Box<dyn PhotonSource>, Failure> {
    Ok(match method {
        Method::Photons => Box::new(Tracer::new(scene)),
        Method::Backward => Box::new(Backward::new(scene).map_err(Failure::bad_input)?),
        Method::Even => Box::new(Tracer::evenly(scene)),
    })
}

/// Fails, before anything is written, when a scene cannot be measured by `method`.
pub(crate) fn check(scene: &Scene, method: Method) -> Result<(), Failure> {
    match method {
        Method::Backward => Backward::new(scene).map(drop).map_err(Failure::bad_input),
        Method::Photons | Method::Even => Ok(()),
    }
}

impl Method {
    /// Whether it knows what becomes of all flux: only photons that leave the light do.
    pub(crate) fn keeps_ledger(self) -> bool {
        match self {
            Self::Photons | Self::Even => true,
            Self::Backward => false,
        }
    }

    /// The method that judges this one at a plane, as independent of it as the scene allows.
    pub(crate) fn judge(self, scene: &Scene, plane: &VirtualPlane) -> Self {
        match self {
            Self::Photons if finds(scene, plane) => Self::Backward,
            Self::Photons => Self::Even,
            Self::Backward | Self::Even => Self::Photons,
        }
    }

    /// The step of a prediction that it takes the place of.
    pub(crate) fn step(self) -> String {
        let shared = match self {
            Self::Photons | Self::Backward => "",
            // No ray finds the light otherwise.
            Self::Even => ", which go on as photons do: what is wrong on their way is not seen",
        };
        format!("instead of theory  {}{shared}", self.words())
    }

    /// What it measures with, in words.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Photons => "photons",
            Self::Backward => "backward rays",
            Self::Even => "photons sent evenly",
        }
    }
}
