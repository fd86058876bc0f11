//! Emitting spheres.

use super::incoming::{Incoming, emitted};
use crate::space::{Hit, Ray, SceneGeometry};
use etendue_sampling::Cone;
use etendue_world::Texture;
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;

/// A sphere that emits outwards. Directions to it are sampled within the cone that it subtends.
#[derive(Debug)]
pub(super) struct ShiningSphere {
    shape: usize,
    emission: Texture,
    center: DVec3,
    radius: f64,
}

impl ShiningSphere {
    pub(super) fn new(shape: usize, to_world: &DAffine3, emission: Texture) -> Self {
        Self {
            shape,
            emission,
            center: to_world.translation,
            radius: to_world.matrix3.x_axis.length(),
        }
    }

    /// Returns the cone that the sphere subtends at a point. Returns `None` for a point inside the
    /// sphere, because the sphere emits no light inwards.
    fn cone(&self, at: DVec3) -> Option<Cone> {
        Cone::around_sphere(self.center - at, self.radius)
    }

    pub(super) fn sample(
        &self,
        geometry: &SceneGeometry,
        at: DVec3,
        random: [f64; 2],
    ) -> Option<Incoming> {
        let cone = self.cone(at)?;
        let toward = cone.sample(random);
        let ray = Ray {
            from: at,
            along: toward,
        };
        let far = 2.0 * (at.distance(self.center) + self.radius);
        let hit = geometry.meets(self.shape, &ray, [0.0, far])?;
        let radiance = emitted(&self.emission, &hit.point, hit.normal, -toward);
        Some(Incoming {
            toward,
            distance: hit.distance,
            weight: radiance * cone.solid_angle(),
            density: Some(1.0 / cone.solid_angle()),
        })
    }

    /// Samples a point uniformly by area. Returns the point, its normal, and the radiance at this
    /// point divided by the density.
    pub(super) fn emit(&self, geometry: &SceneGeometry, [a, b]: [f64; 2]) -> (DVec3, DVec3, f64) {
        let (place, normal, point) = geometry.placed(self.shape).sample(0, [a, b]);
        let area = 4.0 * PI * self.radius * self.radius;
        (place, normal, self.emission.value(&point) * area)
    }

    pub(super) fn of_hit(&self, from: DVec3, along: DVec3, hit: &Hit) -> (f64, f64) {
        let radiance = emitted(&self.emission, &hit.point, hit.normal, -along);
        // A hit counts as within the cone, even if rounding errors place it outside the edge.
        let density = self.cone(from).map(|cone| 1.0 / cone.solid_angle());
        (radiance, density.unwrap_or(0.0))
    }
}
