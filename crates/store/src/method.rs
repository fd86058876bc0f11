//! The method of measuring light.

use etendue_field::VirtualPlane;
use etendue_scene::Scene;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// The method of measuring light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Photons traced forward from the light.
    Photons,
    /// Rays drawn in the window of each plane, traced back to the light.
    Backward,
    /// Photons that are not aimed at windows. They are used to test other methods.
    Even,
    /// The prediction of another scene, plus photons of both scenes in pairs.
    Difference,
    /// Rays that the user gives, each once. Étendue does not trace them, so no other tracer can
    /// judge them.
    Given,
}

impl Method {
    /// Checks whether the method keeps a ledger of all flux. Only methods that trace photons from
    /// the light keep a ledger.
    #[must_use]
    pub fn keeps_ledger(self) -> bool {
        match self {
            Self::Photons | Self::Even => true,
            Self::Backward | Self::Difference | Self::Given => false,
        }
    }

    /// The planes at which the method records light: those of the scene, and for a difference also
    /// those of the other scene, whose names get an ending that names of scenes cannot have.
    #[must_use]
    pub fn recorded_planes(self, scene: &Scene) -> Cow<'_, [VirtualPlane]> {
        match &scene.against {
            Some(other) if self == Self::Difference => {
                let others = other.planes.iter().map(|plane| VirtualPlane {
                    name: format!("{}.other", plane.name),
                    ..plane.clone()
                });
                scene.planes.iter().cloned().chain(others).collect()
            }
            _ => Cow::Borrowed(&scene.planes),
        }
    }

    /// The name of the method in commands.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Photons => "photons",
            Self::Backward => "backward",
            Self::Even => "even",
            Self::Difference => "difference",
            Self::Given => "given",
        }
    }

    /// The words for what the method traces.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Photons => "photons",
            Self::Backward => "backward rays",
            Self::Even => "photons sent evenly",
            Self::Difference => "photons in pairs with photons of another scene",
            Self::Given => "the given rays",
        }
    }
}
