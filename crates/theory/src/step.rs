//! One step of a chain that leads light to a plane.

use crate::geometry::SpectrumMap;
use etendue_field::Mask;

/// A step of a chain of affine maps.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainStep {
    /// The description of the step, which begins with a verb.
    pub words: String,
    /// What the step does to the light field.
    pub action: ChainAction,
}

/// What a step does to a light field.
#[derive(Clone, Debug, PartialEq)]
pub enum ChainAction {
    /// Moves its spectrum.
    Map(SpectrumMap<4>),
    /// Multiplies it by the transmittance of a mask.
    Mask(Mask),
    /// Multiplies it by (1 + u² + v²)⁻², for irradiance on a plane.
    SlopeCosine,
    /// Multiplies it by cos⁺θ cos²φ, for irradiance on a surface.
    AngleCosine,
    /// Something else, which only the words describe.
    Other,
}

impl ChainStep {
    pub(crate) fn new(words: impl Into<String>, action: ChainAction) -> Self {
        Self {
            words: words.into(),
            action,
        }
    }

    /// The map of the step, if it is one.
    #[must_use]
    pub fn map(&self) -> Option<&SpectrumMap<4>> {
        match &self.action {
            ChainAction::Map(map) => Some(map),
            _ => None,
        }
    }
}
