//! How light is measured.

use serde::{Deserialize, Serialize};

/// How light is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Photons from the light, forward.
    Photons,
    /// Rays drawn in the window of each plane, traced back to the light.
    Backward,
    /// Photons that are not aimed at windows, to judge others.
    Even,
}

impl Method {
    /// Whether it knows what becomes of all flux: only photons that leave the light do.
    #[must_use]
    pub fn keeps_ledger(self) -> bool {
        match self {
            Self::Photons | Self::Even => true,
            Self::Backward => false,
        }
    }

    /// As commands have it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Photons => "photons",
            Self::Backward => "backward",
            Self::Even => "even",
        }
    }

    /// What it measures with, in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Photons => "photons",
            Self::Backward => "backward rays",
            Self::Even => "photons sent evenly",
        }
    }
}
