//! Samples lights: draws a direction to a light, and returns the radiance from this direction and
//! the density of the drawn directions.

mod beam;
mod emit;
mod incoming;
mod shape;
mod sky;

use crate::space::{Hit, Ray, SceneGeometry};
use beam::Beam;
pub(crate) use emit::{EmissionTarget, chosen, mixed};
use etendue_field::whole;
use etendue_world::{Geometry, Light, Shape, Texture, World};
use glam::DVec3;
pub(crate) use incoming::Incoming;
use incoming::way;
use shape::{ShiningShape, ShiningSphere};
use sky::SampledSky;

/// All lights of a world, sampled with equal probability.
#[derive(Debug)]
pub(crate) struct LightSampler {
    lights: Vec<SampledLight>,
    /// For each shape that emits, the index of its light.
    of_shape: Vec<Option<usize>>,
}

#[derive(Debug)]
enum SampledLight {
    ShiningShape(ShiningShape),
    ShiningSphere(ShiningSphere),
    Beam(Beam),
    Sky(SampledSky),
    /// A point light, or a light with parallel rays.
    Plain(Light),
}

impl LightSampler {
    pub(crate) fn new(world: &World, geometry: &SceneGeometry) -> Self {
        let mut lights = Vec::new();
        let of_shape = world.shapes.iter().enumerate().map(|(i, shape)| {
            lights.push(shining(shape, i, geometry)?);
            Some(lights.len() - 1)
        });
        let of_shape = of_shape.collect();
        lights.extend(world.lights.iter().map(SampledLight::from));
        Self { lights, of_shape }
    }

    /// Samples incident light at a point with four random numbers. Returns `None` if no light
    /// arrives.
    #[inline]
    pub(crate) fn sample(
        &self,
        geometry: &SceneGeometry,
        at: DVec3,
        [a, b, c, d]: [f64; 4],
    ) -> Option<Incoming> {
        let count = self.lights.len() as f64;
        let (light, d) = self.pick(d)?;
        let found = light.sample(geometry, at, [a, b, c, d])?;
        let density = found.density.map(|density| density / count);
        Some(Incoming {
            weight: found.weight * count,
            density,
            ..found
        })
    }

    /// Picks a light by a random number, each light with equal probability. Returns the light, and
    /// a random number in (0, 1) for further use.
    #[inline]
    fn pick(&self, r: f64) -> Option<(&SampledLight, f64)> {
        let place = r * self.lights.len() as f64;
        let light = self.lights.get(whole(place))?;
        Some((light, place.fract()))
    }

    /// Checks whether all lights are surfaces or skies.
    pub(crate) fn are_extended(&self) -> bool {
        let is_extended = |light: &SampledLight| {
            matches!(
                light,
                SampledLight::ShiningShape(_)
                    | SampledLight::ShiningSphere(_)
                    | SampledLight::Sky(_)
            )
        };
        self.lights.iter().all(is_extended)
    }

    /// The emission of a shape that a ray along `along` hits, and the density with which
    /// [`Self::sample`] draws this direction.
    #[inline]
    pub(crate) fn of_hit(&self, from: DVec3, along: DVec3, hit: &Hit) -> (f64, f64) {
        let Some(light) = self.of_shape[hit.shape].map(|light| &self.lights[light]) else {
            return (0.0, 0.0);
        };
        let (radiance, density) = match light {
            SampledLight::ShiningShape(surface) => surface.of_hit(along, hit),
            SampledLight::ShiningSphere(ball) => ball.of_hit(from, along, hit),
            _ => (0.0, 0.0),
        };
        (radiance, density / self.lights.len() as f64)
    }

    /// Returns, for each distant light, its radiance from a direction, and the density with which
    /// [`Self::sample`] draws this direction.
    #[inline]
    pub(crate) fn of_sky(&self, toward: DVec3) -> impl Iterator<Item = (f64, f64)> {
        let count = self.lights.len() as f64;
        let skies = self.lights.iter().filter_map(move |light| match light {
            SampledLight::Sky(sky) => Some(sky.radiance_and_density(toward)),
            _ => None,
        });
        skies.map(move |(radiance, density)| (radiance, density / count))
    }
}

fn shining(shape: &Shape, number: usize, geometry: &SceneGeometry) -> Option<SampledLight> {
    let emission: Texture = shape.emission.clone()?;
    let placed = geometry.placed(number);
    Some(match shape.geometry {
        Geometry::Sphere if !shape.is_flipped && !shape.emits_on_both_sides => {
            SampledLight::ShiningSphere(ShiningSphere::new(number, &shape.to_world, emission))
        }
        _ => SampledLight::ShiningShape(ShiningShape::new(
            number,
            &placed.form.areas(&placed.to_world),
            emission,
            shape.emits_on_both_sides,
        )),
    })
}

impl From<&Light> for SampledLight {
    fn from(light: &Light) -> Self {
        match light {
            Light::Spot {
                to_world, cutoff, ..
            } => Self::Beam(Beam {
                to_local: to_world.inverse(),
                cosine: libm::cos(*cutoff),
                light: light.clone(),
            }),
            Light::Projector { to_world, half, .. } => Self::Beam(Beam {
                to_local: to_world.inverse(),
                // The cone passes through the corners of the picture.
                cosine: (1.0 + half.length_squared()).sqrt().recip(),
                light: light.clone(),
            }),
            Light::Constant { radiance } => Self::Sky(SampledSky::Constant(*radiance)),
            Light::Sky(map) => Self::Sky(SampledSky::new(map)),
            Light::Point { .. } | Light::Directional { .. } | Light::Sheet { .. } => {
                Self::Plain(light.clone())
            }
        }
    }
}

impl SampledLight {
    #[inline]
    fn sample(&self, geometry: &SceneGeometry, at: DVec3, r: [f64; 4]) -> Option<Incoming> {
        let [a, b, c, _] = r;
        match self {
            Self::ShiningShape(surface) => surface.sample(geometry, at, [a, b, c]),
            Self::ShiningSphere(ball) => ball.sample(geometry, at, [a, b]),
            Self::Plain(Light::Point {
                position,
                intensity,
            }) => {
                let (toward, distance) = way(at, *position);
                let weight = intensity / (distance * distance);
                Some(Incoming::from_one(toward, distance, weight))
            }
            Self::Beam(beam) => {
                let (toward, distance) = way(at, beam.to_local.inverse().translation);
                let intensity = beam.intensity(-toward);
                let weight = intensity / (distance * distance);
                (intensity > 0.0).then_some(Incoming::from_one(toward, distance, weight))
            }
            Self::Plain(Light::Directional {
                direction,
                irradiance,
            }) => Some(Incoming::from_one(-*direction, f64::INFINITY, *irradiance)),
            Self::Plain(Light::Sheet { shape, exitance }) => {
                // A flat shape has the same normal everywhere.
                let (_, normal, _) = geometry.placed(*shape).sample(0, [0.5; 2]);
                let ray = Ray::new(at, -normal);
                let hit = geometry.meets(*shape, &ray, [0.0, f64::INFINITY])?;
                let weight = exitance.value(&hit.point);
                Some(Incoming::from_one(-normal, hit.distance, weight))
            }
            // The other lights are of the other kinds; named here, so that a new light must be placed.
            Self::Plain(
                Light::Spot { .. }
                | Light::Projector { .. }
                | Light::Constant { .. }
                | Light::Sky(_),
            ) => None,
            Self::Sky(sky) => {
                let toward = sky.sample(r);
                let (radiance, density) = sky.radiance_and_density(toward);
                (density > 0.0).then(|| Incoming {
                    toward,
                    distance: f64::INFINITY,
                    weight: radiance / density,
                    density: Some(density),
                })
            }
        }
    }
}
