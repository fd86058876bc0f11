//! Emitting spheres and other emitting shapes.

use super::incoming::{Incoming, emitted, way};
use crate::space::{Hit, Ray, SceneGeometry};
use etendue_sampling::{Cone, DiscreteDistribution};
use etendue_world::{Texture, TexturePoint};
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;

/// An emitting shape, sampled uniformly by area.
#[derive(Debug)]
pub(super) struct ShiningShape {
    shape: usize,
    emission: Texture,
    /// Whether the back emits as the front does.
    is_two_sided: bool,
    /// The distribution that draws pieces of the shape in proportion to their area.
    pieces: DiscreteDistribution,
}

impl ShiningShape {
    pub(super) fn new(shape: usize, areas: &[f64], emission: Texture, is_two_sided: bool) -> Self {
        Self {
            shape,
            is_two_sided,
            emission,
            pieces: DiscreteDistribution::new(areas.iter().copied()),
        }
    }

    fn area(&self) -> f64 {
        self.pieces.total()
    }

    #[inline]
    pub(super) fn sample(
        &self,
        geometry: &SceneGeometry,
        at: DVec3,
        [a, b, c]: [f64; 3],
    ) -> Option<Incoming> {
        let (place, normal, point) = self.place(geometry, [a, b, c])?;
        let (toward, distance) = way(at, place);
        let density = self.density(distance, normal.dot(toward));
        let radiance = self.radiance(&point, normal, -toward);
        (radiance > 0.0 && density.is_finite()).then(|| Incoming {
            toward,
            distance,
            weight: radiance / density,
            density: Some(density),
        })
    }

    /// Samples a point uniformly by area. Returns the point, its normal, and the point as
    /// textures see it.
    #[inline]
    fn place(
        &self,
        geometry: &SceneGeometry,
        [a, b, c]: [f64; 3],
    ) -> Option<(DVec3, DVec3, TexturePoint)> {
        let placed = geometry.placed(self.shape);
        (self.area() > 0.0).then(|| placed.sample(self.pieces.sample(c), [a, b]))
    }

    /// A point, its normal on the side that emits, and the radiance at this point divided
    /// by the density. The last random number chooses the side.
    pub(super) fn emit(
        &self,
        geometry: &SceneGeometry,
        [a, b, c, side]: [f64; 4],
    ) -> Option<(DVec3, DVec3, f64)> {
        let (place, normal, point) = self.place(geometry, [a, b, c])?;
        let shine = self.emission.value(&point) * self.area();
        Some(match self.is_two_sided {
            true if side < 0.5 => (place, -normal, 2.0 * shine),
            true => (place, normal, 2.0 * shine),
            false => (place, normal, shine),
        })
    }

    /// The radiance emitted in a direction.
    #[inline]
    fn radiance(&self, point: &TexturePoint, normal: DVec3, away: DVec3) -> f64 {
        match self.is_two_sided {
            true => self.emission.value(point),
            false => emitted(&self.emission, point, normal, away),
        }
    }

    /// The density, per solid angle, of a point at a distance. `cosine` is the cosine of
    /// the angle between the normal at the point and the direction to it.
    #[inline]
    fn density(&self, distance: f64, cosine: f64) -> f64 {
        distance * distance / (cosine.abs() * self.area())
    }

    #[inline]
    pub(super) fn of_hit(&self, along: DVec3, hit: &Hit) -> (f64, f64) {
        let radiance = self.radiance(&hit.point, hit.normal, -along);
        (radiance, self.density(hit.distance, hit.normal.dot(along)))
    }
}

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

    /// The cone that the sphere subtends at a point. Returns `None` for a point inside the
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
        let ray = Ray::new(at, toward);
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
