//! Textual descriptions of chains.

use crate::geometry::AffineMap;
use crate::light::in_words;
use crate::step::{ChainAction, ChainStep};
use crate::words;
use crate::{Chain, Operator};
use etendue_field::tidy;

impl Chain {
    /// Describes the chain as text, with one line for each step.
    #[must_use]
    pub fn describe(&self) -> Vec<String> {
        let steps = self.steps().into_iter().map(|step| step.words);
        let source = format!(
            "source  {}: {}",
            self.source.name,
            in_words(&self.source.light)
        );
        std::iter::once(source).chain(steps).collect()
    }

    /// The steps of the chain after its light.
    #[must_use]
    pub fn steps(&self) -> Vec<ChainStep> {
        self.operators.iter().map(Operator::step).collect()
    }
}

impl Operator {
    fn step(&self) -> ChainStep {
        let action = match self {
            Self::Travel { distance, .. } => {
                ChainAction::Map(AffineMap::travel(*distance).spectrum_map())
            }
            Self::Visibility { mask, .. } => ChainAction::Mask(mask.clone()),
            Self::Cosine { .. } => ChainAction::SlopeCosine,
            Self::Diffuse { .. } => ChainAction::Other,
        };
        ChainStep::new(self.describe(), action)
    }

    fn describe(&self) -> String {
        match self {
            Self::Travel { from, to, distance } => {
                let sign = if *distance < 0.0 { '−' } else { '+' };
                let (distance, size) = (tidy(*distance), tidy(distance.abs()));
                format!("map  travel {distance} m, {from} to {to}: ℓ̂(Ωx, Ωu {sign} {size} Ωx)")
            }
            Self::Visibility { name, mask } => words::mask(&format!("{name}: "), mask),
            Self::Cosine { name } => {
                format!("multiply  by the cosine at {name}: G = (1 + u² + v²)⁻²")
            }
            Self::Diffuse { name, albedo } => {
                format!(
                    "convolve  with the diffuse reflection at {name}: albedo {albedo}, constant in slope"
                )
            }
        }
    }
}
