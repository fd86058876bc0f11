//! Draws a scene to scale in the plane of D and X, or of D and Y, at the light, if the path of the
//! scene turns.

use super::cut::CuttingPlane;
use etendue_field::VirtualPlane;
use etendue_figures::{DrawnObject, DrawnWorld, Segment};
use etendue_scene::{Leg, Scene};
use glam::DVec3;

/// Infinite objects are cut off at this length in metres, which is larger than any drawn scene.
const ENDLESS_METRES: f64 = 1e4;
/// Two legs of the path count as parallel if the modulus of the cosine between them differs from 1
/// by less than this number.
const STRAIGHT: f64 = 1e-9;

/// The drawing of the scene to scale; `None` if the path stays on one line.
pub(super) fn world(scene: &Scene, planes: &[&VirtualPlane]) -> Option<DrawnWorld> {
    let legs = &scene.path.legs;
    let turns = |leg: &Leg| leg.frame.d.dot(legs[0].frame.d).abs() < 1.0 - STRAIGHT;
    let last = legs.iter().any(turns).then(|| legs.last()).flatten()?;
    // The plane in which the path turns more.
    let turn = |axis: usize| {
        let turns = legs.iter().map(|leg| leg.frame.d[axis].abs());
        turns.fold(0.0, f64::max)
    };
    let axis = usize::from(turn(1) > turn(0));
    let point = |leg: &Leg, [z, across]: [f64; 2]| {
        let mut local = DVec3::new(0.0, 0.0, z - leg.start);
        local[axis] = across.clamp(-ENDLESS_METRES, ENDLESS_METRES);
        let place = leg.frame.to_world(local);
        [place.z, place[axis]]
    };
    let pieces = CuttingPlane { scene, axis }.pieces(planes);
    let objects = pieces.into_iter().map(|(leg, segment)| {
        let leg = &legs[leg];
        DrawnObject {
            segment: Segment {
                start: point(leg, segment.start),
                end: point(leg, segment.end),
                ..segment
            },
            light: [leg.frame.d.z, leg.frame.d[axis]],
        }
    });
    let marks = planes.iter().map(|plane| {
        let half = [plane.window.x, plane.window.y][axis].half_width();
        [-half, half].map(|at| point(&legs[plane.leg], [plane.distance, at]))
    });
    // The path continues beyond the last surface, even if there is no plane behind it.
    let way = scene.path.first_hit().min(last.length);
    let farthest = planes.iter().map(|plane| plane.distance);
    let end = farthest.fold(last.start + 0.3 * way, f64::max);
    let corners = legs.iter().map(|leg| point(leg, [leg.start, 0.0]));
    Some(DrawnWorld {
        path: corners.chain([point(last, [end, 0.0])]).collect(),
        objects: objects.collect(),
        planes: marks.collect(),
    })
}
