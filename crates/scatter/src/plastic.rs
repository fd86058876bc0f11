//! Defines a diffuse base below a smooth or rough dielectric coat.

use crate::bsdf::{before, mirrored};
use crate::fresnel::{Interface, diffuse_reflectance};
use crate::{Bsdf, BsdfSample, Microfacets, lambertian};
use etendue_field::MicrofacetDistribution;
use glam::DVec3;

/// Number of steps in the table of a rough coat.
const STEPS: usize = 64;

/// A coat, prepared with its transmittance.
#[derive(Clone, Debug)]
pub struct Coat {
    index: f64,
    facets: Option<Microfacets>,
    /// The internal reflectance of the coat for light from the base.
    within: f64,
    /// The transmittance of a rough coat. The roots of the cosines are 0 to 1 in equal steps,
    /// because the transmittance of a nearly smooth coat changes quickly at grazing angles.
    through: Vec<f64>,
}

impl Coat {
    /// A coat with this index relative to the outside; a smooth coat has no facets.
    #[must_use]
    pub fn new(index: f64, facets: Option<Microfacets>) -> Self {
        let through = facets.map(|facets| {
            let root = |i: usize| i as f64 / STEPS as f64;
            let at = |i: usize| transmitted(&facets, index, root(i).powi(2).max(1e-5));
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

    /// The coat's microfacets; `None` if it is smooth.
    #[must_use]
    pub fn facets(&self) -> Option<&Microfacets> {
        self.facets.as_ref()
    }

    /// The transmittance at an angle of this cosine.
    #[inline]
    fn through(&self, cosine: f64) -> f64 {
        if self.facets.is_none() {
            return 1.0 - Interface::new(self.index, cosine).reflected;
        }
        let at = cosine.clamp(0.0, 1.0).sqrt() * STEPS as f64;
        let first = at.floor().min(STEPS as f64 - 1.0);
        let i = etendue_field::whole(first);
        let share = at - first;
        self.through[i] * (1.0 - share) + self.through[i + 1] * share
    }
}

/// A base and a coat at one point. All directions are in front of the surface.
#[derive(Clone, Copy, Debug)]
pub struct Plastic<'a> {
    /// The coat.
    pub coat: &'a Coat,
    /// Albedo of the base.
    pub diffuse: f64,
    /// A factor on the reflection by the coat.
    pub specular: f64,
    /// Whether each internal reflection is multiplied by the albedo of the base again.
    pub is_nonlinear: bool,
}

impl Plastic<'_> {
    /// The contribution of the base to the BRDF, with both directions in front of the
    /// surface.
    #[inline]
    #[must_use]
    pub fn base_value(&self, wi: DVec3, wo: DVec3) -> f64 {
        let through = self.coat.through(wi.z) * self.coat.through(wo.z);
        self.base_albedo() * through / (self.coat.index * self.coat.index) * lambertian::VALUE
    }

    /// The share of the light reaching the base that the base reflects. Repeated
    /// reflections by the coat are included.
    #[inline]
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

    /// The share of directions that are sampled by the coat: approximately its share of the
    /// light.
    #[inline]
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
    #[inline]
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

    #[inline]
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

    #[inline]
    fn direction(&self, wo: DVec3, [a, b, c]: [f64; 3]) -> Option<DVec3> {
        if c < self.coat_share(wo) {
            before(self.coat.facets?.sample(wo, [a, b]))
        } else {
            Some(lambertian::sample([a, b]))
        }
    }

    #[inline]
    fn mirrored(&self, wo: DVec3, c: f64) -> Option<BsdfSample> {
        // A smooth coat gets its share of the samples, and the base gets the remaining samples.
        let share = self.coat_share(wo);
        (self.coat.facets.is_none() && c < share).then(|| {
            let reflected = Interface::new(self.coat.index, wo.z).reflected;
            BsdfSample::only(mirrored(wo, DVec3::Z), reflected * self.specular / share)
        })
    }
}

/// The transmittance of a rough interface at an angle of this cosine.
fn transmitted(facets: &Microfacets, index: f64, cosine: f64) -> f64 {
    /// Numbers of the inclinations and of the azimuths of normals.
    const INCLINATIONS: usize = 128;
    const AZIMUTHS: usize = 32;
    let wo = at_cosine(cosine);
    let middle = |i: usize, count: usize| (i as f64 + 0.5) / count as f64;
    let one = |i: usize| {
        let numbers = [
            middle(i / AZIMUTHS, INCLINATIONS),
            middle(i % AZIMUTHS, AZIMUTHS),
        ];
        let (normal, weight) = visible_normal(facets, wo, numbers);
        let at = Interface::new(index, wo.dot(normal));
        let wi = at.refracted(wo, normal);
        let masking = if wi.z < 0.0 { facets.g1(wi) } else { 0.0 };
        weight * (1.0 - at.reflected) * masking
    };
    (0..INCLINATIONS * AZIMUTHS).map(one).sum::<f64>() / (INCLINATIONS * AZIMUTHS) as f64
}

/// The reflectance of a rough interface for uniform light from all directions.
fn rough_reflectance(facets: &Microfacets, index: f64) -> f64 {
    /// Number of pairs of a direction and a normal.
    const COUNT: usize = 1 << 17;
    /// The steps of a sequence that fills the unit square evenly: 1/g and 1/g², where g³ = g + 1.
    const SEQUENCE: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    let one = |i: usize| {
        let cosine = ((i as f64 + 0.5) / COUNT as f64).sqrt();
        let wo = at_cosine(cosine);
        let numbers = SEQUENCE.map(|step| (i as f64 * step + 0.5).fract());
        let (normal, weight) = visible_normal(facets, wo, numbers);
        let wi = mirrored(wo, normal);
        let masking = if wi.z > 0.0 { facets.g1(wi) } else { 0.0 };
        weight * Interface::new(index, wo.dot(normal)).reflected * masking
    };
    (0..COUNT).map(one).sum::<f64>() / COUNT as f64
}

fn at_cosine(cosine: f64) -> DVec3 {
    DVec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine)
}

/// A normal for two numbers in 0 to 1, with a weight. The mean of a function over the
/// normals visible from wo is the mean of weight times function over the unit square.
fn visible_normal(facets: &Microfacets, wo: DVec3, [a, b]: [f64; 2]) -> (DVec3, f64) {
    // Steep normals are few but matter, so 1 − (1 − a)³ is dense near 1.
    let left = 1.0 - a;
    let normal = facets.sample_normal(wo, [1.0 - left.powi(3), b]);
    let ggx = Microfacets {
        distribution: MicrofacetDistribution::Ggx,
        ..*facets
    };
    // Normals are sampled by GGX.
    let share = facets.g1(wo) * facets.d(normal) / (ggx.g1(wo) * ggx.d(normal));
    (normal, 3.0 * left * left * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The means of a smooth and of a rough interface agree as roughness goes to zero.
    #[test]
    fn a_nearly_smooth_coat_is_a_smooth_one() {
        let facets = Microfacets::isotropic(MicrofacetDistribution::Ggx, 0.002);
        for cosine in [0.3, 0.6, 1.0] {
            let smooth = 1.0 - Interface::new(1.5, cosine).reflected;
            // Roughness changes angles by about 0.002.
            assert!(
                (transmitted(&facets, 1.5, cosine) - smooth).abs() < 0.004,
                "{cosine}"
            );
        }
        assert!(
            (rough_reflectance(&facets, 1.0 / 1.5) - diffuse_reflectance(1.0 / 1.5)).abs() < 0.01
        );
    }

    /// Transmittance and reflectance are those of Gauss–Legendre rules with 256 × 256 nodes, and
    /// the table is nearly as exact between its steps.
    #[test]
    fn a_rough_coat_transmits_as_an_exact_rule_says() {
        let ggx = |alpha| Microfacets::isotropic(MicrofacetDistribution::Ggx, alpha);
        let index = 1.49 / 1.000_277;
        for (cosine, exact) in [(0.1, 0.7149), (0.5, 0.88777), (1.0, 0.95417)] {
            let found = transmitted(&ggx(0.3), index, cosine);
            assert!((found - exact).abs() < 3e-5, "{cosine}: {found}"); // the error of the rule
        }
        for (alpha, exact) in [(0.0328, 0.58432), (0.3, 0.41461)] {
            let found = rough_reflectance(&ggx(alpha), 1.0 / index);
            assert!((found - exact).abs() < 6e-5, "{alpha}: {found}"); // the error of the sequence
        }
        let coat = Coat::new(index, Some(ggx(0.02)));
        for cosine in [0.0075, 0.018, 0.06, 0.3] {
            let exact = transmitted(&ggx(0.02), index, cosine);
            let found = coat.through(cosine);
            assert!((found / exact - 1.0).abs() < 3e-3, "{cosine}: {found}"); // curvature
        }
    }
}
