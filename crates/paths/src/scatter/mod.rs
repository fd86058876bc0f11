//! What surfaces do to light, as seen from a camera back: from the direction `wo` that light leaves to, to `wi` that it comes from.
//!
//! Directions are unit vectors away from the surface, in a frame with its normal along Z. Values are BSDFs times |cos| of wi, and carry radiance:
//! behind an interface it is that of the other side over the squared index.

mod bounce;
mod fresnel;
mod microfacet;
mod phong;
mod plastic;
mod reflects;

pub(crate) use bounce::Bounce;
use bounce::{by_cosine, cosine_density, mirrored};
use etendue_field::{Fresnel, Lobe};
use etendue_trace::brdf::reflected_share;
use etendue_world::{Conductor, Dielectric, Material, Roughness, Texture};
use fresnel::dielectric;
use glam::{DVec2, DVec3};
use microfacet::{Microfacets, RoughInterface};
use plastic::Coated;
pub use reflects::Reflects;
use std::f64::consts::PI;

/// A material, ready to scatter.
#[derive(Clone, Debug)]
pub(crate) enum Scatter {
    Diffuse(Texture),
    Conductor(Conductor),
    Dielectric(Dielectric),
    Plastic(Box<Coated>),
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
            Material::Conductor(conductor) => Self::Conductor(conductor.clone()),
            Material::Dielectric(dielectric) => Self::Dielectric(dielectric.clone()),
            Material::Plastic(plastic) => Self::Plastic(Box::new(Coated::new(plastic))),
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
    /// The BSDF times |cos| of wi; what goes only one way, as at mirrors, is left out.
    pub(crate) fn value(&self, uv: DVec2, wi: DVec3, wo: DVec3) -> f64 {
        let is_front = wi.z > 0.0 && wo.z > 0.0;
        match self {
            Self::TwoSided(sides) => {
                let (side, turned) = side_of(sides, wo);
                side.value(uv, turned(wi), turned(wo))
            }
            Self::Mask(opacity, of) => opacity.value(uv) * of.value(uv, wi, wo),
            Self::Blend(weight, of) => {
                let ([a, b], share) = (&**of, weight.value(uv).clamp(0.0, 1.0));
                (1.0 - share) * a.value(uv, wi, wo) + share * b.value(uv, wi, wo)
            }
            Self::Dielectric(of) => rough_interface(of, uv, wo).map_or(0.0, |(rough, turned)| {
                let (wi, wo) = (turned(wi), turned(wo));
                factor(of, uv, wi) * rough.value(wi, wo)
            }),
            _ if !is_front => 0.0,
            Self::Diffuse(reflectance) => reflectance.value(uv) * wi.z / PI,
            Self::Conductor(of) => facets(of.roughness.as_ref(), uv).map_or(0.0, |facets| {
                let (value, normal) = facets.reflected(wi, wo);
                value * metal(of, uv, wo.dot(normal))
            }),
            Self::Plastic(of) => of.value(uv, wi, wo),
            Self::Phong(of) => phong::value(of, uv, wi, wo),
        }
    }

    /// The density of [`Self::sample`] per solid angle, but for what goes only one way.
    pub(crate) fn density(&self, uv: DVec2, wi: DVec3, wo: DVec3) -> f64 {
        let is_front = wi.z > 0.0 && wo.z > 0.0;
        match self {
            Self::TwoSided(sides) => {
                let (side, turned) = side_of(sides, wo);
                side.density(uv, turned(wi), turned(wo))
            }
            Self::Mask(opacity, of) => opacity.value(uv) * of.density(uv, wi, wo),
            Self::Blend(weight, of) => {
                let ([a, b], share) = (&**of, weight.value(uv).clamp(0.0, 1.0));
                (1.0 - share) * a.density(uv, wi, wo) + share * b.density(uv, wi, wo)
            }
            Self::Dielectric(of) => rough_interface(of, uv, wo)
                .map_or(0.0, |(rough, turned)| rough.density(turned(wi), turned(wo))),
            _ if !is_front => 0.0,
            Self::Diffuse(_) => cosine_density(wi),
            Self::Conductor(of) => facets(of.roughness.as_ref(), uv)
                .map_or(0.0, |facets| facets.reflected_density(wi, wo)),
            Self::Plastic(of) => of.density(uv, wi, wo),
            Self::Phong(of) => phong::density(of, uv, wi, wo),
        }
    }

    /// A direction wi, from three numbers in (0, 1); `None` where light is absorbed.
    pub(crate) fn sample(&self, uv: DVec2, wo: DVec3, random: [f64; 3]) -> Option<Bounce> {
        let [a, b, c] = random;
        match self {
            Self::TwoSided(sides) => {
                let (side, turned) = side_of(sides, wo);
                let bounce = side.sample(uv, turned(wo), random)?;
                Some(Bounce {
                    wi: turned(bounce.wi),
                    ..bounce
                })
            }
            Self::Mask(opacity, of) => {
                let opacity = opacity.value(uv).clamp(0.0, 1.0);
                if c >= opacity {
                    return Some(Bounce {
                        wi: -wo,
                        weight: 1.0,
                        density: None,
                    });
                }
                let bounce = of.sample(uv, wo, [a, b, c / opacity])?;
                let density = bounce.density.map(|density| opacity * density);
                Some(Bounce { density, ..bounce })
            }
            Self::Blend(weight, of) => {
                self.blended(weight.value(uv).clamp(0.0, 1.0), of, uv, wo, random)
            }
            Self::Dielectric(of) => match rough_interface(of, uv, wo) {
                Some((rough, turned)) => {
                    let bounce = rough.sample(turned(wo), random)?;
                    let weight = bounce.weight * factor(of, uv, bounce.wi);
                    Some(Bounce {
                        wi: turned(bounce.wi),
                        weight,
                        ..bounce
                    })
                }
                None => smooth_interface(of, uv, wo, c),
            },
            _ if wo.z <= 0.0 => None,
            Self::Diffuse(reflectance) => {
                let wi = by_cosine([a, b]);
                Some(Bounce {
                    wi,
                    weight: reflectance.value(uv),
                    density: Some(cosine_density(wi)),
                })
            }
            Self::Conductor(of) => match facets(of.roughness.as_ref(), uv) {
                Some(facets) => self.weighed(uv, facets.reflect(wo, [a, b]), wo),
                None => {
                    let wi = mirrored(wo, DVec3::Z);
                    Some(Bounce {
                        wi,
                        weight: metal(of, uv, wo.z),
                        density: None,
                    })
                }
            },
            Self::Plastic(of) => of.sample(uv, wo, random),
            Self::Phong(of) => self.weighed(uv, phong::sample(of, uv, wo, random), wo),
        }
    }

    /// A sampled direction with its weight; `None` below the front.
    fn weighed(&self, uv: DVec2, wi: DVec3, wo: DVec3) -> Option<Bounce> {
        let density = self.density(uv, wi, wo);
        (wi.z > 0.0 && density > 0.0).then(|| Bounce {
            wi,
            weight: self.value(uv, wi, wo) / density,
            density: Some(density),
        })
    }

    /// One of two, each by its share; the density is that of both.
    fn blended(
        &self,
        share: f64,
        [first, second]: &[Self; 2],
        uv: DVec2,
        wo: DVec3,
        [a, b, c]: [f64; 3],
    ) -> Option<Bounce> {
        let bounce = if c < share {
            second.sample(uv, wo, [a, b, c / share])
        } else {
            first.sample(uv, wo, [a, b, (c - share) / (1.0 - share)])
        }?;
        if bounce.density.is_none() {
            return Some(bounce);
        }
        let density = self.density(uv, bounce.wi, wo);
        let weight = self.value(uv, bounce.wi, wo) / density;
        Some(Bounce {
            weight,
            density: Some(density),
            ..bounce
        })
    }

    /// The squared index of the side that `to` is on, over that of the side of `from`: 1 unless light is refracted on its way.
    pub(crate) fn squared_index(&self, from: DVec3, to: DVec3) -> f64 {
        match self {
            Self::Dielectric(of) if !of.is_thin && from.z * to.z < 0.0 => {
                let index = if from.z > 0.0 {
                    of.index
                } else {
                    1.0 / of.index
                };
                index * index
            }
            // What goes straight on has met nothing.
            Self::Mask(_, of) if (from + to).length_squared() > 1e-24 => of.squared_index(from, to),
            Self::Blend(_, of) => of.iter().map(|of| of.squared_index(from, to)).product(),
            _ => 1.0,
        }
    }

    /// What it does to light on the side that `wo` sees, in a word; of a mixture, by its larger part.
    pub(crate) fn kind(&self, uv: DVec2, wo: DVec3) -> Reflects {
        let rough = |roughness: Option<&Roughness>| {
            roughness.map_or(Reflects::Mirror, |of| {
                let [a, b] = [0, 1].map(|axis: usize| of.alpha[axis].value(uv));
                // Of the same area as the ellipse of both.
                let roughness = (a * b).sqrt();
                Reflects::facets(of.distribution, roughness)
            })
        };
        match self {
            Self::TwoSided(sides) => side_of(sides, wo).0.kind(uv, wo.abs()),
            Self::Mask(_, of) => of.kind(uv, wo),
            Self::Blend(weight, of) => of[usize::from(weight.value(uv) > 0.5)].kind(uv, wo),
            Self::Dielectric(of) => rough(of.roughness.as_ref().filter(|_| !of.is_thin)),
            _ if wo.z <= 0.0 => Reflects::Nothing,
            Self::Diffuse(_) => Reflects::Diffuse,
            Self::Conductor(of) => rough(of.roughness.as_ref()),
            Self::Plastic(of) => of.kind(),
            Self::Phong([_, _, exponent]) => Reflects::Lobe(Lobe::Phong {
                exponent: exponent.value(uv),
            }),
        }
    }

    /// The factors of its two parts, as textures have them: of the base, and of the lobe or mirror above it. What has one part only has that as its base.
    pub(crate) fn factors(&self, uv: DVec2, wo: DVec3) -> [f64; 2] {
        match self {
            Self::TwoSided(sides) => {
                let (side, turned) = side_of(sides, wo);
                side.factors(uv, turned(wo))
            }
            Self::Diffuse(reflectance) => [reflectance.value(uv), 0.0],
            Self::Conductor(of) => [of.reflectance.value(uv), 0.0],
            Self::Plastic(of) => of.factors(uv),
            Self::Phong([diffuse, specular, _]) => [diffuse.value(uv), specular.value(uv)],
            _ => [1.0, 0.0],
        }
    }

    /// The share of the base in what leaves to `wo` of light from `wi`.
    pub(crate) fn base_share(&self, uv: DVec2, wi: DVec3, wo: DVec3) -> f64 {
        match self {
            Self::TwoSided(sides) => {
                let (side, turned) = side_of(sides, wo);
                side.base_share(uv, turned(wi), turned(wo))
            }
            Self::Plastic(of) => of.base_share(uv, wi, wo),
            Self::Phong(of) => phong::base_share(of, uv, wi, wo),
            _ => 1.0,
        }
    }

    /// Whether some of what leaves it goes one way only.
    pub(crate) fn has_mirror(&self) -> bool {
        match self {
            Self::Plastic(of) => of.is_smooth(),
            Self::TwoSided(of) | Self::Blend(_, of) => of.iter().any(Self::has_mirror),
            Self::Mask(..) => true,
            _ => self.is_smooth(),
        }
    }

    /// Whether all that leaves it goes one way, so that no light can be looked for from it.
    pub(crate) fn is_smooth(&self) -> bool {
        match self {
            Self::Conductor(of) => of.roughness.is_none(),
            Self::Dielectric(of) => of.is_thin || of.roughness.is_none(),
            Self::TwoSided(of) | Self::Blend(_, of) => of.iter().all(Self::is_smooth),
            Self::Mask(_, of) => of.is_smooth(),
            Self::Diffuse(_) | Self::Plastic(_) | Self::Phong(_) => false,
        }
    }
}

/// Turns directions so that a side is above.
type Turn = fn(DVec3) -> DVec3;

/// The side of a two-sided material that a direction sees, and how directions are turned to its frame.
fn side_of(sides: &[Scatter; 2], wo: DVec3) -> (&Scatter, Turn) {
    if wo.z > 0.0 {
        (&sides[0], |v| v)
    } else {
        (&sides[1], turned)
    }
}

fn turned(v: DVec3) -> DVec3 {
    v.with_z(-v.z)
}

/// The microfacets at a place; `None` for a smooth surface.
fn facets(roughness: Option<&Roughness>, uv: DVec2) -> Option<Microfacets> {
    roughness.map(|of| Microfacets {
        distribution: of.distribution,
        // As small as directions in f64 still tell.
        alpha: [0, 1].map(|axis: usize| of.alpha[axis].value(uv).max(1e-4)),
    })
}

/// What a metal reflects at an angle.
fn metal(of: &Conductor, uv: DVec2, cosine: f64) -> f64 {
    let fresnel = of
        .index
        .map_or(Fresnel::White, |[n, k]| Fresnel::Conductor { n, k });
    of.reflectance.value(uv) * reflected_share(&fresnel, cosine.clamp(0.0, 1.0))
}

/// A rough interface as wo sees it, and how directions are turned so that wo is above; `None` for a smooth one.
fn rough_interface(of: &Dielectric, uv: DVec2, wo: DVec3) -> Option<(RoughInterface, Turn)> {
    let facets = facets(of.roughness.as_ref().filter(|_| !of.is_thin), uv)?;
    let (index, to_above): (f64, Turn) = if wo.z > 0.0 {
        (of.index, |v| v)
    } else {
        (1.0 / of.index, turned)
    };
    Some((RoughInterface { facets, index }, to_above))
}

/// The factor on what is reflected or goes through, wo being above.
fn factor(of: &Dielectric, uv: DVec2, wi: DVec3) -> f64 {
    if wi.z > 0.0 {
        of.reflectance.value(uv)
    } else {
        of.transmittance.value(uv)
    }
}

/// Reflects or refracts at a smooth interface, each as often as light does.
fn smooth_interface(of: &Dielectric, uv: DVec2, wo: DVec3, random: f64) -> Option<Bounce> {
    // A thin sheet has the same medium on both sides.
    let index = if of.is_thin || wo.z > 0.0 {
        of.index
    } else {
        1.0 / of.index
    };
    let normal = DVec3::Z * wo.z.signum();
    let mut at = dielectric(index, wo.z.abs());
    if of.is_thin && at.reflected < 1.0 {
        // Reflections within, summed: R + T² R / (1 − R²).
        let once = at.reflected;
        at.reflected += (1.0 - once).powi(2) * once / (1.0 - once * once);
    }
    if random < at.reflected {
        let (wi, weight) = (mirrored(wo, normal), of.reflectance.value(uv));
        return Some(Bounce {
            wi,
            weight,
            density: None,
        });
    }
    let transmittance = of.transmittance.value(uv);
    let (wi, weight) = if of.is_thin {
        (-wo, transmittance)
    } else {
        (at.refracted(wo, normal), transmittance / (index * index))
    };
    Some(Bounce {
        wi,
        weight,
        density: None,
    })
}

#[cfg(test)]
mod tests;
