//! Planes along the path.

use crate::setup::{SettingKey, Setup};

/// A place on the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathPlace {
    /// At the light.
    Light,
    /// Before the blockers.
    Travelled,
    /// After the blockers.
    Blocked,
    /// At the receiver.
    Arrived,
    /// Light at the receiver, times the cosine.
    Irradiance,
    /// Light that leaves the diffuse receiver.
    Diffuse,
    /// Light on the glossy receiver, in the frames of its local normals.
    Curved,
    /// Light on the glossy receiver, after the lobe.
    Blurred,
    /// Light that leaves the glossy receiver.
    Glossy,
}

impl PathPlace {
    /// The planes of a scene, in the order of light.
    #[must_use]
    pub fn all(setup: &Setup) -> Vec<Self> {
        let mut all = vec![Self::Light, Self::Travelled, Self::Blocked, Self::Arrived];
        all.extend(if setup.is(SettingKey::Glossy) {
            vec![Self::Curved, Self::Blurred, Self::Glossy]
        } else {
            vec![Self::Irradiance, Self::Diffuse]
        });
        all
    }

    /// The name of the plane in the scene file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Travelled => "before_blockers",
            Self::Blocked => "after_blockers",
            Self::Arrived => "receiver",
            Self::Irradiance => "irradiance",
            Self::Diffuse | Self::Glossy => "leaving",
            Self::Curved => "curvature",
            Self::Blurred => "reflection",
        }
    }

    /// Whether the computation is slow, so that it must run in the background.
    #[must_use]
    pub fn is_slow(self) -> bool {
        matches!(self, Self::Irradiance | Self::Diffuse)
    }
}
