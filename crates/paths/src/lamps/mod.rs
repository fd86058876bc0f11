//! Lights as paths look for them: a direction to light, what comes from there, and how densely such directions are drawn.

mod ball;
mod emit;
mod incoming;
mod shape;
mod sky;

use crate::space::{Hit, Space};
use ball::Ball;
pub(crate) use emit::{Emitted, Flash, Target, chosen, mixed};
use etendue_world::{Falloff, Geometry, Light, Shape, Texture, World};
use glam::{DAffine3, DVec3};
pub(crate) use incoming::Incoming;
use incoming::way;
use shape::Surface;
use sky::Sky;

/// All lights of a world, of which each is looked for alike.
#[derive(Debug)]
pub(crate) struct Lamps {
    lamps: Vec<Lamp>,
    /// The lamp of each shape that shines.
    of_shape: Vec<Option<usize>>,
}

#[derive(Debug)]
enum Lamp {
    Surface(Surface),
    Ball(Ball),
    Point {
        position: DVec3,
        intensity: f64,
    },
    Spot {
        to_local: DAffine3,
        intensity: f64,
        beam: f64,
        cutoff: f64,
        falloff: Falloff,
    },
    Directional {
        toward: DVec3,
        irradiance: f64,
    },
    Sky(Sky),
}

impl Lamps {
    pub(crate) fn new(world: &World, space: &Space) -> Self {
        let mut lamps = Vec::new();
        let of_shape = world.shapes.iter().enumerate().map(|(i, shape)| {
            lamps.push(shining(shape, i, space)?);
            Some(lamps.len() - 1)
        });
        let of_shape = of_shape.collect();
        lamps.extend(world.lights.iter().map(Lamp::from));
        Self { lamps, of_shape }
    }

    /// Light that comes to a place, from four numbers; `None` where none does.
    pub(crate) fn sample(
        &self,
        space: &Space,
        at: DVec3,
        [a, b, c, d]: [f64; 4],
    ) -> Option<Incoming> {
        let count = self.lamps.len() as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a number of a lamp"
        )]
        let lamp = self.lamps.get((d * count) as usize)?;
        let found = lamp.sample(space, at, [a, b, c])?;
        let density = found.density.map(|density| density / count);
        Some(Incoming {
            weight: found.weight * count,
            density,
            ..found
        })
    }

    /// The radiance that a shape emits where a ray along `along` meets it, and the density with which [`Self::sample`] looks there.
    pub(crate) fn of_hit(&self, from: DVec3, along: DVec3, hit: &Hit) -> (f64, f64) {
        let Some(lamp) = self.of_shape[hit.shape].map(|lamp| &self.lamps[lamp]) else {
            return (0.0, 0.0);
        };
        let (radiance, density) = match lamp {
            Lamp::Surface(surface) => surface.of_hit(along, hit),
            Lamp::Ball(ball) => ball.of_hit(from, along, hit),
            _ => (0.0, 0.0),
        };
        (radiance, density / self.lamps.len() as f64)
    }

    /// The radiance that comes from far away along a direction, and the density with which [`Self::sample`] looks there: a sum over lights.
    pub(crate) fn of_sky(&self, toward: DVec3) -> impl Iterator<Item = (f64, f64)> {
        let count = self.lamps.len() as f64;
        let skies = self.lamps.iter().filter_map(|lamp| match lamp {
            Lamp::Sky(sky) => Some(sky),
            _ => None,
        });
        skies.map(move |sky| (sky.radiance(toward), sky.density(toward) / count))
    }
}

fn shining(shape: &Shape, number: usize, space: &Space) -> Option<Lamp> {
    let emission: Texture = shape.emission.clone()?;
    let placed = space.placed(number);
    Some(match shape.geometry {
        Geometry::Sphere if !shape.is_flipped => {
            Lamp::Ball(Ball::new(number, &shape.to_world, emission))
        }
        _ => Lamp::Surface(Surface::new(number, &placed.areas(), emission)),
    })
}

impl From<&Light> for Lamp {
    fn from(light: &Light) -> Self {
        match light {
            Light::Point {
                position,
                intensity,
            } => Self::Point {
                position: *position,
                intensity: *intensity,
            },
            Light::Spot {
                to_world,
                intensity,
                beam,
                cutoff,
                falloff,
            } => Self::Spot {
                to_local: to_world.inverse(),
                intensity: *intensity,
                beam: *beam,
                cutoff: *cutoff,
                falloff: *falloff,
            },
            Light::Directional {
                direction,
                irradiance,
            } => Self::Directional {
                toward: -*direction,
                irradiance: *irradiance,
            },
            Light::Constant { radiance } => Self::Sky(Sky::Constant(*radiance)),
            Light::Sky(map) => Self::Sky(Sky::new(map)),
        }
    }
}

impl Lamp {
    fn sample(&self, space: &Space, at: DVec3, [a, b, c]: [f64; 3]) -> Option<Incoming> {
        match self {
            Self::Surface(surface) => surface.sample(space, at, [a, b, c]),
            Self::Ball(ball) => ball.sample(space, at, [a, b]),
            Self::Point {
                position,
                intensity,
            } => {
                let (toward, distance) = way(at, *position);
                let weight = intensity / (distance * distance);
                Some(Incoming {
                    toward,
                    distance,
                    weight,
                    density: None,
                })
            }
            Self::Spot { to_local, .. } => {
                let (toward, distance) = way(at, to_local.inverse().translation);
                let intensity = self.intensity(to_local.transform_vector3(-toward));
                (intensity > 0.0).then_some(Incoming {
                    toward,
                    distance,
                    weight: intensity / (distance * distance),
                    density: None,
                })
            }
            Self::Directional { toward, irradiance } => Some(Incoming {
                toward: *toward,
                distance: f64::INFINITY,
                weight: *irradiance,
                density: None,
            }),
            Self::Sky(sky) => {
                let toward = sky.sample([a, b, c]);
                let density = sky.density(toward);
                let weight = sky.radiance(toward) / density;
                let found = Incoming {
                    toward,
                    distance: f64::INFINITY,
                    weight,
                    density: Some(density),
                };
                (density > 0.0).then_some(found)
            }
        }
    }
}

impl Lamp {
    /// What a spot sends along a direction of its own coordinates, W sr⁻¹.
    fn intensity(&self, local: DVec3) -> f64 {
        let Self::Spot {
            intensity,
            beam,
            cutoff,
            falloff,
            ..
        } = self
        else {
            return 0.0;
        };
        let angle = libm::atan2(local.truncate().length(), local.z);
        intensity * falloff.share(angle, *beam, *cutoff)
    }
}
