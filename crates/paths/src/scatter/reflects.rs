//! What a surface does to light, in a word.

use etendue_field::Lobe;
use etendue_world::Distribution;

/// What a surface does to light, in a word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflects {
    /// It is black from here.
    Nothing,
    /// It sends light alike to all directions.
    Diffuse,
    /// It sends light one way.
    Mirror,
    /// It has a lobe about the mirror direction, perhaps above a diffuse base.
    Lobe(Lobe),
}

impl Reflects {
    pub(super) fn facets(distribution: Distribution, roughness: f64) -> Self {
        Self::Lobe(match distribution {
            Distribution::Beckmann => Lobe::Beckmann { roughness },
            Distribution::Ggx => Lobe::Ggx { roughness },
        })
    }
}
