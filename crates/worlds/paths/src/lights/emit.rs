//! Emits photons from lights. Half of the photons follow the natural distribution, and the other
//! half are aimed.

use super::{LightSampler, SampledLight};
use crate::space::{Ray, SceneGeometry};
use etendue_field::whole;
use etendue_sampling::{Cone, about, cosine_hemisphere, disc};
use etendue_world::Light;
use glam::DVec3;
use std::f64::consts::PI;

/// A photon in flight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Emitted {
    pub(crate) ray: Ray,
    /// The photon's flux, W, times the number of photons.
    pub(crate) flux: f64,
    /// The surface point from which the photon was emitted.
    pub(crate) flash: Option<EmissionPoint>,
}

/// A point of an emitting surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EmissionPoint {
    pub(crate) position: DVec3,
    pub(crate) normal: DVec3,
    /// Radiance divided by the density of points, W sr⁻¹.
    pub(crate) shine: f64,
}

/// A sphere at which photons are aimed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EmissionTarget {
    pub(crate) center: DVec3,
    pub(crate) radius: f64,
}

/// Random numbers and targets for photon directions.
struct Draw<'a> {
    targets: &'a [EmissionTarget],
    /// Two random numbers for the direction, and one for the choice between natural and aimed
    /// emission.
    random: [f64; 3],
}

impl LightSampler {
    /// Emits a photon. Seven random numbers determine the photon. Returns `None` if the photon has
    /// no flux.
    pub(crate) fn emit(
        &self,
        geometry: &SceneGeometry,
        [a, b, c, d, e, by, light]: [f64; 7],
        targets: &[EmissionTarget],
    ) -> Option<Emitted> {
        let count = self.lights.len() as f64;
        let (light, rest) = self.pick(light)?;
        let random = [d, e, by];
        let mut emitted = light.emit(geometry, [a, b, c, rest], &Draw { targets, random })?;
        emitted.flux *= count;
        if let Some(flash) = &mut emitted.flash {
            flash.shine *= count;
        }
        Some(emitted)
    }
}

impl SampledLight {
    fn emit(&self, geometry: &SceneGeometry, place: [f64; 4], draw: &Draw<'_>) -> Option<Emitted> {
        let [a, b, ..] = place;
        match self {
            Self::ShiningShape(surface) => Some(draw.flashed(surface.emit(geometry, place)?)),
            Self::ShiningSphere(ball) => Some(draw.flashed(ball.emit(geometry, [a, b]))),
            Self::Plain(Light::Point {
                position,
                intensity,
            }) => Some(draw.away(*position, &Cone::SPHERE, &|_| *intensity)),
            Self::Beam(beam) => {
                let to_world = beam.to_local.inverse();
                let cone = Cone::new(to_world.matrix3.z_axis, beam.cosine);
                Some(draw.away(to_world.translation, &cone, &|along| beam.intensity(along)))
            }
            Self::Plain(Light::Directional {
                direction,
                irradiance,
            }) => Some(draw.afar(geometry, -*direction, *irradiance)),
            Self::Plain(Light::Sheet { shape, exitance }) => {
                let placed = geometry.placed(*shape);
                let (from, along, point) = placed.sample(0, [a, b]);
                Some(Emitted {
                    ray: Ray { from, along },
                    flux: exitance.value(&point) * placed.form.areas(&placed.to_world)[0],
                    flash: None,
                })
            }
            // The other lights are of the other kinds; named here, so that a new light must be placed.
            Self::Plain(
                Light::Spot { .. }
                | Light::Projector { .. }
                | Light::Constant { .. }
                | Light::Sky(_),
            ) => None,
            Self::Sky(sky) => {
                let toward = sky.sample(place);
                let (radiance, density) = sky.radiance_and_density(toward);
                (density > 0.0).then(|| draw.afar(geometry, toward, radiance / density))
            }
        }
    }
}

impl Draw<'_> {
    /// A direction from a point, either natural or aimed, and its density. `sample` and `density`
    /// describe the natural directions.
    fn direction(
        &self,
        from: DVec3,
        sample: impl Fn([f64; 2]) -> DVec3,
        density: impl Fn(DVec3) -> f64,
    ) -> (DVec3, f64) {
        let [a, b, by] = self.random;
        let along = match chosen(self.targets, by) {
            Some(target) => target.toward(from, [a, b]),
            None => sample([a, b]),
        };
        let aimed = |target: &EmissionTarget| target.density(from, along);
        (along, mixed(density(along), self.targets, aimed))
    }

    /// Emits a photon from a surface point in a cosine-distributed or an aimed direction.
    fn flashed(&self, (position, normal, shine): (DVec3, DVec3, f64)) -> Emitted {
        let cosine = |along: DVec3| along.dot(normal).max(0.0);
        let natural = |random| about(normal, cosine_hemisphere(random));
        let (along, density) = self.direction(position, natural, |along| cosine(along) / PI);
        Emitted {
            ray: Ray::new(position, along),
            flux: shine * cosine(along) / density,
            flash: Some(EmissionPoint {
                position,
                normal,
                shine,
            }),
        }
    }

    /// Emits a photon from a point. Its direction is either uniform in a cone or aimed.
    fn away(&self, from: DVec3, cone: &Cone, intensity: &dyn Fn(DVec3) -> f64) -> Emitted {
        let natural = |random| cone.sample(random);
        let (along, density) = self.direction(from, natural, |along| cone.density(along));
        Emitted {
            ray: Ray { from, along },
            flux: intensity(along) / density,
            flash: None,
        }
    }

    /// Emits a photon of a distant light through a disc that covers all surfaces, or through a
    /// target.
    fn afar(&self, geometry: &SceneGeometry, toward: DVec3, irradiance: f64) -> Emitted {
        let [a, b, by] = self.random;
        let whole = EmissionTarget {
            center: geometry.center,
            // The disc is slightly wider than the sphere around all surfaces, because a surface
            // may touch this sphere.
            radius: 1.001 * geometry.radius,
        };
        let aimed = chosen(self.targets, by).unwrap_or(&whole);
        let across = disc(aimed.radius, [a, b]).extend(0.0);
        let place = aimed.center + about(toward, across);
        let density = |disc: &EmissionTarget| {
            let off = place - disc.center;
            let is_in = off.length_squared() - off.dot(toward).powi(2) <= disc.radius.powi(2);
            if is_in {
                1.0 / (PI * disc.radius * disc.radius)
            } else {
                0.0
            }
        };
        let height = (place - whole.center).dot(toward);
        let from = place + (2.0 * whole.radius - height) * toward;
        Emitted {
            ray: Ray::new(from, -toward),
            flux: irradiance / mixed(density(&whole), self.targets, density),
            flash: None,
        }
    }
}

/// The target at which a photon is aimed, or `None` if the photon is not aimed. Half of the
/// photons are aimed, with the same probability for each target.
pub(crate) fn chosen(targets: &[EmissionTarget], by: f64) -> Option<&EmissionTarget> {
    let number = (2.0 * by - 1.0) * targets.len() as f64;
    let found = (number >= 0.0).then(|| whole(number));
    found.and_then(|number| targets.get(number))
}

/// The density of a mixture. Half of the samples have the density `plain`, and the other
/// half are divided equally among the targets.
pub(crate) fn mixed(
    plain: f64,
    targets: &[EmissionTarget],
    aimed: impl Fn(&EmissionTarget) -> f64,
) -> f64 {
    if targets.is_empty() {
        return plain;
    }
    let aimed: f64 = targets.iter().map(aimed).sum();
    0.5 * plain + 0.5 * aimed / targets.len() as f64
}

impl EmissionTarget {
    /// The cone that the sphere subtends at a point, or all directions if the point is
    /// inside the sphere.
    fn cone(&self, from: DVec3) -> Cone {
        Cone::around_sphere(self.center - from, self.radius).unwrap_or(Cone::SPHERE)
    }

    pub(crate) fn toward(&self, from: DVec3, random: [f64; 2]) -> DVec3 {
        self.cone(from).sample(random)
    }

    pub(crate) fn density(&self, from: DVec3, along: DVec3) -> f64 {
        self.cone(from).density(along)
    }
}
