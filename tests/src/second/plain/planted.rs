//! Faults of the resolved scene, which theory and both tracers would share.

use etendue_field::{Light, Mask, Shape};
use etendue_scene::{Object, Scene};
use glam::DVec3;

/// The faults by their names.
pub(super) const FAULTS: [&str; 6] = [
    "masks before a further light forgotten",
    "a mask moved aside",
    "a surface turned by 5°",
    "a side of a light off by 20 %",
    "legs of a further light begin at the first light",
    "two surfaces visited in the wrong order",
];

/// 5°, radians.
const TURN: f64 = 0.087;
/// The share of the first leg by which a mask is moved.
const ASIDE: f64 = 0.05;

/// Plants a fault in the scene of each light; returns whether one of them has what it changes.
pub(super) fn plant(fault: &str, scene: &mut Scene) -> bool {
    let first = scene.path.first_hit();
    let mut is_planted = plant_in_light(fault, scene, 0.0);
    for other in &mut scene.other_lights {
        let depth = first - other.path.first_hit();
        is_planted |= plant_in_light(fault, other, depth);
    }
    is_planted
}

/// Plants a fault in the scene of a light at a depth behind the first light.
fn plant_in_light(fault: &str, scene: &mut Scene, depth: f64) -> bool {
    match fault {
        "masks before a further light forgotten" => {
            let before = scene.blockers.len();
            scene.blockers.retain(|layer| layer.distance > 0.0);
            scene.blockers.len() < before
        }
        "a mask moved aside" => {
            let (by, mut is_moved) = (ASIDE * scene.path.first_hit(), false);
            for layer in &mut scene.blockers {
                if let Mask::Opaque {
                    shapes,
                    half_planes,
                } = &mut layer.mask
                {
                    is_moved = true;
                    half_planes.iter_mut().for_each(|half| half.edge += by);
                    for shape in shapes {
                        match shape {
                            Shape::Rectangle(rectangle) => rectangle.center[0] += by,
                            Shape::Disc(disc) => disc.center[0] += by,
                        }
                    }
                }
            }
            is_moved
        }
        "a surface turned by 5°" => {
            let turn = |d: DVec3, x: DVec3| (d + TURN * x).normalize();
            for surface in &mut scene.surfaces {
                let frame = &mut surface.frame;
                *frame = frame.turned_to(turn(frame.d, frame.x));
            }
            for object in &mut scene.patches {
                let frame = &mut object.patch.frame;
                *frame = frame.turned_to(turn(frame.d, frame.x));
            }
            true
        }
        "a side of a light off by 20 %" => match &mut scene.light {
            Light::Area {
                shape: Shape::Rectangle(rectangle),
                ..
            } => {
                rectangle.size[0] *= 1.2;
                true
            }
            _ => false,
        },
        "legs of a further light begin at the first light" => {
            for leg in scene.path.legs.iter_mut().skip(1) {
                leg.start += depth;
            }
            depth != 0.0 && scene.planes.iter().any(|plane| plane.leg > 0)
        }
        "two surfaces visited in the wrong order" => {
            let hits: Vec<_> = scene.path.legs.iter().map(|leg| leg.leaves).collect();
            let is_long = hits.len() > 2 && scene.planes.iter().any(|plane| plane.leg > 1);
            if let [_, Some(a), Some(b), ..] = hits[..]
                && is_long
            {
                let objects: [Object; 2] = [a.object, b.object];
                for (leg, object) in [(1, objects[1]), (2, objects[0])] {
                    if let Some(hit) = &mut scene.path.legs[leg].leaves {
                        hit.object = object;
                    }
                }
            }
            is_long
        }
        _ => false,
    }
}
