//! Computes scattering at surfaces for paths that are traced back from a camera, from the leaving
//! direction `wo` to the incident direction `wi`.
//!
//! Directions are unit vectors away from the surface, in a frame with its normal along Z. Values
//! are BSDFs for radiance, times |cos| of wi. Radiance is divided by the squared index of its
//! medium. This quotient does not change where light is refracted.

mod place;

use etendue_field::Lobe;
pub(crate) use etendue_scatter::BsdfSample;
use etendue_scatter::{Bsdf, Microfacets, lambertian, mirror};
use etendue_world::{self as world, Material, Roughness, Texture, TexturePoint};
use glam::DVec3;
pub use place::Reflects;
use place::{
    Coated, conductor, diffuse_transmission, factor, fresnel, is_mirrored, metallic_roughness,
    phong, principled, rough_dielectric, share, smooth_dielectric, to_front,
};

/// A material that is prepared for scattering.
#[derive(Clone, Debug)]
pub(crate) enum Scatter {
    Diffuse(Texture),
    DiffuseTransmission([Texture; 2]),
    Conductor(world::Conductor),
    Dielectric(world::Dielectric),
    Plastic(Box<Coated>),
    MetallicRoughness(Box<world::MetallicRoughness>),
    Principled(Box<world::Principled>),
    Phong([Texture; 3]),
    TwoSided(Box<[Self; 2]>),
    Mask(Texture, Box<Self>),
    Blend(Texture, Box<[Self; 2]>),
}

impl From<&Material> for Scatter {
    fn from(material: &Material) -> Self {
        let both = |of: &[Material; 2]| Box::new([Self::from(&of[0]), Self::from(&of[1])]);
        match material {
            Material::Diffuse { reflectance } => Self::Diffuse(reflectance.clone()),
            Material::DiffuseTransmission {
                reflectance,
                transmittance,
            } => Self::DiffuseTransmission([reflectance.clone(), transmittance.clone()]),
            Material::Conductor(conductor) => Self::Conductor(conductor.clone()),
            Material::Dielectric(dielectric) => Self::Dielectric(dielectric.clone()),
            Material::Plastic(plastic) => Self::Plastic(Box::new(Coated::new(plastic))),
            Material::MetallicRoughness(of) => Self::MetallicRoughness(of.clone()),
            Material::Principled(principled) => Self::Principled(principled.clone()),
            Material::Phong {
                diffuse,
                specular,
                exponent,
            } => Self::Phong([diffuse.clone(), specular.clone(), exponent.clone()]),
            Material::TwoSided(of) => Self::TwoSided(both(of)),
            Material::Mask { opacity, of } => Self::Mask(opacity.clone(), Box::new((&**of).into())),
            Material::Blend { weight, of } => Self::Blend(weight.clone(), both(of)),
        }
    }
}

impl Scatter {
    /// The BSDF times |cos| of wi, and the density of [`Self::sample`] per solid angle,
    /// both without delta components such as mirrors.
    pub(crate) fn value_and_density(
        &self,
        point: &TexturePoint,
        wi: DVec3,
        wo: DVec3,
    ) -> (f64, f64) {
        let is_front = wi.z > 0.0 && wo.z > 0.0;
        match self {
            Self::TwoSided(sides) => {
                let (side, turned) = side_of(sides, wo);
                side.value_and_density(point, turned(wi), turned(wo))
            }
            Self::Mask(_, of) => of.value_and_density(point, wi, wo),
            Self::Blend(weight, of) => {
                let share = second_share(weight, of, point);
                let [a, b] = of.each_ref().map(|of| of.value_and_density(point, wi, wo));
                let mix = |a: f64, b: f64| (1.0 - share) * a + share * b;
                (mix(a.0, b.0), mix(a.1, b.1))
            }
            Self::Dielectric(of) => rough_dielectric(of, point, wo).map_or((0.0, 0.0), |rough| {
                let (value, density) = both(&rough, wi, wo);
                (factor(of, point, to_front(wo)(wi)) * value, density)
            }),
            Self::Principled(of) => {
                let front = principled(of, point);
                match wo.z > 0.0 {
                    true => both(&front, wi, wo),
                    false => both(&front.inside(), wi, wo),
                }
            }
            Self::DiffuseTransmission(of) => both(&diffuse_transmission(of, point), wi, wo),
            _ if !is_front => (0.0, 0.0),
            Self::Diffuse(reflectance) => {
                let density = lambertian::density(wi);
                (reflectance.value(point) * density, density)
            }
            Self::Conductor(of) => conductor(of, point).map_or((0.0, 0.0), |rough| {
                let (value, density) = both(&rough, wi, wo);
                (of.reflectance.value(point) * value, density)
            }),
            Self::Plastic(of) => both(&of.at(point), wi, wo),
            Self::MetallicRoughness(of) => both(&metallic_roughness(of, point), wi, wo),
            Self::Phong(of) => both(&phong(of, point), wi, wo),
        }
    }

    /// The first of [`Self::value_and_density`].
    pub(crate) fn value(&self, point: &TexturePoint, wi: DVec3, wo: DVec3) -> f64 {
        self.value_and_density(point, wi, wo).0
    }

    /// The second of [`Self::value_and_density`].
    pub(crate) fn density(&self, point: &TexturePoint, wi: DVec3, wo: DVec3) -> f64 {
        self.value_and_density(point, wi, wo).1
    }

    /// Samples a direction wi from three numbers in (0, 1); `None` if light is absorbed.
    pub(crate) fn sample(
        &self,
        point: &TexturePoint,
        wo: DVec3,
        random: [f64; 3],
    ) -> Option<BsdfSample> {
        let [a, b, c] = random;
        match self {
            Self::TwoSided(sides) => {
                let (side, turned) = side_of(sides, wo);
                let bounce = side.sample(point, turned(wo), random)?;
                Some(turned_back(bounce, wo))
            }
            Self::Mask(_, of) => of.sample(point, wo, random),
            Self::Blend(weight, of) => {
                self.blended(second_share(weight, of, point), of, point, wo, random)
            }
            Self::Dielectric(of) => {
                let turned = to_front(wo);
                let bounce = match rough_dielectric(of, point, wo) {
                    Some(rough) => rough.sample(turned(wo), random)?,
                    None => smooth_dielectric(of, wo).sample(turned(wo), c),
                };
                let weight = bounce.weight * factor(of, point, bounce.wi);
                Some(turned_back(BsdfSample { weight, ..bounce }, wo))
            }
            Self::Principled(of) => {
                let front = principled(of, point);
                match wo.z > 0.0 {
                    true => sampled(&front, wo, random),
                    false => sampled(&front.inside(), wo, random),
                }
            }
            Self::DiffuseTransmission(of) => sampled(&diffuse_transmission(of, point), wo, random),
            _ if wo.z <= 0.0 => None,
            Self::Diffuse(reflectance) => {
                let wi = lambertian::sample([a, b]);
                Some(BsdfSample {
                    wi,
                    weight: reflectance.value(point),
                    density: Some(lambertian::density(wi)),
                })
            }
            Self::Conductor(of) => {
                let bounce = match conductor(of, point) {
                    Some(rough) => rough.sample(wo, random)?,
                    None => mirror(&fresnel(of), wo),
                };
                Some(BsdfSample {
                    weight: of.reflectance.value(point) * bounce.weight,
                    ..bounce
                })
            }
            Self::Plastic(of) => of.at(point).sample(wo, random),
            Self::MetallicRoughness(of) => metallic_roughness(of, point).sample(wo, random),
            Self::Phong(of) => phong(of, point).sample(wo, random),
        }
    }

    /// Samples one of two materials, which is chosen by weight. The returned density is the density
    /// of the mixture.
    fn blended(
        &self,
        share: f64,
        [first, second]: &[Self; 2],
        point: &TexturePoint,
        wo: DVec3,
        [a, b, c]: [f64; 3],
    ) -> Option<BsdfSample> {
        let bounce = if c < share {
            second.sample(point, wo, [a, b, c / share])
        } else {
            first.sample(point, wo, [a, b, (c - share) / (1.0 - share)])
        }?;
        if bounce.density.is_none() {
            return Some(bounce);
        }
        let (value, density) = self.value_and_density(point, bounce.wi, wo);
        Some(BsdfSample {
            weight: value / density,
            density: Some(density),
            ..bounce
        })
    }

    /// The ratio of two squared indices: the squared index on the side of `to`, divided by
    /// the squared index on the side of `from`. The ratio is 1 unless light is refracted.
    pub(crate) fn squared_index(&self, from: DVec3, to: DVec3) -> f64 {
        let index = match self {
            Self::Dielectric(of) if !of.is_thin && from.z * to.z < 0.0 => of.index,
            Self::Principled(of) if from.z * to.z < 0.0 => of.index,
            Self::Mask(_, of) => return of.squared_index(from, to),
            Self::Blend(_, of) => {
                return of.iter().map(|of| of.squared_index(from, to)).product();
            }
            _ => return 1.0,
        };
        let index = if from.z > 0.0 { index } else { 1.0 / index };
        index * index
    }

    /// The kind of reflection on the side of `wo`. For a mixture, returns the kind of the
    /// part with more weight.
    pub(crate) fn kind(&self, point: &TexturePoint, wo: DVec3) -> Reflects {
        let rough = |roughness: Option<&Roughness>| {
            roughness.map_or(Reflects::Mirror, |of| {
                let [a, b] = [0, 1].map(|axis: usize| of.alpha[axis].value(point));
                // The isotropic roughness is the geometric mean of the roughness along both axes.
                let roughness = (a * b).sqrt();
                Reflects::Lobe(of.distribution.lobe(roughness))
            })
        };
        match self {
            Self::TwoSided(sides) => side_of(sides, wo).0.kind(point, wo.abs()),
            Self::Mask(_, of) => of.kind(point, wo),
            Self::Blend(weight, of) => of[usize::from(weight.value(point) > 0.5)].kind(point, wo),
            Self::Dielectric(of) => rough(of.roughness.as_ref().filter(|_| !of.is_thin)),
            Self::Principled(of) if wo.z > 0.0 || of.transmission.value(point) > 0.0 => {
                let Microfacets {
                    distribution,
                    alpha: [a, b],
                } = principled(of, point).facets;
                Reflects::Lobe(distribution.lobe((a * b).sqrt()))
            }
            Self::Principled(_) => Reflects::Nothing,
            Self::DiffuseTransmission(_) => Reflects::Diffuse,
            _ if wo.z <= 0.0 => Reflects::Nothing,
            Self::Diffuse(_) => Reflects::Diffuse,
            Self::Conductor(of) => rough(of.roughness.as_ref()),
            Self::MetallicRoughness(of) => rough(of.roughness.as_ref()),
            Self::Plastic(of) => of.coat.facets().map_or(Reflects::Mirror, |facets| {
                Reflects::Lobe(facets.distribution.lobe(facets.alpha[0]))
            }),
            Self::Phong([_, _, exponent]) => Reflects::Lobe(Lobe::Phong {
                exponent: exponent.value(point),
            }),
        }
    }

    /// The texture factors of both parts of a material. One part is the base, and the other
    /// part is the lobe or mirror above the base. A material with a single part has only a base.
    pub(crate) fn factors(&self, point: &TexturePoint, wo: DVec3) -> [f64; 2] {
        match self {
            Self::TwoSided(sides) => {
                let (side, turned) = side_of(sides, wo);
                side.factors(point, turned(wo))
            }
            Self::Diffuse(reflectance) => [reflectance.value(point), 0.0],
            Self::Conductor(of) => [of.reflectance.value(point), 0.0],
            Self::Plastic(of) => [of.at(point).base_albedo(), of.specular.value(point)],
            Self::Phong([diffuse, specular, _]) => [diffuse.value(point), specular.value(point)],
            Self::MetallicRoughness(of) => [metallic_roughness(of, point).base(), 1.0],
            Self::Principled(of) => [principled(of, point).base(), 1.0],
            _ => [1.0, 0.0],
        }
    }

    /// The share of the base in the light scattered from `wi` to `wo`.
    pub(crate) fn base_share(&self, point: &TexturePoint, wi: DVec3, wo: DVec3) -> f64 {
        match self {
            Self::TwoSided(sides) => {
                let (side, turned) = side_of(sides, wo);
                side.base_share(point, turned(wi), turned(wo))
            }
            Self::Plastic(of) => of.base_share(point, wi, wo),
            Self::MetallicRoughness(of) => {
                let at = metallic_roughness(of, point);
                if at.facets.is_none() && is_mirrored(wi, wo) {
                    return 0.0;
                }
                share(at.base_value(wi, wo), at.value(wi, wo))
            }
            // Only the front reflects light from the base.
            Self::Principled(_) if wi.z <= 0.0 || wo.z <= 0.0 => 0.0,
            Self::Principled(of) => {
                let at = principled(of, point);
                share(at.base_value(wi, wo), at.value(wi, wo))
            }
            Self::Phong(of) => {
                let phong = phong(of, point);
                share(phong.diffuse * lambertian::VALUE, phong.value(wi, wo))
            }
            _ => 1.0,
        }
    }

    /// Checks whether the material has a delta component.
    pub(crate) fn has_mirror(&self) -> bool {
        match self {
            Self::Plastic(of) => of.coat.facets().is_none(),
            Self::MetallicRoughness(of) => of.roughness.is_none(),
            Self::TwoSided(of) | Self::Blend(_, of) => of.iter().any(Self::has_mirror),
            Self::Mask(_, of) => of.has_mirror(),
            _ => self.is_smooth(),
        }
    }

    /// Checks whether the material is partly transparent.
    pub(crate) fn is_masked(&self) -> bool {
        match self {
            Self::Mask(..) => true,
            Self::TwoSided(of) | Self::Blend(_, of) => of.iter().any(Self::is_masked),
            _ => false,
        }
    }

    /// The share of light that hits the material. The rest passes unchanged; the other
    /// methods do not describe it.
    pub(crate) fn opacity(&self, point: &TexturePoint) -> f64 {
        match self {
            Self::Mask(opacity, of) => opacity.value(point).clamp(0.0, 1.0) * of.opacity(point),
            Self::Blend(weight, of) => {
                let share = weight.value(point).clamp(0.0, 1.0);
                let [a, b] = of.each_ref().map(|of| of.opacity(point));
                a + share * (b - a)
            }
            _ => 1.0,
        }
    }

    /// Checks whether the material has only delta components, so that light sampling is impossible.
    pub(crate) fn is_smooth(&self) -> bool {
        match self {
            Self::Conductor(of) => of.roughness.is_none(),
            Self::MetallicRoughness(of) => of.roughness.is_none() && of.metallic.smallest() >= 1.0,
            Self::Dielectric(of) => of.is_thin || of.roughness.is_none(),
            Self::TwoSided(of) | Self::Blend(_, of) => of.iter().all(Self::is_smooth),
            Self::Mask(_, of) => of.is_smooth(),
            Self::Diffuse(_)
            | Self::DiffuseTransmission(_)
            | Self::Plastic(_)
            | Self::Principled(_)
            | Self::Phong(_) => false,
        }
    }
}

/// A BSDF times |cos| of wi, and its density. The BSDF describes the side of wo as its
/// front.
fn both(of: &impl Bsdf, wi: DVec3, wo: DVec3) -> (f64, f64) {
    let turned = to_front(wo);
    let (value, density) = of.value_and_density(turned(wi), turned(wo));
    (value * wi.z.abs(), density)
}

/// Samples a direction of a BSDF, which describes the side of wo as its front.
fn sampled(of: &impl Bsdf, wo: DVec3, random: [f64; 3]) -> Option<BsdfSample> {
    let bounce = of.sample(to_front(wo)(wo), random)?;
    Some(turned_back(bounce, wo))
}

/// A sample for the side of wo, which was drawn with this side in front.
fn turned_back(bounce: BsdfSample, wo: DVec3) -> BsdfSample {
    let wi = to_front(wo)(bounce.wi);
    BsdfSample { wi, ..bounce }
}

/// The share of the second of two mixed materials in the light that hits either of them.
fn second_share(weight: &Texture, of: &[Scatter; 2], point: &TexturePoint) -> f64 {
    let share = weight.value(point).clamp(0.0, 1.0);
    let [a, b] = of.each_ref().map(|of| of.opacity(point));
    share * b / (a + share * (b - a)).max(f64::MIN_POSITIVE)
}

/// The material on the side that faces a direction, and the flip to the frame of this
/// side.
#[inline]
fn side_of(sides: &[Scatter; 2], wo: DVec3) -> (&Scatter, impl Fn(DVec3) -> DVec3 + Copy) {
    (&sides[usize::from(wo.z <= 0.0)], to_front(wo))
}

#[cfg(test)]
mod tests;
