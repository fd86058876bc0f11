//! Compares the scene of a further light with the places that the scene file states.

use super::check::{SecondCheck, largest, worse};
use super::vector::{distance, dot, plus};
use super::world::{World, pair, triple};
use crate::hostile::dice::Dice;
use etendue_field::{Light, Shape};
use glam::DVec3;
use std::path::Path;

/// Rays per light.
const EACH: u32 = 50;

pub(super) fn checks() -> Vec<SecondCheck> {
    vec![SecondCheck {
        name: "further light: rays at blockers and at a plane",
        rounds: [100, EACH],
        tolerance: (1e-12, "rounding of positions"),
        faults: &[
            "at the depth of the first",
            "on the central ray",
            "axes swapped",
        ],
        difference: Box::new(rays),
    }]
}

/// Follows rays from points of a further light to a blocker and to a plane. The scene of the light
/// gives their coordinates there; the second implementation intersects lines with planes in the
/// world.
fn rays(dice: &mut Dice, fault: &str) -> f64 {
    let mut world = World::new(dice).with_wall(1.0);
    let size = [dice.between(0.1, 0.5), dice.between(0.1, 0.5)];
    let [x, y] = [dice.between(0.2, 0.6), dice.between(-0.6, -0.2)];
    let place = [x, y, dice.between(-0.6, 0.4)];
    let card = world.light.point([0.0, 0.0, 0.5]);
    world.lamp = format!(
        "{}, other_lights: [Rectangle(center: {}, size: {})]",
        world.lamp,
        triple(world.light.point(place)),
        pair(size)
    );
    world.blockers = format!(
        "Shapes(name: \"card\", center: {}, shapes: [Disc(center: (0, 0), radius: 0.1)])",
        triple(card)
    );
    let scene = world.scene(Path::new("."));
    let [other] = &scene.other_lights[..] else {
        return f64::NAN;
    };
    let Light::Area {
        shape: Shape::Rectangle(rectangle),
        ..
    } = other.light
    else {
        return f64::NAN;
    };
    let place = match fault {
        "at the depth of the first" => [place[0], place[1], 0.0],
        "on the central ray" => [0.0, 0.0, place[2]],
        "axes swapped" => [place[1], place[0], place[2]],
        _ => place,
    };
    let distances = [other.blockers[0].distance, other.planes[0].distance];
    largest(EACH, || {
        let share = [dice.between(-0.5, 0.5), dice.between(-0.5, 0.5)];
        let slopes = [dice.between(-1.0, 1.0), dice.between(-1.0, 1.0)];
        let from = [0, 1].map(|i| rectangle.center[i] + share[i] * rectangle.size[i]);
        let start = [0, 1].map(|i| place[i] + share[i] * size[i]);
        let start = world.light.point([start[0], start[1], place[2]]);
        let fast = other.path.frame.to_world(DVec3::new(from[0], from[1], 0.0));
        let mut off = distance(fast.to_array(), start);
        let axes = world.light;
        let along = plus(plus(axes.d, slopes[0], axes.x), slopes[1], axes.y);
        for (length, of_first) in distances.into_iter().zip([0.5, 1.0]) {
            let height = dot(plus(start, -1.0, axes.origin), axes.d);
            let hit = plus(start, of_first - height, along);
            let [x, y, _] = axes.coordinates(hit);
            let fast = [0, 1].map(|i| from[i] + length * slopes[i]);
            off = worse(off, worse((fast[0] - x).abs(), (fast[1] - y).abs()));
        }
        off
    })
}
