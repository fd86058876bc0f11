use clap::ValueEnum;
use etendue_field::PhotonSource;
use etendue_scene::Scene;
use etendue_trace::Tracer;
use serde::{Deserialize, Serialize};

/// How light is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Method {
    /// Photons from the light, forward
    Photons,
}

/// The photons that `method` sends through a scene.
pub(crate) fn source(scene: &Scene, method: Method) -> Box<dyn PhotonSource> {
    match method {
        Method::Photons => Box::new(Tracer::new(scene)),
    }
}

impl Method {
    /// Whether it knows what becomes of all flux: only photons that leave the light do.
    pub(crate) fn keeps_ledger(self) -> bool {
        match self {
            Self::Photons => true,
        }
    }
}
