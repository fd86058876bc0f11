//! The reflectance of surfaces: weighted sums of BRDFs.

use crate::{Brdf, Pattern};
use serde::Serialize;

/// The largest number of terms of a sum.
pub const MOST_TERMS: usize = 8;

/// The reflectance of a surface: a weighted sum of BRDFs (Durand et al. 2005, section 4.5), times a
/// texture.
///
/// Positions are given by (s, t), the coordinates along X and Y of the surface's
/// [`Patch`](crate::Patch), in metres.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reflectance {
    /// The BRDFs in the sum, at least one and at most [`MOST_TERMS`].
    pub terms: Vec<Term>,
    /// The texture that multiplies the sum.
    pub texture: Option<Pattern>,
}

/// A BRDF of a sum.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Term {
    /// The BRDF.
    pub brdf: Brdf,
    /// The weight of the BRDF at each position.
    pub weight: Weight,
}

/// The weight of a BRDF at each position, 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Weight {
    /// 1 everywhere.
    One,
    /// The value of a pattern.
    Pattern(Pattern),
    /// 1 minus the value of a pattern.
    Rest(Pattern),
}

impl Weight {
    /// The weight at (s, t).
    #[inline]
    #[must_use]
    pub fn value(&self, s: f64, t: f64) -> f64 {
        match self {
            Self::One => 1.0,
            Self::Pattern(pattern) => pattern.value(s, t),
            Self::Rest(pattern) => 1.0 - pattern.value(s, t),
        }
    }

    /// The pattern of the weight, if any.
    #[must_use]
    pub fn pattern(&self) -> Option<&Pattern> {
        match self {
            Self::One => None,
            Self::Pattern(pattern) | Self::Rest(pattern) => Some(pattern),
        }
    }
}

/// The sum of BRDFs at one point.
#[derive(Clone, Copy, Debug)]
pub struct Mixture<'a> {
    terms: &'a [Term],
    weights: [f64; MOST_TERMS],
}

impl<'a> Mixture<'a> {
    /// The BRDFs at the point, with their weights.
    #[inline]
    pub fn weighted(&self) -> impl Iterator<Item = (f64, &'a Brdf)> + use<'a> {
        let pairs = self.weights.into_iter().zip(self.terms);
        pairs.filter_map(|(weight, term)| (weight > 0.0).then_some((weight, &term.brdf)))
    }

    /// The sum of albedos.
    #[inline]
    #[must_use]
    pub fn albedo(&self) -> f64 {
        self.weighted()
            .map(|(weight, brdf)| weight * brdf.albedo)
            .sum()
    }
}

impl From<Brdf> for Reflectance {
    /// Builds a reflectance that is the same everywhere.
    fn from(brdf: Brdf) -> Self {
        Self {
            terms: vec![Term {
                brdf,
                weight: Weight::One,
            }],
            texture: None,
        }
    }
}

impl Reflectance {
    /// Returns w f₁ + (1 − w) f₂, where w is a pattern.
    #[must_use]
    pub fn blend(one: Brdf, zero: Brdf, pattern: Pattern) -> Self {
        let terms = vec![
            Term {
                brdf: one,
                weight: Weight::Pattern(pattern.clone()),
            },
            Term {
                brdf: zero,
                weight: Weight::Rest(pattern),
            },
        ];
        Self {
            terms,
            texture: None,
        }
    }

    /// The first BRDF of the sum, which determines whether light leaves around the mirror
    /// direction.
    #[must_use]
    pub fn first(&self) -> &Brdf {
        &self.terms[0].brdf
    }

    /// The first BRDF of the sum as a mutable reference.
    pub fn first_mut(&mut self) -> &mut Brdf {
        &mut self.terms[0].brdf
    }

    /// The BRDF if the reflectance is not a sum.
    #[must_use]
    pub fn only(&self) -> Option<&Brdf> {
        match &self.terms[..] {
            [only] => Some(&only.brdf),
            _ => None,
        }
    }

    /// The BRDFs at (s, t), with their weights multiplied by the texture.
    #[inline]
    #[must_use]
    pub fn at(&self, s: f64, t: f64) -> Mixture<'_> {
        let texture = self
            .texture
            .as_ref()
            .map_or(1.0, |texture| texture.value(s, t));
        let mut weights = [0.0; MOST_TERMS];
        for (weight, term) in weights.iter_mut().zip(&self.terms) {
            *weight = texture * term.weight.value(s, t);
        }
        Mixture {
            terms: &self.terms,
            weights,
        }
    }

    /// Checks whether the reflectance is the same everywhere.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        self.texture.is_none() && self.terms.iter().all(|term| term.weight == Weight::One)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Fresnel, Lobe};

    #[test]
    fn blends_are_sums() {
        let ggx = Brdf::new(Lobe::Ggx { roughness: 0.4 }, 0.5, Fresnel::White);
        let phong = Brdf::new(Lobe::Phong { exponent: 10.0 }, 1.0, Fresnel::White);
        let grating = crate::Grating {
            axis: 0,
            frequency: 1.0,
            modulation: 0.5,
            phase: 0.0,
        };
        let mut blend = Reflectance::blend(phong.clone(), ggx.clone(), Pattern::Cosine(grating));
        let found: Vec<_> = blend.at(0.0, 0.0).weighted().collect();
        assert_eq!(found, [(0.75, &phong), (0.25, &ggx)]);
        assert!((blend.at(0.0, 0.0).albedo() - 0.875).abs() < 1e-15); // rounding
        blend.texture = Some(Pattern::Checkerboard { period: 0.2 });
        let first: Vec<_> = blend.at(0.0, 0.0).weighted().collect();
        assert_eq!(
            first,
            [(0.75, &phong), (0.25, &ggx)],
            "the first square is 1"
        );
        assert_eq!(blend.at(0.05, -0.05).weighted().count(), 0);
        assert!(!blend.is_uniform() && Reflectance::from(ggx).is_uniform());
    }
}
