//! Everything that stops light on its path.

use super::PathSystem;
use crate::barrier::Barrier;
use crate::obstacle::{LegRay, ROUNDING};

/// A system whose masks are prepared for many rays.
#[derive(Debug)]
pub(crate) struct PreparedPath<'a> {
    pub(crate) system: &'a PathSystem,
    masks: Vec<Barrier<'a>>,
}

/// Two distances along a ray are treated as equal if they differ by less than this share.
pub(crate) const SAME_DISTANCE: f64 = 1e-6;

impl<'a> PreparedPath<'a> {
    pub(crate) fn new(system: &'a PathSystem) -> Self {
        let masks = system.masks.iter();
        Self {
            system,
            masks: masks.map(|m| Barrier::new(m.distance, &m.mask)).collect(),
        }
    }

    /// Returns the fraction of a ray's radiance that passes masks, obstacles and surfaces over the
    /// first `length` metres of a leg before the last.
    pub(crate) fn passes(&self, leg: usize, ray: &LegRay, length: f64) -> f64 {
        let end = length * (1.0 - ROUNDING);
        if self.is_hidden(leg, ray, end) {
            return 0.0;
        }
        self.passes_beside(leg, ray, end)
    }

    /// As [`passes`](Self::passes), for a ray that is aimed at a point of the surface at the end of
    /// the leg. The ray does not pass if it meets this surface at another point before.
    pub(crate) fn reaches(&self, leg: usize, ray: &LegRay, length: f64) -> f64 {
        let surface = &self.system.surfaces[leg];
        let is_before = |t: f64| t < length * (1.0 - SAME_DISTANCE);
        if surface.occludes && surface.first(ray, ray.start()).is_some_and(is_before) {
            return 0.0;
        }
        self.passes(leg, ray, length)
    }

    /// Returns the fraction of a ray's radiance that passes over the first `length` metres of the
    /// last leg. A ray that returns to the surface that it has left is lost for every plane.
    pub(crate) fn leaves(&self, ray: &LegRay, length: f64) -> f64 {
        let leg = self.system.visited;
        let last = self.system.before_plane().last();
        let known = last.filter(|last| last.occludes);
        let again = known.is_some_and(|last| last.first(ray, ray.start()).is_some());
        if again || self.is_hidden(leg, ray, length) {
            return 0.0;
        }
        self.passes_beside(leg, ray, length)
    }

    /// Returns the fraction of a ray's radiance that passes masks and obstacles over the first `end`
    /// metres of a leg.
    pub(crate) fn passes_beside(&self, leg: usize, ray: &LegRay, end: f64) -> f64 {
        let start = ray.start();
        let mut passes = 1.0;
        for mask in &self.masks {
            let t = (mask.distance - ray.point.z) / ray.direction.z;
            if start < t && t < end {
                let at = ray.at(t);
                passes *= mask.transmittance(at.x, at.y);
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
        let surfaces = &self.system.surfaces;
        // A path may visit a surface twice.
        let ends = surfaces.get(leg).map(|surface| &surface.name);
        let others = surfaces.iter().filter(|other| other.occludes);
        let mut others = others.filter(|other| Some(&other.name) != ends);
        let start = ray.start();
        others.any(|other| other.distances(ray, start).any(|t| t < end))
    }
}
