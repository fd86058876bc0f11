//! Compares photons at a plane perpendicular to the central ray with the same photons in the
//! coordinates of planes on a surface.

use super::check::{SecondCheck, if_planted, relative, worse};
use super::paths::Legs;
use super::smooth::Smooth;
use super::vector::{Axes, Vector, dot, plus, times, turned_along, unit};
use super::world::{World, triple};
use crate::hostile::dice::Dice;
use etendue_field::{Crossing, PhotonSource, TwoPlane, VirtualPlane};
use etendue_trace::Tracer;
use std::path::Path;

/// Number of photons in the only batch.
const EACH: u32 = 32;

const VIEWS: &[&str] = &[
    "wrong sign of longitude",
    "wrong sign of latitude",
    "central normal instead of the local normal",
    "not turned about the normal",
    "foot on the tangent plane",
    "cosines left out",
];

/// The planes under test, each with its orientation in a scene file, whether it records arriving
/// light, and the expected view.
pub(super) const PLANES: [(&str, bool, View); 7] = [
    ("Orthogonal", true, View::Across),
    ("Tangent", true, View::Tangent),
    ("LocalNormals", true, View::Local),
    ("Mirrored", true, View::Mirrored),
    ("Orthogonal", false, View::Across),
    ("Tangent", false, View::Tangent),
    ("LocalNormals", false, View::Local),
];

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum View {
    Across,
    Tangent,
    Local,
    Mirrored,
}

pub(super) fn checks() -> Vec<SecondCheck> {
    vec![SecondCheck {
        name: "coordinates and weights on surfaces",
        rounds: [60, EACH * 5],
        tolerance: (1e-11, "rounding over cosines, and of hits"),
        faults: VIEWS,
        difference: Box::new(difference),
    }]
}

fn difference(dice: &mut Dice, fault: &str) -> f64 {
    let mut world = World::new(dice);
    let (smooth, words) = Smooth::new(dice, &world, 0.7);
    world.lamp = format!(
        "Projector(center: {}, image: (width: (0.08, 0.08)))",
        triple(world.light.origin)
    );
    world.surfaces = words + "Mirror)";
    let planes = PLANES
        .iter()
        .enumerate()
        .map(|(i, (orientation, arrives, _))| {
            let side = if *arrives { "Before" } else { "After" };
            format!(
                "(name: \"p{i}\", at: {side}(\"it\"), orientation: {orientation}, \
             quantity: DifferentialIrradiance)"
            )
        });
    world.planes = planes.collect::<Vec<_>>().join(", ");
    let scene = world.scene(Path::new("."));
    let mut crossings: Vec<Vec<Crossing>> = vec![Vec::new(); PLANES.len()];
    let mut record = |plane: usize, all: &[Crossing]| crossings[plane].extend(all);
    Tracer::new(&scene).emit(0, &mut record, &|_| {});
    let legs = Legs::at_mirror(&world.light, &smooth, fault);
    let mut largest = 0.0;
    for (i, plane) in PLANES.iter().enumerate() {
        let across = if plane.1 { 0 } else { 4 };
        // All planes must record the same photons in the same order.
        if crossings[i].is_empty() || crossings[i].len() != crossings[across].len() {
            return 1.0;
        }
        let looking = Looking::new(&smooth, &legs, *plane);
        for (before, seen) in crossings[across].iter().zip(&crossings[i]) {
            let off = looking.off(&scene.planes[i], before, seen, fault);
            largest = worse(largest, off);
        }
    }
    largest
}

/// A plane on the surface, with the geometry that defines its coordinates.
pub(super) struct Looking<'a> {
    pub(super) smooth: &'a Smooth,
    pub(super) leg: Axes,
    pub(super) surface: Axes,
    pub(super) longitude: f64,
    pub(super) arrives: bool,
    pub(super) view: View,
}

impl Looking<'_> {
    pub(super) fn new<'a>(
        smooth: &'a Smooth,
        legs: &Legs,
        (_, arrives, view): (&str, bool, View),
    ) -> Looking<'a> {
        let (leg, (surface, longitude)) = if arrives {
            (legs.before, legs.arriving)
        } else {
            (legs.after, legs.leaving)
        };
        // If light is rotated about the normal, its longitude becomes the longitude of the mirror
        // direction.
        let turned = if view == View::Mirrored { -1.0 } else { 1.0 };
        Looking {
            smooth,
            leg,
            surface,
            longitude: turned * longitude,
            arrives,
            view,
        }
    }

    /// How far coordinates, weight and the factor of differential irradiance deviate from
    /// values computed from the same ray at a plane perpendicular to the leg.
    fn off(&self, plane: &VirtualPlane, across: &Crossing, seen: &Crossing, fault: &str) -> f64 {
        let ray = across.ray;
        let secant_squared = 1.0 + ray.u * ray.u + ray.v * ray.v;
        let factor = plane.factor(&seen.ray);
        if self.view == View::Across {
            return relative(factor, secant_squared.powi(-2));
        }
        let foot = self.leg.point([ray.x, ray.y, 0.0]);
        let along = unit(self.leg.vector([ray.u, ray.v, 1.0]));
        let Some(second) = self.seen(foot, along, fault) else {
            return 1.0;
        };
        let [.., u, phi] = second;
        let cosines = (u + self.longitude).cos() * phi.cos() * phi.cos();
        let per_flux = if_planted(fault, "cosines left out", 1.0, cosines);
        // Flux Φ has weight Φ (1 + u² + v²)² at the plane perpendicular to the leg, and Φ/(cos θ
        // cos² φ) on the surface.
        let weight = across.weight / (secant_squared * secant_squared) / per_flux;
        let TwoPlane { x, y, u, v } = seen.ray;
        let z = [x, y, u, v].into_iter().zip(second);
        let z = z.fold(0.0, |most, (a, b)| worse(most, (a - b).abs()));
        let factors = worse(relative(seen.weight, weight), relative(factor, cosines));
        worse(z, factors)
    }

    /// The coordinates of the ray through a point along a unit vector.
    pub(super) fn seen(&self, foot: Vector, along: Vector, fault: &str) -> Option<[f64; 4]> {
        if self.view == View::Across {
            let [x, y, z] = self.leg.coordinates(foot);
            let [dx, dy, dz] = self.leg.components(along);
            let [u, v] = [dx / dz, dy / dz];
            return Some([x - z * u, y - z * v, u, v]);
        }
        let (point, normal) = self.met(foot, along, fault)?;
        let central = "central normal instead of the local normal";
        let normal = if_planted(fault, central, self.surface.d, normal);
        let turned = |axis: Vector| turned_along(axis, self.surface.d, normal);
        let away = times(if self.arrives { -1.0 } else { 1.0 }, along);
        let axes = [self.surface.x, self.surface.y, self.surface.d];
        let [t, b, n] = axes.map(|axis| dot(away, turned(axis)));
        // The direction is cos φ (sin θ T + cos θ N) + sin φ B.
        let (mut theta, mut phi) = (t.atan2(n), b.asin());
        if self.view == View::Mirrored && fault != "not turned about the normal" {
            (theta, phi) = (-theta, -phi);
        }
        if fault == "wrong sign of latitude" {
            phi = -phi;
        }
        let [s, t, _] = self.surface.coordinates(point);
        Some([s, t, theta - self.longitude, phi])
    }

    /// The point where the line of a ray meets the plane's surface, and the normal at this
    /// point. If there are several such points, returns the point nearest to the central hit.
    fn met(&self, foot: Vector, along: Vector, fault: &str) -> Option<(Vector, Vector)> {
        let n = self.surface.d;
        let tangent = || {
            let off = dot(plus(self.surface.origin, -1.0, foot), n) / dot(along, n);
            plus(foot, off, along)
        };
        if self.view == View::Tangent {
            return Some((tangent(), n));
        }
        let hits = self.smooth.hits(foot, along).into_iter();
        let t = hits.min_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        let point = plus(foot, t, along);
        let normal = self.smooth.normal(point);
        let point = if_planted(fault, "foot on the tangent plane", tangent(), point);
        Some((point, normal))
    }
}
