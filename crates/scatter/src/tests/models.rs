//! All models of the crate, with narrow and wide lobes, for tests.

use crate::{
    Bsdf, Coat, Conductor, DiffuseTransmission, MetallicRoughness, Microfacets, ModifiedPhong,
    Phong, Plastic, Principled, RoughDielectric, lambertian,
};
use etendue_field::{Fresnel, MicrofacetDistribution};
use etendue_sampling::chi_square::{ChiSquare, SphereCells};
use etendue_transform::random::{self, Stream};
use glam::DVec3;

/// A model of scattering at a surface.
pub(super) struct Model {
    pub(super) name: String,
    pub(super) bsdf: Box<dyn Bsdf>,
    /// The index behind the surface divided by the index in front of it.
    pub(super) index: f64,
    /// An upper bound of the share of light that leaves; 1 if energy is conserved.
    pub(super) max_flux: f64,
    /// An upper bound of the weights.
    pub(super) max_weight: f64,
}

fn model(name: String, max_weight: f64, bsdf: impl Bsdf + 'static) -> Model {
    Model {
        name,
        bsdf: Box::new(bsdf),
        index: 1.0,
        max_flux: 1.0,
        max_weight,
    }
}

pub(super) const SAMPLES: u32 = 100_000;

pub(super) fn numbers() -> impl Iterator<Item = [f64; 3]> {
    (0..u64::from(SAMPLES)).map(|index| {
        let [a, b, c, _] = random::words(5, Stream::Photon, index, 0).map(random::unit);
        [a, b, c]
    })
}

impl Model {
    /// Returns sampled directions.
    fn drawn(&self, wo: DVec3) -> impl Iterator<Item = Option<DVec3>> {
        numbers().map(move |random| self.bsdf.direction(wo, random))
    }

    /// Returns cells about the mirror direction of wo.
    pub(super) fn cells(&self, wo: DVec3) -> SphereCells {
        SphereCells::new(DVec3::new(-wo.x, -wo.y, wo.z), self.drawn(wo).flatten())
    }

    /// Compares the model's samples with a density.
    pub(super) fn compare(&self, wo: DVec3, density: impl Fn(DVec3) -> f64) -> ChiSquare {
        self.cells(wo).compare(self.drawn(wo), density)
    }
}

/// A lobe given by its functions.
struct Lobe<V, S, D>(V, S, D);

impl<V, S, D> Bsdf for Lobe<V, S, D>
where
    V: Fn(DVec3, DVec3) -> f64,
    S: Fn(DVec3, [f64; 2]) -> DVec3,
    D: Fn(DVec3, DVec3) -> f64,
{
    fn value(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z > 0.0 { self.0(wi, wo) } else { 0.0 }
    }

    fn density(&self, wi: DVec3, wo: DVec3) -> f64 {
        self.2(wi, wo)
    }

    fn direction(&self, wo: DVec3, [a, b, _]: [f64; 3]) -> Option<DVec3> {
        Some(self.1(wo, [a, b]))
    }
}

/// The largest weight for sampling by visible normals. For GGX, this weight is Smith's
/// masking of one direction, plus rounding error. Beckmann's normals are sampled by GGX, so the
/// weight of Beckmann's facets is larger by the ratios of D, 4/e, and of G₁, √π.
fn masked(facets: Microfacets) -> f64 {
    match facets.distribution {
        MicrofacetDistribution::Beckmann => 2.61,
        MicrofacetDistribution::Ggx => 1.0 + 1e-9,
    }
}

fn lambert() -> Model {
    let value = |_, _| lambertian::VALUE;
    let sample = |_, random| lambertian::sample(random);
    let density = |wi, _| lambertian::density(wi);
    model(
        "Lambertian".to_owned(),
        1.0 + 1e-9,
        Lobe(value, sample, density),
    )
}

pub(super) fn phong(exponent: f64) -> Model {
    let lobe = Phong { exponent };
    let value = move |wi, wo| lobe.value(wi, wo);
    let sample = move |wo, random| lobe.sample(wo, random);
    model(format!("{lobe:?}"), 1.0 + 1e-9, Lobe(value, sample, value))
}

/// Perfect mirrors, whose normals are sampled whether they are visible or not.
fn unmasked(facets: Microfacets) -> Model {
    let value = move |wi, wo| facets.value(wi, wo).0;
    let sample = move |wo, random| facets.sample_unmasked(wo, random);
    let density = move |wi, wo| facets.unmasked_density(wi, wo);
    // The weight is h·ωi/(cos θi cos θh) times G₁ ≤ 2√π/(α tan θi), so it is at most 3.5 tan θh/α;
    // with 32-bit random numbers, tan θh/α is at most 4.8.
    model(
        format!("{facets:?}, unmasked"),
        17.0,
        Lobe(value, sample, density),
    )
}

pub(super) fn conductor(facets: Microfacets, fresnel: Fresnel) -> Model {
    let metal = Conductor { facets, fresnel };
    model(format!("{metal:?}"), masked(facets), metal)
}

pub(super) fn modified_phong(diffuse: f64, specular: f64, exponent: f64) -> Model {
    let phong = ModifiedPhong {
        diffuse,
        specular,
        lobe: Phong { exponent },
    };
    // The weight of the cosine is at most kd divided by its share. For the lobe, the ratio is
    // larger by (n + 2)/(n + 1).
    let bound = (diffuse + specular) * (exponent + 2.0) / (exponent + 1.0) + 1e-9;
    model(format!("{phong:?}"), bound, phong)
}

pub(super) fn dielectric(facets: Microfacets, index: f64) -> Model {
    let glass = RoughDielectric { facets, index };
    let bound = masked(facets) * (1.0_f64).max(1.0 / (index * index));
    Model {
        index,
        ..model(format!("{glass:?}"), bound, glass)
    }
}

pub(super) fn plastic(facets: Option<Microfacets>, is_nonlinear: bool) -> Model {
    let plastic = Plastic {
        coat: Box::leak(Box::new(Coat::new(1.5, facets))),
        diffuse: 1.0,
        specular: 1.0,
        is_nonlinear,
    };
    let name = format!("plastic of {facets:?}, nonlinear: {is_nonlinear}");
    // A sample of the coat or of the base is weighted by the light of this layer, divided by the
    // layer's share of the samples. This share approximates the layer's share of the light.
    model(name, 4.0, plastic)
}

fn metallic_roughness(facets: Option<Microfacets>, color: f64, metallic: f64) -> Model {
    let mixture = MetallicRoughness {
        facets,
        color,
        metallic,
        coat: [0.04, 1.0],
    };
    // The facets sample at least a tenth of the directions. Base and coat share light by the angle
    // to the half vector, so that each may reflect all light that arrives at grazing angles.
    Model {
        max_flux: 2.0,
        ..model(format!("{mixture:?}"), 10.0, mixture)
    }
}

/// A mixture with all lobes.
pub(super) const MIXTURE: Principled = Principled {
    facets: Microfacets {
        distribution: MicrofacetDistribution::Ggx,
        alpha: [0.16, 0.16],
    },
    index: 1.5,
    color: 0.7,
    metallic: 0.0,
    transmission: 0.0,
    roughness: 0.4,
    tint: 0.5,
    flatness: 0.3,
    sheen: 0.4,
    clearcoat: 0.8,
    coat_alpha: 0.05,
};

pub(super) fn principled(mixture: Principled) -> Model {
    // The facets sample at least a tenth of the directions, and the clear coat is sampled in
    // proportion to D without masking.
    let index = match mixture.transmission > 0.0 {
        true => mixture.index,
        false => 1.0,
    };
    Model {
        index,
        ..model(format!("{mixture:?}"), 10.0, mixture)
    }
}

pub(super) fn beckmann(alpha: [f64; 2]) -> Microfacets {
    Microfacets {
        distribution: MicrofacetDistribution::Beckmann,
        alpha,
    }
}

pub(super) fn ggx(alpha: [f64; 2]) -> Microfacets {
    Microfacets {
        distribution: MicrofacetDistribution::Ggx,
        alpha,
    }
}

/// Returns mixtures with different lobes, and the inside of one.
fn mixtures() -> Vec<Model> {
    let fronts = [
        MIXTURE,
        Principled {
            facets: ggx([0.49, 0.49]),
            color: 0.5,
            metallic: 0.5,
            roughness: 0.7,
            ..MIXTURE
        },
        Principled {
            facets: ggx([0.09, 0.09]),
            color: 0.9,
            metallic: 1.0,
            roughness: 0.3,
            ..MIXTURE
        },
        Principled {
            transmission: 0.6,
            ..MIXTURE
        },
        Principled {
            facets: ggx([0.3, 0.1]),
            color: 1.0,
            transmission: 1.0,
            tint: 0.0,
            sheen: 0.0,
            clearcoat: 0.0,
            ..MIXTURE
        },
        // Only the clear coat reflects light from near the normal.
        Principled {
            index: 1.0,
            color: 0.0,
            sheen: 0.0,
            clearcoat: 1.0,
            ..MIXTURE
        },
    ];
    let glass = Principled {
        transmission: 0.7,
        metallic: 0.2,
        ..MIXTURE
    };
    let name = format!("inside of {glass:?}");
    let inside = Model {
        index: 1.0 / glass.index,
        ..model(name, 10.0, glass.inside())
    };
    let mut models: Vec<Model> = fronts.map(principled).into();
    models.push(inside);
    models
}

/// All models.
pub(super) fn all() -> Vec<Model> {
    let mut models = vec![
        lambert(),
        modified_phong(0.3, 0.5, 20.0),
        modified_phong(0.0, 1.0, 3.0),
        plastic(None, true),
        plastic(Some(ggx([0.2, 0.2])), true),
        plastic(Some(beckmann([0.4, 0.3])), false),
        dielectric(ggx([0.3, 0.3]), 1.5),
        dielectric(ggx([0.3, 0.1]), 1.0 / 1.5),
        dielectric(beckmann([0.5, 0.2]), 1.3),
        conductor(ggx([0.2, 0.2]), Fresnel::Conductor { n: 0.2, k: 3.9 }),
    ];
    let translucent = DiffuseTransmission {
        reflectance: 0.2,
        transmittance: 0.5,
    };
    models.push(model(format!("{translucent:?}"), 0.7 + 1e-9, translucent));
    models.extend([
        metallic_roughness(None, 0.8, 0.0),
        metallic_roughness(Some(ggx([0.04, 0.04])), 1.0, 0.0),
        metallic_roughness(Some(ggx([1.0, 1.0])), 0.6, 0.3),
        metallic_roughness(Some(ggx([0.3, 0.3])), 0.5, 1.0),
    ]);
    models.extend(mixtures());
    models.extend([0.0, 1.0, 30.0, 1e4].map(phong));
    let isotropic = [0.01, 0.1, 0.5, 1.0].map(|alpha| [alpha, alpha]);
    for alpha in isotropic.into_iter().chain([[0.3, 0.1], [0.2, 0.7]]) {
        models.extend([beckmann, ggx].map(|of| conductor(of(alpha), Fresnel::White)));
        models.push(unmasked(beckmann(alpha)));
    }
    models
}
