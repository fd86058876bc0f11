//! A diffuse base below a dielectric coat.

use super::bounce::{Bounce, by_cosine, cosine_density};
use super::fresnel::{dielectric, diffuse_reflectance};
use super::microfacet::Microfacets;
use super::reflects::Reflects;
use etendue_world::{Distribution, Plastic, Texture};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// A diffuse base below a dielectric coat.
#[derive(Clone, Debug)]
pub(crate) struct Coated {
    index: f64,
    diffuse: Texture,
    specular: Texture,
    is_nonlinear: bool,
    facets: Option<Microfacets>,
    /// What the coat reflects of the base's light.
    within: f64,
    /// What goes through a rough coat, at cosines 0 to 1 in equal steps.
    through: Vec<f64>,
}

/// Steps of [`Coated::through`].
const STEPS: usize = 64;

impl Coated {
    pub(super) fn new(plastic: &Plastic) -> Self {
        let facets = plastic.roughness.as_ref().map(|roughness| Microfacets {
            distribution: roughness.distribution,
            alpha: [0, 1].map(|i| roughness.alpha[i].value(DVec2::ZERO).max(1e-4)),
        });
        let index = plastic.index;
        let through = facets.map(|facets| {
            let at = |i: usize| transmitted(&facets, index, (i as f64 / STEPS as f64).max(1e-4));
            (0..=STEPS).map(at).collect()
        });
        let within = match &facets {
            None => diffuse_reflectance(1.0 / index),
            Some(facets) => rough_reflectance(facets, 1.0 / index),
        };
        Self {
            index,
            diffuse: plastic.diffuse.clone(),
            specular: plastic.specular.clone(),
            is_nonlinear: plastic.is_nonlinear,
            facets,
            within,
            through: through.unwrap_or_default(),
        }
    }

    /// What its coat does, in a word.
    pub(super) fn kind(&self) -> Reflects {
        self.facets.map_or(Reflects::Mirror, |facets| {
            Reflects::facets(facets.distribution, facets.alpha[0])
        })
    }

    /// Whether its coat is a mirror.
    pub(super) fn is_smooth(&self) -> bool {
        self.facets.is_none()
    }

    /// What goes through the coat at an angle.
    fn through(&self, cosine: f64) -> f64 {
        if self.facets.is_none() {
            return 1.0 - dielectric(self.index, cosine).reflected;
        }
        let at = cosine.clamp(0.0, 1.0) * STEPS as f64;
        let step = [0.0, STEPS as f64 - 1.0];
        let first = at.floor().clamp(step[0], step[1]);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 to STEPS − 1"
        )]
        let i = first as usize;
        let share = at - first;
        self.through[i] * (1.0 - share) + self.through[i + 1] * share
    }

    /// What the base scatters, times the cosine of wi.
    fn base(&self, uv: DVec2, wi: DVec3, wo: DVec3) -> f64 {
        let through = self.through(wi.z) * self.through(wo.z) / (self.index * self.index);
        self.albedo(uv) * through * wi.z / PI
    }

    /// What the base reflects of light that has come to it, and back from the coat again and again.
    fn albedo(&self, uv: DVec2) -> f64 {
        let diffuse = self.diffuse.value(uv);
        let again = if self.is_nonlinear {
            diffuse * self.within
        } else {
            self.within
        };
        diffuse / (1.0 - again)
    }

    /// Those of base and coat.
    pub(super) fn factors(&self, uv: DVec2) -> [f64; 2] {
        [self.albedo(uv), self.specular.value(uv)]
    }

    /// The share of the base in what leaves; of light in the mirror direction of a smooth coat none is the base's, but for what has no size.
    pub(super) fn base_share(&self, uv: DVec2, wi: DVec3, wo: DVec3) -> f64 {
        let is_mirrored = (wi + wo).truncate().length_squared() < 1e-24;
        if self.facets.is_none() && is_mirrored {
            return 0.0;
        }
        let value = self.value(uv, wi, wo);
        if value > 0.0 {
            self.base(uv, wi, wo) / value
        } else {
            0.0
        }
    }

    /// The share of samples that the coat gets.
    fn coat_share(&self, uv: DVec2, wo: DVec3) -> f64 {
        let through = self.through(wo.z);
        let coat = (1.0 - through) * self.specular.value(uv);
        let base = through * self.diffuse.value(uv);
        if coat + base > 0.0 {
            coat / (coat + base)
        } else {
            0.5
        }
    }

    /// BSDF times the cosine of wi, both directions being in front; a smooth coat's reflection left out.
    pub(super) fn value(&self, uv: DVec2, wi: DVec3, wo: DVec3) -> f64 {
        let coat = self.facets.map_or(0.0, |facets| {
            let (value, normal) = facets.reflected(wi, wo);
            value * dielectric(self.index, wo.dot(normal)).reflected * self.specular.value(uv)
        });
        coat + self.base(uv, wi, wo)
    }

    pub(super) fn density(&self, uv: DVec2, wi: DVec3, wo: DVec3) -> f64 {
        let share = self.coat_share(uv, wo);
        let coat = self
            .facets
            .map_or(0.0, |facets| facets.reflected_density(wi, wo));
        share * coat + (1.0 - share) * cosine_density(wi)
    }

    pub(super) fn sample(&self, uv: DVec2, wo: DVec3, [a, b, c]: [f64; 3]) -> Option<Bounce> {
        let share = self.coat_share(uv, wo);
        let wi = match (&self.facets, c < share) {
            (None, true) => {
                let wi = DVec3::new(-wo.x, -wo.y, wo.z);
                let reflected = dielectric(self.index, wo.z).reflected;
                let weight = reflected * self.specular.value(uv) / share;
                return Some(Bounce {
                    wi,
                    weight,
                    density: None,
                });
            }
            (Some(facets), true) => facets.reflect(wo, [a, b]),
            (_, false) => by_cosine([a, b]),
        };
        if wi.z <= 0.0 {
            return None;
        }
        let density = self.density(uv, wi, wo);
        let weight = self.value(uv, wi, wo) / density;
        // A smooth coat takes its share of samples; the rest of the density is the base's.
        Some(Bounce {
            wi,
            weight,
            density: Some(density),
        })
    }
}

/// What goes through a rough interface to the other side, seen at an angle of this cosine.
fn transmitted(facets: &Microfacets, index: f64, cosine: f64) -> f64 {
    averaged(facets, cosine, |wo, normal| {
        let at = dielectric(index, wo.dot(normal));
        let wi = at.refracted(wo, normal);
        let shadowing = if wi.z < 0.0 { facets.seen(wi) } else { 0.0 };
        (1.0 - at.reflected) * shadowing
    })
}

/// What a rough interface reflects of light that arrives evenly from all directions.
fn rough_reflectance(facets: &Microfacets, index: f64) -> f64 {
    let at = |i: usize| {
        let cosine = ((i as f64 + 0.5) / STEPS as f64).sqrt();
        averaged(facets, cosine, |wo, normal| {
            let wi = super::bounce::mirrored(wo, normal);
            let shadowing = if wi.z > 0.0 { facets.seen(wi) } else { 0.0 };
            dielectric(index, wo.dot(normal)).reflected * shadowing
        })
    };
    (0..STEPS).map(at).sum::<f64>() / STEPS as f64
}

/// The mean of something over the normals that a direction sees.
fn averaged(facets: &Microfacets, cosine: f64, of: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    const SIDE: usize = 64;
    let wo = DVec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
    let ggx = Microfacets {
        distribution: Distribution::Ggx,
        ..*facets
    };
    let middle = |i: usize| (i as f64 + 0.5) / SIDE as f64;
    let one = |i: usize| {
        let normal = facets.normal(wo, [middle(i / SIDE), middle(i % SIDE)]);
        // Normals are drawn by GGX.
        let seen = facets.seen(wo) * facets.normals(normal);
        of(wo, normal) * seen / (ggx.seen(wo) * ggx.normals(normal))
    };
    (0..SIDE * SIDE).map(one).sum::<f64>() / (SIDE * SIDE) as f64
}

/// The mean over directions of a smooth interface and a rough one agree where roughness goes to zero.
#[cfg(test)]
mod tests {
    use super::super::fresnel::mean;
    use super::*;

    #[test]
    fn a_nearly_smooth_coat_is_a_smooth_one() {
        let facets = Microfacets {
            distribution: Distribution::Ggx,
            alpha: [0.002; 2],
        };
        for cosine in [0.3, 0.6, 1.0] {
            let smooth = 1.0 - dielectric(1.5, cosine).reflected;
            // Roughness moves angles by some 0.002.
            assert!(
                (transmitted(&facets, 1.5, cosine) - smooth).abs() < 0.004,
                "{cosine}"
            );
        }
        // Egan and Hilgeman 1973: 0.0918 and 0.5963 for an index of 1.5.
        assert!((mean(|c| dielectric(1.5, c).reflected) - 0.0918).abs() < 1e-4);
        assert!((diffuse_reflectance(1.0 / 1.5) - 0.5963).abs() < 1e-4);
        assert!((rough_reflectance(&facets, 1.0 / 1.5) - 0.5963).abs() < 0.01);
    }
}
