//! Everything that stops light on its path.

use super::{PathSurface, PathSystem};
use crate::barrier::Barrier;
use crate::obstacle::{BoundingSphere, LegRay, ROUNDING};

/// A system whose masks and surfaces are prepared for many rays.
#[derive(Debug)]
pub(crate) struct PreparedPath<'a> {
    pub(crate) system: &'a PathSystem,
    masks: Vec<Barrier<'a>>,
    /// The surfaces that stop light, each in a sphere.
    occluders: Vec<(BoundingSphere, &'a PathSurface)>,
}

/// The fraction of a ray's radiance that passes a mask, from the index of the mask and the
/// point (x, y) where the ray crosses the mask.
pub(crate) type AtMask<'b> = &'b mut dyn FnMut(usize, [f64; 2]) -> f64;

/// The points where a ray crosses masks, each with the index of the mask.
#[derive(Debug, Default)]
pub(crate) struct MaskCrossings(Vec<(usize, [f64; 2])>);

impl MaskCrossings {
    /// Returns a function that records crossings, and lets all light pass.
    pub(crate) fn record(&mut self) -> impl FnMut(usize, [f64; 2]) -> f64 {
        |mask, at| {
            self.0.push((mask, at));
            1.0
        }
    }
}

/// Two distances along a ray are treated as equal if they differ by less than this share.
pub(crate) const SAME_DISTANCE: f64 = 1e-6;

impl<'a> PreparedPath<'a> {
    pub(crate) fn new(system: &'a PathSystem) -> Self {
        let masks = system.masks.iter();
        let occluders = system.surfaces.iter().filter(|surface| surface.occludes);
        Self {
            system,
            masks: masks.map(|m| Barrier::new(m.distance, &m.mask)).collect(),
            occluders: occluders
                .map(|surface| (BoundingSphere::new(&surface.patch.corners()), surface))
                .collect(),
        }
    }

    /// The function that tells what passes the masks of this system.
    pub(crate) fn at_mask(&self) -> impl FnMut(usize, [f64; 2]) -> f64 {
        |mask, [x, y]| self.masks[mask].transmittance(x, y)
    }

    /// The fraction of a ray's radiance that passes the masks of this system at the points
    /// where the ray crosses them.
    pub(crate) fn through(&self, crossings: &MaskCrossings) -> f64 {
        let mut at_mask = self.at_mask();
        let passes = crossings.0.iter().map(|(mask, at)| at_mask(*mask, *at));
        passes.product()
    }

    /// The fraction of a ray's radiance that passes masks, obstacles and surfaces over the
    /// first `length` metres of a leg before the last.
    pub(crate) fn passes(&self, leg: usize, ray: &LegRay, length: f64, at_mask: AtMask<'_>) -> f64 {
        let end = length * (1.0 - ROUNDING);
        if self.is_hidden(leg, ray, end) {
            return 0.0;
        }
        self.passes_beside(leg, ray, end, at_mask)
    }

    /// As [`passes`](Self::passes), for a ray that is aimed at a point of the surface at the end of
    /// the leg. The ray does not pass if it meets this surface at another point before.
    pub(crate) fn reaches(
        &self,
        leg: usize,
        ray: &LegRay,
        length: f64,
        at_mask: AtMask<'_>,
    ) -> f64 {
        let surface = &self.system.surfaces[leg];
        let is_before = |t: f64| t < length * (1.0 - SAME_DISTANCE);
        if surface.occludes && surface.first(ray, ray.start()).is_some_and(is_before) {
            return 0.0;
        }
        self.passes(leg, ray, length, at_mask)
    }

    /// The fraction of a ray's radiance that passes over the first `length` metres of the
    /// last leg. A ray that returns to the surface that it has left is lost for every plane.
    pub(crate) fn leaves(&self, ray: &LegRay, length: f64, at_mask: AtMask<'_>) -> f64 {
        let leg = self.system.visited;
        let last = self.system.before_plane().last();
        let known = last.filter(|last| last.occludes);
        let again = known.is_some_and(|last| last.first(ray, ray.start()).is_some());
        if again || self.is_hidden(leg, ray, length) {
            return 0.0;
        }
        self.passes_beside(leg, ray, length, at_mask)
    }

    /// The fraction of a ray's radiance that passes masks and obstacles over the first `end`
    /// metres of a leg.
    pub(crate) fn passes_beside(
        &self,
        leg: usize,
        ray: &LegRay,
        end: f64,
        at_mask: AtMask<'_>,
    ) -> f64 {
        let start = ray.start();
        let mut passes = 1.0;
        for (number, mask) in self.masks.iter().enumerate() {
            let t = (mask.distance - ray.point.z) / ray.direction.z;
            if start < t && t < end {
                let at = ray.at(t);
                passes *= at_mask(number, [at.x, at.y]);
                if passes == 0.0 {
                    return 0.0;
                }
            }
        }
        let mut obstacles = self.system.obstacles.iter();
        if obstacles.any(|obstacle| obstacle.stops(leg, ray, end)) {
            return 0.0;
        }
        passes
    }

    /// Checks whether a surface of the path, except the surface that ends the leg, occludes a ray
    /// of the leg.
    fn is_hidden(&self, leg: usize, ray: &LegRay, end: f64) -> bool {
        // A path may visit a surface twice.
        let ends = self.system.surfaces.get(leg).map(|surface| &surface.name);
        let start = ray.start();
        let stops = |other: &PathSurface| {
            Some(&other.name) != ends && other.distances(ray, start).any(|t| t < end)
        };
        let mut occluders = self.occluders.iter();
        occluders.any(|(sphere, other)| sphere.is_near(ray, end) && stops(other))
    }
}
