//! A diffuse base below a dielectric coat, smooth or rough.

use crate::bsdf::{before, mirrored};
use crate::fresnel::{Interface, diffuse_reflectance};
use crate::{Bsdf, BsdfSample, Microfacets, lambertian};
use etendue_field::MicrofacetDistribution;
use glam::DVec3;

/// Steps of the cosine in the table of a rough coat.
const STEPS: usize = 64;

/// A coat, with what goes through it.
#[derive(Clone, Debug)]
pub struct Coat {
    index: f64,
    facets: Option<Microfacets>,
    /// What it reflects of the base's light.
    within: f64,
    /// What goes through a rough coat, at cosines 0 to 1 in equal steps.
    through: Vec<f64>,
}

impl Coat {
    /// A coat with this index over that outside; a smooth one has no facets.
    #[must_use]
    pub fn new(index: f64, facets: Option<Microfacets>) -> Self {
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
            facets,
            within,
            through: through.unwrap_or_default(),
        }
    }

    /// Its facets; `None` where it is a mirror.
    #[must_use]
    pub fn facets(&self) -> Option<&Microfacets> {
        self.facets.as_ref()
    }

    /// What goes through at an angle of this cosine.
    fn through(&self, cosine: f64) -> f64 {
        if self.facets.is_none() {
            return 1.0 - Interface::new(self.index, cosine).reflected;
        }
        let at = cosine.clamp(0.0, 1.0) * STEPS as f64;
        let first = at.floor().min(STEPS as f64 - 1.0);
        let i = etendue_field::whole(first);
        let share = at - first;
        self.through[i] * (1.0 - share) + self.through[i + 1] * share
    }
}

/// A base and a coat at one place. All directions are before the surface.
#[derive(Clone, Copy, Debug)]
pub struct Plastic<'a> {
    /// The coat.
    pub coat: &'a Coat,
    /// Albedo of the base.
    pub diffuse: f64,
    /// A factor on what the coat reflects.
    pub specular: f64,
    /// Whether each reflection within takes the albedo of the base once more.
    pub is_nonlinear: bool,
}

impl Plastic<'_> {
    /// The part of the base in the BRDF, both directions being before the surface.
    #[must_use]
    pub fn base_value(&self, wi: DVec3, wo: DVec3) -> f64 {
        let through = self.coat.through(wi.z) * self.coat.through(wo.z);
        self.base_albedo() * through / (self.coat.index * self.coat.index) * lambertian::VALUE
    }

    /// What the base reflects of light that has come to it, and back from the coat again and again.
    #[must_use]
    pub fn base_albedo(&self) -> f64 {
        let within = self.coat.within;
        let again = if self.is_nonlinear {
            self.diffuse * within
        } else {
            within
        };
        self.diffuse / (1.0 - again)
    }

    /// The share of directions that the coat draws: about its share of the light.
    fn coat_share(&self, wo: DVec3) -> f64 {
        let through = self.coat.through(wo.z);
        let coat = (1.0 - through) * self.specular;
        let base = through * self.diffuse;
        if coat + base > 0.0 {
            coat / (coat + base)
        } else {
            0.5
        }
    }
}

impl Bsdf for Plastic<'_> {
    fn value(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let coat = self.coat.facets.map_or(0.0, |facets| {
            let (value, cosine) = facets.value(wi, wo);
            value * Interface::new(self.coat.index, cosine).reflected * self.specular
        });
        coat + self.base_value(wi, wo)
    }

    fn density(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let share = self.coat_share(wo);
        let coat = self
            .coat
            .facets
            .map_or(0.0, |facets| facets.density(wi, wo));
        share * coat + (1.0 - share) * lambertian::density(wi)
    }

    fn direction(&self, wo: DVec3, [a, b, c]: [f64; 3]) -> Option<DVec3> {
        if c < self.coat_share(wo) {
            before(self.coat.facets?.sample(wo, [a, b]))
        } else {
            Some(lambertian::sample([a, b]))
        }
    }

    fn mirrored(&self, wo: DVec3, c: f64) -> Option<BsdfSample> {
        // A smooth coat takes its share of samples; the rest of the density is the base's.
        let share = self.coat_share(wo);
        (self.coat.facets.is_none() && c < share).then(|| {
            let reflected = Interface::new(self.coat.index, wo.z).reflected;
            BsdfSample::only(mirrored(wo, DVec3::Z), reflected * self.specular / share)
        })
    }
}

/// What goes through a rough interface to the other side, seen at an angle of this cosine.
fn transmitted(facets: &Microfacets, index: f64, cosine: f64) -> f64 {
    mean_over_normals(facets, cosine, |wo, normal| {
        let at = Interface::new(index, wo.dot(normal));
        let wi = at.refracted(wo, normal);
        let masking = if wi.z < 0.0 { facets.g1(wi) } else { 0.0 };
        (1.0 - at.reflected) * masking
    })
}

/// What a rough interface reflects of light that arrives evenly from all directions.
fn rough_reflectance(facets: &Microfacets, index: f64) -> f64 {
    let at = |i: usize| {
        let cosine = ((i as f64 + 0.5) / STEPS as f64).sqrt();
        mean_over_normals(facets, cosine, |wo, normal| {
            let wi = mirrored(wo, normal);
            let masking = if wi.z > 0.0 { facets.g1(wi) } else { 0.0 };
            Interface::new(index, wo.dot(normal)).reflected * masking
        })
    };
    (0..STEPS).map(at).sum::<f64>() / STEPS as f64
}

/// The mean of something over the normals that a direction sees.
fn mean_over_normals(facets: &Microfacets, cosine: f64, of: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    /// Normals along a side of the square of random numbers.
    const SIDE: usize = 64;
    let wo = DVec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
    let ggx = Microfacets {
        distribution: MicrofacetDistribution::Ggx,
        ..*facets
    };
    let middle = |i: usize| (i as f64 + 0.5) / SIDE as f64;
    let one = |i: usize| {
        let normal = facets.sample_normal(wo, [middle(i / SIDE), middle(i % SIDE)]);
        // Normals are drawn by GGX.
        let visible = facets.g1(wo) * facets.d(normal);
        of(wo, normal) * visible / (ggx.g1(wo) * ggx.d(normal))
    };
    (0..SIDE * SIDE).map(one).sum::<f64>() / (SIDE * SIDE) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The means of a smooth interface and of a rough one agree where roughness goes to zero.
    #[test]
    fn a_nearly_smooth_coat_is_a_smooth_one() {
        let facets = Microfacets::isotropic(MicrofacetDistribution::Ggx, 0.002);
        for cosine in [0.3, 0.6, 1.0] {
            let smooth = 1.0 - Interface::new(1.5, cosine).reflected;
            // Roughness moves angles by some 0.002.
            assert!(
                (transmitted(&facets, 1.5, cosine) - smooth).abs() < 0.004,
                "{cosine}"
            );
        }
        assert!(
            (rough_reflectance(&facets, 1.0 / 1.5) - diffuse_reflectance(1.0 / 1.5)).abs() < 0.01
        );
    }
}
