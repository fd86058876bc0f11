//! Compares smooth surfaces of scene files with equivalent solids. Also compares the directions of
//! single rays after these surfaces with computed angles.

use super::check::{SecondCheck, if_planted, largest, worse};
use super::smooth::Smooth;
use super::vector::{
    Axes, Vector, angle, direction, distance, dot, plus, scale, times, turned, unit,
};
use super::world::World;
use crate::hostile::dice::Dice;
use etendue_field::{Frame, Patch, Specular};
use std::f64::consts::PI;
use std::path::Path;

/// Number of points or rays that are compared in each scene.
const EACH: u32 = 20;

const FORMS: &[&str] = &[
    "axes swapped",
    "direction along reversed",
    "hollow instead of convex",
    "curvature is the diameter's",
];
const HITS: &[&str] = &[
    "axes swapped",
    "hollow instead of convex",
    "aperture is a diameter",
];
const EVENTS: &[&str] = &[
    "about the surface, not the normal",
    "indices swapped",
    "sign of the focal length",
];

pub(super) fn checks() -> Vec<SecondCheck> {
    let lengths = (1e-12, "rounding of coordinates of a few metres");
    let grazing = (1e-10, "rounding over the cosine of a ray that grazes");
    let angles = (1e-10, "rounding over the cosine near total reflection");
    vec![
        SecondCheck {
            name: "smooth surface: points and normals",
            rounds: [200, EACH],
            tolerance: lengths,
            faults: FORMS,
            difference: Box::new(points),
        },
        SecondCheck {
            name: "smooth surface: rays that meet it",
            rounds: [200, EACH],
            tolerance: grazing,
            faults: HITS,
            difference: Box::new(hits),
        },
        SecondCheck {
            name: "mirror, refraction, thin lens",
            rounds: [4000, 1],
            tolerance: angles,
            faults: EVENTS,
            difference: Box::new(event),
        },
    ]
}

/// A scene with a surface, the equivalent solid, and the resolved surface.
fn surface(dice: &mut Dice) -> (World, Smooth, Patch) {
    let mut world = World::new(dice);
    let (smooth, words) = Smooth::new(dice, &world, 1.0);
    world.surfaces = words + "Mirror)";
    let scene = world.scene(Path::new("."));
    (world, smooth, scene.patches[0].patch)
}

fn points(dice: &mut Dice, fault: &str) -> f64 {
    let (world, smooth, patch) = surface(dice);
    let smooth = smooth.wrong(fault);
    largest(EACH, || {
        let [s, t] = [dice.between(-0.3, 0.3), dice.between(-0.3, 0.3)];
        let fast = patch.point(s, t);
        let second = smooth.point(s, t);
        let normal = world.light.components(smooth.normal(second));
        let apart = distance(fast.to_array(), world.resolved(second));
        worse(apart, distance(patch.normal(fast).to_array(), normal))
    })
}

/// Compares the points where rays hit a smooth surface of a scene file with the points where they
/// hit the equivalent solid. If a ray hits only one of the two surfaces, the difference counts as
/// one metre.
fn hits(dice: &mut Dice, fault: &str) -> f64 {
    let (world, smooth, patch) = surface(dice);
    let smooth = smooth.wrong(fault);
    largest(EACH, || {
        let start = plus(smooth.axes.origin, 1.5, direction(dice));
        let at = plus(smooth.axes.origin, 0.6 * dice.unit(), direction(dice));
        let towards = unit(plus(at, -1.0, start));
        let frame = &patch.frame;
        let local = frame.to_local(world.resolved(start).into());
        let along = frame.vector_to_local(world.light.components(towards).into());
        let fast = patch.hits(local, along);
        let mut fast: Vec<f64> = fast.into_iter().filter(|t| !t.is_nan()).collect();
        fast.dedup_by(|a, b| a.to_bits() == b.to_bits());
        let second = smooth.hits(start, towards);
        if fast.len() != second.len() {
            return 1.0;
        }
        let apart = fast.iter().zip(&second).map(|(a, b)| (a - b).abs());
        apart.fold(0.0, worse)
    })
}

fn event(dice: &mut Dice, fault: &str) -> f64 {
    let normal = direction(dice);
    let along = direction(dice);
    let lens = Axes::new(direction(dice), normal, direction(dice));
    let point = plus(lens.point([dice.unit(), -dice.unit(), 0.0]), 0.0, normal);
    let event = match dice.below(3) {
        0 => Specular::Mirror,
        1 => Specular::Refraction {
            front: scale(dice, 0.5, 2.0),
            back: scale(dice, 0.5, 2.0),
        },
        _ => Specular::ThinLens {
            focal_length: scale(dice, 0.1, 2.0) * if dice.one_in(2) { 1.0 } else { -1.0 },
        },
    };
    let frame = Frame {
        origin: lens.origin.into(),
        x: lens.x.into(),
        y: lens.y.into(),
        d: lens.d.into(),
    };
    let any_length = times(1.7, along);
    let fast = event.turned(&frame, normal.into(), point.into(), any_length.into());
    let second = match event {
        Specular::Mirror if fault == "about the surface, not the normal" => {
            Some(turned(along, normal, PI))
        }
        // A mirror reverses the direction and rotates it by half a turn about the normal.
        Specular::Mirror => Some(turned(times(-1.0, along), normal, PI)),
        Specular::Refraction { front, back } => {
            let indices = if_planted(fault, "indices swapped", [back, front], [front, back]);
            refracted(along, normal, indices)
        }
        Specular::ThinLens { focal_length } => {
            let sign = if_planted(fault, "sign of the focal length", -1.0, 1.0);
            Some(focused(along, &lens, point, sign * focal_length))
        }
    };
    match (fast, second) {
        (Some(a), Some(b)) => distance(unit(a.to_array()), b),
        (None, None) => 0.0,
        _ => 1.0,
    }
}

/// The direction after refraction, by Snell's law in angles (Born and Wolf 1999, 1.5.1);
/// `None` for total reflection.
pub(super) fn refracted(along: Vector, normal: Vector, [front, back]: [f64; 2]) -> Option<Vector> {
    let is_from_front = dot(along, normal) < 0.0;
    let (ahead, ratio) = if is_from_front {
        (times(-1.0, normal), front / back)
    } else {
        (normal, back / front)
    };
    let sine = ratio * angle(along, ahead).sin();
    (sine < 1.0).then(|| {
        let aside = plus(along, -dot(along, ahead), ahead);
        plus(times(sine.asin().cos(), ahead), ratio, aside)
    })
}

/// Parallel rays meet in the focal plane, where the ray through the lens centre arrives undeviated.
pub(super) fn focused(along: Vector, lens: &Axes, point: Vector, focal_length: f64) -> Vector {
    let ahead = dot(along, lens.d).abs();
    let meet = plus(lens.origin, focal_length / ahead, along);
    unit(times(focal_length.signum(), plus(meet, -1.0, point)))
}
