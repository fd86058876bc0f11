//! The frames of the central ray at a surface and on the legs before and after it, computed from
//! docs/conventions.md, section Frames.

use super::check::{SecondCheck, if_planted, worse};
use super::smooth::Smooth;
use super::vector::{Axes, Vector, across, angle, cross, dot, plus, times, turned_along, unit};
use super::world::{World, frames_apart, triple};
use crate::hostile::dice::Dice;
use std::path::Path;

const FRAMES: &[&str] = &[
    "X not reversed",
    "frame not turned to the new direction",
    "T reversed",
    "wrong sign of longitude",
    "N in front of transmitted light",
];

const RECTANGLE: &[&str] = &["edges along Y", "facing the other way"];

/// The change of direction of the central ray at a surface.
#[derive(Clone, Copy, Debug)]
pub(super) enum Turn {
    /// A reflection into the given direction, on the side from which the ray came.
    Back(Vector),
    /// A transmission into the given direction.
    Through(Vector),
}

/// Frames at the point that the central ray hits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Legs {
    pub(super) before: Axes,
    pub(super) after: Axes,
    /// The axes T, B, N, and the longitude of the central ray in these axes: first for arriving
    /// light, then for leaving light.
    pub(super) arriving: (Axes, f64),
    pub(super) leaving: (Axes, f64),
}

pub(super) fn checks() -> Vec<SecondCheck> {
    vec![
        SecondCheck {
            name: "frames of legs and surfaces, longitudes",
            rounds: [400, 4],
            tolerance: (1e-11, "rounding of coordinates and turns"),
            faults: FRAMES,
            difference: Box::new(frames),
        },
        SecondCheck {
            name: "frame of a rectangle",
            rounds: [400, 1],
            tolerance: (1e-13, "rounding of coordinates of a few metres"),
            faults: RECTANGLE,
            difference: Box::new(rectangle),
        },
    ]
}

impl Legs {
    /// The frames at a mirror.
    pub(super) fn at_mirror(light: &Axes, smooth: &Smooth, fault: &str) -> Self {
        let (d, n) = (light.d, smooth.axes.d);
        let mirror = Turn::Back(plus(d, -2.0 * dot(d, n), n));
        Self::new(light, smooth.axes.origin, n, mirror, fault)
    }

    pub(super) fn new(light: &Axes, hit: Vector, facing: Vector, turn: Turn, fault: &str) -> Self {
        let before = Axes {
            origin: hit,
            ..*light
        };
        // The normal on the side of the surface from which light comes.
        let normal = times(-dot(facing, light.d).signum(), facing);
        let after = Self::after(&before, normal, turn, fault);
        let t = across(light.d, normal);
        // The tangent, along −X at normal incidence.
        let t = times(-dot(t, light.x).signum(), t);
        let t = if_planted(fault, "T reversed", times(-1.0, t), t);
        let surface = |sign: f64| Axes {
            origin: hit,
            x: times(sign, t),
            y: cross(normal, t),
            d: times(sign, normal),
        };
        // The longitude is measured from N towards T.
        let longitude = |axes: &Axes, away: Vector| {
            let theta = dot(away, axes.x).atan2(dot(away, axes.d));
            if_planted(fault, "wrong sign of longitude", -theta, theta)
        };
        let arriving = surface(1.0);
        let leaving = match turn {
            Turn::Through(_) if fault != "N in front of transmitted light" => surface(-1.0),
            _ => surface(1.0),
        };
        Self {
            before,
            after,
            arriving: (arriving, longitude(&arriving, times(-1.0, light.d))),
            leaving: (leaving, longitude(&leaving, after.d)),
        }
    }

    /// The frame after a change of direction. If the event is a reflection, the frame of
    /// the arriving ray is mirrored, and its X is reversed. Then the frame is rotated by the
    /// smallest angle to the new direction.
    pub(super) fn after(before: &Axes, normal: Vector, turn: Turn, fault: &str) -> Axes {
        let mirrored = |a: Vector| plus(a, -2.0 * dot(a, normal), normal);
        let x_sign = if_planted(fault, "X not reversed", 1.0, -1.0);
        let (x, y, d, to) = match turn {
            Turn::Through(to) => (before.x, before.y, before.d, to),
            Turn::Back(to) => (
                times(x_sign, mirrored(before.x)),
                mirrored(before.y),
                mirrored(before.d),
                to,
            ),
        };
        let along = match fault {
            "frame not turned to the new direction" => |a: Vector, _: Vector, _: Vector| a,
            _ => turned_along,
        };
        Axes {
            origin: before.origin,
            x: along(x, d, to),
            y: along(y, d, to),
            d: to,
        }
    }
}

/// A direction that leaves a surface on the side of the arriving light.
fn leaves(dice: &mut Dice, normal: Vector) -> Vector {
    let tilt = dice.between(0.0, 1.3);
    super::vector::aside(dice, normal, tilt)
}

/// A random event of the central ray at a surface, and the text of the event in a scene
/// file.
fn turn(dice: &mut Dice, light: &Axes, facing: Vector) -> (Turn, String, String) {
    let mirror = plus(light.d, -2.0 * dot(light.d, facing), facing);
    match dice.below(3) {
        0 => (Turn::Back(mirror), "Mirror".to_owned(), String::new()),
        1 => {
            let (front, back) = (dice.between(1.0, 1.2), dice.between(1.2, 2.0));
            let sine = front / back * angle(light.d, times(-1.0, facing)).sin();
            let aside = across(light.d, facing);
            let inwards = times(-(1.0 - sine * sine).sqrt(), facing);
            let through = unit(plus(inwards, sine, aside));
            let words = format!("Refraction(front: {front:?}, back: {back:?})");
            (Turn::Through(through), words, String::new())
        }
        _ => {
            let back = leaves(dice, facing);
            let words = "Reflects(brdf: (lobe: Phong(10)))".to_owned();
            let onwards = format!(", leaves: {}", triple(times(0.5, back)));
            (Turn::Back(back), words, onwards)
        }
    }
}

fn frames(dice: &mut Dice, fault: &str) -> f64 {
    let mut world = World::new(dice);
    let (smooth, words) = Smooth::new(dice, &world, 1.2);
    let facing = smooth.axes.d;
    let (turn, event, onwards) = turn(dice, &world.light, facing);
    world.surfaces = words + &event + ")";
    world.onwards = onwards;
    world.planes = "(name: \"a\", at: Before(\"it\")), (name: \"b\", at: After(\"it\")), \
        (name: \"c\", at: Before(\"it\"), orientation: Tangent), \
        (name: \"d\", at: After(\"it\"), orientation: LocalNormals)"
        .to_owned();
    let scene = world.scene(Path::new("."));
    let legs = Legs::new(&world.light, smooth.axes.origin, facing, turn, fault);
    let across = [(legs.before, 0.0), (legs.after, 0.0)];
    let all = across.into_iter().chain([legs.arriving, legs.leaving]);
    let apart = scene
        .planes
        .iter()
        .zip(all)
        .map(|(plane, (axes, longitude))| {
            let turned = (plane.longitude - longitude).abs();
            worse(frames_apart(&plane.frame, &axes), turned)
        });
    apart.fold(0.0, worse)
}

/// Checks the edges of a rectangle. One edge must be parallel to the component of X that is
/// orthogonal to the rectangle's normal, and the other edge must be perpendicular to this
/// component.
fn rectangle(dice: &mut Dice, fault: &str) -> f64 {
    let mut world = World::new(dice);
    let center = world.light.point([0.0, 0.0, 2.0]);
    let facing = leaves(dice, times(-1.0, world.light.d));
    world.surfaces = format!(
        "Rectangle(name: \"it\", center: {}, size: (3, 2), facing: {})",
        triple(center),
        triple(times(3.0, facing))
    );
    let scene = world.scene(Path::new("."));
    let (facing, along) = match fault {
        "edges along Y" => (facing, world.light.y),
        "facing the other way" => (times(-1.0, facing), world.light.x),
        _ => (facing, world.light.x),
    };
    let fast = world.light.in_world(&scene.surfaces[0].frame);
    frames_apart(&fast, &Axes::new(center, facing, along))
}
