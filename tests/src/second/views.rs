//! Coordinates of planes on surfaces: photons that cross a plane across the central ray, and the
//! same photons as planes on the surface have them.

use super::check::{Check, relative, worse};
use super::paths::{Legs, Turn};
use super::smooth::Smooth;
use super::vector::{Axes, Vector, dot, plus, times, turned_along, unit};
use super::world::{World, triple};
use crate::hostile::dice::Dice;
use etendue_field::{Crossing, PhotonSource, VirtualPlane};
use etendue_trace::Tracer;
use std::path::Path;

/// Photons of a batch, of which there is one.
const EACH: u32 = 32;

const VIEWS: &[&str] = &[
    "sign of longitude",
    "sign of latitude",
    "the central normal",
    "not turned about the normal",
    "foot on the tangent plane",
    "cosines left out",
];

/// Planes, each with whether light arrives there, and its orientation.
const PLANES: [(&str, bool, View); 7] = [
    ("Orthogonal", true, View::Across),
    ("Tangent", true, View::Tangent),
    ("LocalNormals", true, View::Local),
    ("Mirrored", true, View::Mirrored),
    ("Orthogonal", false, View::Across),
    ("Tangent", false, View::Tangent),
    ("LocalNormals", false, View::Local),
];

#[derive(Clone, Copy, Debug, PartialEq)]
enum View {
    Across,
    Tangent,
    Local,
    Mirrored,
}

pub(super) fn checks() -> Vec<Check> {
    vec![Check {
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
    let (d, n) = (world.light.d, smooth.axes.d);
    let mirror = Turn::Back(plus(d, -2.0 * dot(d, n), n));
    let legs = Legs::new(&world.light, smooth.axes.origin, n, mirror, fault);
    let mut largest = 0.0;
    for (i, (_, arrives, view)) in PLANES.iter().enumerate() {
        let (across, frames) = if *arrives {
            (0, (legs.before, legs.arriving))
        } else {
            (4, (legs.after, legs.leaving))
        };
        // The same photons in the same order.
        if crossings[i].is_empty() || crossings[i].len() != crossings[across].len() {
            return 1.0;
        }
        let looking = Looking {
            smooth: &smooth,
            leg: frames.0,
            surface: frames.1.0,
            longitude: frames.1.1,
            arrives: *arrives,
            view: *view,
        };
        for (before, seen) in crossings[across].iter().zip(&crossings[i]) {
            let off = looking.off(&scene.planes[i], before, seen, fault);
            largest = worse(largest, off);
        }
    }
    largest
}

/// How a plane looks at the surface.
struct Looking<'a> {
    smooth: &'a Smooth,
    leg: Axes,
    surface: Axes,
    longitude: f64,
    arrives: bool,
    view: View,
}

impl Looking<'_> {
    /// How far coordinates, weight and the factor of differential irradiance are from those of the
    /// ray across the leg.
    fn off(&self, plane: &VirtualPlane, across: &Crossing, seen: &Crossing, fault: &str) -> f64 {
        let ray = across.ray;
        let secant_squared = 1.0 + ray.u * ray.u + ray.v * ray.v;
        let factor = plane.factor(&seen.ray);
        if self.view == View::Across {
            return relative(factor, secant_squared.powi(-2));
        }
        let foot = self.leg.point([ray.x, ray.y, 0.0]);
        let along = unit(self.leg.vector([ray.u, ray.v, 1.0]));
        let Some((point, normal)) = self.met(foot, along, fault) else {
            return 1.0;
        };
        let turned = |axis: Vector| match fault {
            "the central normal" => axis,
            _ => turned_along(axis, self.surface.d, normal),
        };
        let away = times(if self.arrives { -1.0 } else { 1.0 }, along);
        let [t, b, n] =
            [self.surface.x, self.surface.y, self.surface.d].map(|axis| dot(away, turned(axis)));
        // cos φ (sin θ T + cos θ N) + sin φ B
        let (mut theta, mut phi) = (t.atan2(n), b.asin());
        let mut center = self.longitude;
        if self.view == View::Mirrored {
            center = -center;
            if fault != "not turned about the normal" {
                (theta, phi) = (-theta, -phi);
            }
        }
        if fault == "sign of latitude" {
            phi = -phi;
        }
        let [s, t, _] = self.surface.coordinates(point);
        let cosines = theta.cos() * phi.cos() * phi.cos();
        let per_flux = if fault == "cosines left out" {
            1.0
        } else {
            cosines
        };
        // Flux Φ adds Φ (1 + u² + v²)² across the leg, Φ/(cos θ cos² φ) on the surface.
        let weight = across.weight / (secant_squared * secant_squared) / per_flux;
        let z = [
            s - seen.ray.x,
            t - seen.ray.y,
            theta - center - seen.ray.u,
            phi - seen.ray.v,
        ];
        let z = z.into_iter().fold(0.0, |most, off| worse(most, off.abs()));
        worse(
            z,
            worse(relative(seen.weight, weight), relative(factor, cosines)),
        )
    }

    /// Where the line of a ray meets what the plane looks at, nearest to the central hit, and the
    /// normal there.
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
        let point = match fault {
            "foot on the tangent plane" => tangent(),
            _ => point,
        };
        Some((point, normal))
    }
}
