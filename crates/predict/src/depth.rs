//! Computes the distances between a plane and the occluders of its light.

use crate::chain::stands_before;
use crate::off_parallel::passes;
use crate::theory_input::unvisited;
use etendue_field::{Orientation, VirtualPlane};
use etendue_scene::{Object, Scene};
use glam::DVec3;

/// The shortest and the longest distance, in metres, from a plane of the first leg back to
/// the occluders of its light. Returns `None` if there are no occluders, for planes of later legs,
/// and for planes on surfaces.
///
/// The frequencies of a blocker at distance d lie on the line ν = −d ρ. Therefore the frequencies
/// of blockers between two distances fill a wedge (Durand et al. 2005, section 3.2; Egan et al.
/// 2009).
pub(crate) fn depth(scene: &Scene, plane: &VirtualPlane) -> Option<[f64; 2]> {
    if plane.leg > 0 || plane.orientation != Orientation::Orthogonal {
        return None;
    }
    let layers = scene.blockers.iter().map(|layer| layer.distance);
    let layers = layers.filter(|distance| stands_before(*distance, scene, plane));
    let layers = layers.map(|distance| [distance; 2]);
    let others = unvisited(scene).filter_map(|object| {
        let points = match object {
            Object::Surface(i) => scene.surfaces[i].corners().to_vec(),
            Object::Patch(i) => scene.patches[i].patch.corners().to_vec(),
            Object::Mesh(i) => scene.meshes[i].triangles.as_flattened().to_vec(),
        };
        let is_met = passes(scene, plane, &points, false);
        is_met.then(|| extent(&points, plane.distance))
    });
    let all = layers
        .chain(others)
        .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
    Some([plane.distance - all[1], plane.distance - all[0]])
}

/// The smallest and the largest distance along the first leg of points before the plane.
fn extent(points: &[DVec3], end: f64) -> [f64; 2] {
    let low = points.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|p| p.z).fold(0.0, f64::max);
    [low.max(0.0), high.min(end)]
}
