//! Spheres that shine.

use super::incoming::{Incoming, emitted, way};
use crate::space::{Hit, Ray, SceneGeometry};
use etendue_world::Texture;
use glam::{DAffine3, DVec3};
use std::f64::consts::TAU;

/// A sphere that shines outwards, looked for within the cone in which it is seen.
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

    /// 1 − cos of half of the cone's angle; `None` from within, where nothing shines.
    fn cone(&self, at: DVec3) -> Option<f64> {
        let sine2 = self.radius * self.radius / (self.center - at).length_squared();
        // Without cancelling where the cone is narrow.
        (sine2 < 1.0).then(|| sine2 / (1.0 + (1.0 - sine2).sqrt()))
    }

    pub(super) fn sample(
        &self,
        geometry: &SceneGeometry,
        at: DVec3,
        [a, b]: [f64; 2],
    ) -> Option<Incoming> {
        let cone = self.cone(at)?;
        let (axis, distance) = way(at, self.center);
        let fall = a * cone;
        let sine = (fall * (2.0 - fall)).sqrt();
        let (sin, cos) = libm::sincos(TAU * b);
        let (s, t) = axis.any_orthonormal_pair();
        let toward = (sine * (cos * s + sin * t) + (1.0 - fall) * axis).normalize();
        let ray = Ray {
            from: at,
            along: toward,
        };
        let hit = geometry.meets(self.shape, &ray, [0.0, 2.0 * (distance + self.radius)])?;
        let density = 1.0 / (TAU * cone);
        let radiance = emitted(&self.emission, hit.uv, hit.normal, -toward);
        Some(Incoming {
            toward,
            distance: hit.distance,
            weight: radiance / density,
            density: Some(density),
        })
    }

    /// A place drawn evenly over its area, its normal, and the radiance there over the density of places.
    pub(super) fn emit(&self, geometry: &SceneGeometry, [a, b]: [f64; 2]) -> (DVec3, DVec3, f64) {
        let (place, normal, uv) = geometry.placed(self.shape).sample(0, [a, b]);
        let area = 2.0 * TAU * self.radius * self.radius;
        (place, normal, self.emission.value(uv) * area)
    }

    pub(super) fn of_hit(&self, from: DVec3, along: DVec3, hit: &Hit) -> (f64, f64) {
        let radiance = emitted(&self.emission, hit.uv, hit.normal, -along);
        let density = self.cone(from).map_or(0.0, |cone| 1.0 / (TAU * cone));
        (radiance, density)
    }
}
