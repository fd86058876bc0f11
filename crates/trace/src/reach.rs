//! Computes the regions from which light can reach the window of a virtual plane. Emission and
//! scattering are aimed at the computed regions.

use crate::line::{direction, start};
use crate::plane_on_leg::PlaneOnLeg;
use etendue_field::{
    Frame, Orientation, Patch, Profile, Side, TwoPlane, VirtualPlane, box_corners, enclosing,
};
use etendue_scene::{Event, Hit, Leg, Object, Scene, Surface};
use glam::{DVec2, DVec3};

/// The half-widths of a box around the central ray, in the plane at the end of `leg`. All
/// light from `origins` (in the frame of the leg) that can reach the window of `plane` passes
/// through this box. `plane` lies on a later leg, or on the surface that ends `leg`. Returns `None`
/// if no light reaches the window. Also returns `None` if light must travel perpendicular to a
/// later leg, or back along a later leg.
pub(crate) fn reach(
    scene: &Scene,
    plane: &VirtualPlane,
    leg: usize,
    origins: &[DVec3],
) -> Option<[f64; 2]> {
    let this = &scene.path.legs[leg];
    // A virtual plane that records the light arriving at a surface sees no light that has left
    // this surface.
    let before = leg + 1 == plane.leg && !looks_at_surface(plane);
    let points = if before || leg == plane.leg {
        seen(scene, plane)
    } else {
        // Diffuse light can reach the window from anywhere on the next surface.
        outline(scene, scene.path.ends_at(leg)?.object)
    };
    let points: Vec<DVec3> = points.iter().map(|p| this.frame.to_local(*p)).collect();
    let mut half = [0.0_f64; 2];
    for from in origins {
        for to in &points {
            let ahead = to.z - from.z;
            if leg > 0 && ahead < MIN_COSINE * this.length {
                return None;
            }
            // Light cannot reach points behind the point from which it leaves.
            let share = (this.length - from.z) / ahead.max(MIN_COSINE * this.length);
            let at = from.lerp(*to, share);
            half = [half[0].max(at.x.abs()), half[1].max(at.y.abs())];
        }
    }
    (!points.is_empty()).then_some(half.map(|h| h * (1.0 + MARGIN)))
}

/// The corners of the region that light can leave, in the frame at the light. For a mesh,
/// returns the corners of the bounding box.
pub(crate) fn outline(scene: &Scene, object: Object) -> Vec<DVec3> {
    match object {
        Object::Surface(i) => scene.surfaces[i].corners().to_vec(),
        Object::Mesh(i) => {
            let [low, high] = scene.meshes[i].triangles.bounds();
            box_corners(low, high).to_vec()
        }
        Object::Patch(i) => scene.patches[i].patch.corners().to_vec(),
    }
}

/// The part of a flat first surface from which light can reach the window of a virtual
/// plane on this surface or beyond it. The result is the lowest and the highest coordinates of
/// this part in the surface's frame, or `None` if there is no such part.
pub(crate) fn footprint(
    scene: &Scene,
    plane: &VirtualPlane,
    surface: &Surface,
) -> Option<[DVec2; 2]> {
    let across = plane.orientation == Orientation::Orthogonal;
    let is_on_it = plane.leg == usize::from(plane.side == Side::After);
    let points = match (across, plane.leg) {
        (true, 1) => seen(scene, plane),
        (false, _) if is_on_it => corners(scene, plane),
        _ => surface.corners().to_vec(),
    };
    let points: Vec<DVec2> = points
        .iter()
        .map(|p| surface.frame.to_local(*p).truncate())
        .collect();
    let end = 0.5 * DVec2::from(surface.size);
    let low = points.iter().copied().reduce(DVec2::min)?;
    let high = points.iter().copied().reduce(DVec2::max)?;
    let margin = MARGIN * end;
    let [low, high] = [(low - margin).max(-end), (high + margin).min(end)];
    low.cmplt(high).all().then_some([low, high])
}

/// The corners of the window of a virtual plane, in the frame at the light.
fn corners(scene: &Scene, plane: &VirtualPlane) -> Vec<DVec3> {
    let half = [&plane.window.x, &plane.window.y].map(Profile::half_width);
    let half = DVec3::new(half[0], half[1], 0.0);
    let to_light = |p: DVec3| scene.path.frame.to_local(plane.frame.to_world(p));
    box_corners(-half, half).map(to_light).to_vec()
}

/// The corners of a region of a virtual plane's surface that contains everything that the
/// plane's window sees.
fn seen(scene: &Scene, plane: &VirtualPlane) -> Vec<DVec3> {
    let leg = &scene.path.legs[plane.leg];
    let arriving = looks_at_surface(plane);
    let met = if arriving {
        scene.path.ends_at(plane.leg)
    } else {
        leg.leaves.as_ref()
    };
    let Some(hit) = met else {
        return Vec::new();
    };
    let all = outline(scene, hit.object);
    let i = match hit.object {
        Object::Patch(i) if arriving && plane.orientation.is_local() => {
            return seen_of_patch(scene, plane, hit, &scene.patches[i].patch).unwrap_or(all);
        }
        // Where a tangent plane extends beyond the surface, the plane sees light that passes beside
        // the surface.
        _ if arriving => return corners(scene, plane),
        Object::Surface(i) => i,
        Object::Patch(i) if reflects(scene, hit.object) => {
            return seen_of_patch(scene, plane, hit, &scene.patches[i].patch).unwrap_or(all);
        }
        Object::Patch(_) | Object::Mesh(_) => return all,
    };
    let surface = &scene.surfaces[i];
    let met: Option<Vec<DVec3>> = if plane.orientation == Orientation::Orthogonal {
        // The outermost rays that cross the window meet the surface at the corners of the visible
        // part.
        let tube = tube(plane, scene.path.along(plane), leg);
        let side = leg.frame.d.dot(surface.frame.d).signum();
        let met = tube.iter();
        met.map(|[from, to]| meets(*from, *to, &surface.frame, side))
            .collect()
    } else {
        let corners = corners(scene, plane).into_iter();
        Some(corners.map(|p| surface.frame.to_local(p)).collect())
    };
    let Some(met) = met else { return all };
    let mut points = Vec::new();
    let extent = |axis: usize| {
        let along = met.iter().map(|p| p[axis]);
        let low = along.clone().fold(f64::INFINITY, f64::min);
        let high = along.fold(f64::NEG_INFINITY, f64::max);
        let end = 0.5 * surface.size[axis];
        [low.max(-end), high.min(end)]
    };
    let [x, y] = [extent(0), extent(1)];
    if x[0] < x[1] && y[0] < y[1] {
        for [x, y] in [[x[0], y[0]], [x[1], y[0]], [x[0], y[1]], [x[1], y[1]]] {
            points.push(surface.frame.to_world(DVec3::new(x, y, 0.0)));
        }
    }
    points
}

/// Checks whether an object is a patch with a BRDF.
pub(crate) fn reflects(scene: &Scene, object: Object) -> bool {
    matches!(object, Object::Patch(i) if matches!(scene.patches[i].event, Event::Reflects(_)))
}

/// Checks whether a virtual plane records the light that arrives on a surface, in coordinates of
/// the surface.
pub(crate) fn looks_at_surface(plane: &VirtualPlane) -> bool {
    plane.orientation != Orientation::Orthogonal && plane.side == Side::Before
}

/// The window of a virtual plane sees a part of a patch. Returns the corners of a box around this
/// part, in the frame at the light; `None` if the window may see the entire patch.
fn seen_of_patch(
    scene: &Scene,
    plane: &VirtualPlane,
    hit: &Hit,
    patch: &Patch,
) -> Option<Vec<DVec3>> {
    let sharpest = patch.curvature.iter().fold(0.0_f64, |k, l| k.max(l.abs()));
    if 2.0 * patch.aperture * sharpest >= 1.0 {
        return None;
    }
    let leg = &scene.path.legs[plane.leg];
    let plane_on_leg = PlaneOnLeg::new(scene, 0, plane);
    let at = Frame {
        origin: hit.point,
        ..match plane.orientation {
            Orientation::Orthogonal => Frame::IDENTITY.turned_to(hit.normal),
            _ => scene.path.frame.decompose(&plane.frame),
        }
    };
    let w = &plane.window;
    let ends = |profile: &Profile| [-1.0, 1.0].map(|s| s * profile.half_width());
    let mut rays = Vec::new();
    for x in ends(&w.x) {
        for y in ends(&w.y) {
            if plane.orientation.is_local() {
                // For a virtual plane on the surface, the window's positions are points of the
                // surface, so the rays run along the normal.
                rays.push([DVec3::new(x, y, 0.0), DVec3::Z]);
                continue;
            }
            for u in ends(&w.u) {
                for v in ends(&w.v) {
                    let ray = plane_on_leg.leg_ray(&TwoPlane { x, y, u, v })?.0;
                    let from = leg.frame.to_world(start(&ray));
                    let along = leg.frame.vector_to_world(direction(&ray));
                    rays.push([at.to_local(from), at.vector_to_local(along)]);
                }
            }
        }
    }
    // If light leaves nearly parallel to the surface or behind it, the part of the surface from
    // which the light comes is unbounded.
    if rays.iter().any(|[_, along]| along.z < MIN_COSINE) {
        return None;
    }
    let corners = patch.corners().map(|p| at.to_local(p));
    let [mut low, mut high] = enclosing(&corners);
    // If a point of the patch is at the distance r from the normal line at the hit, it lies at most
    // |k| r² from the tangent plane. Within the slab of points at most |k| r² from the tangent
    // plane, lines through the window stay inside a box. The box is computed repeatedly; the first
    // computation uses the box of the entire patch.
    for _ in 0..8 {
        let [x, y] = [low.x.abs().max(high.x.abs()), low.y.abs().max(high.y.abs())];
        let depth = sharpest * (x * x + y * y);
        (low.z, high.z) = (low.z.max(-depth), high.z.min(depth));
        let met = rays.iter().flat_map(|[from, along]| {
            [low.z, high.z].map(|z| *from + (z - from.z) / along.z * *along)
        });
        let met: Vec<DVec3> = met.collect();
        let [least, most] = enclosing(&met);
        (low, high) = (low.max(least), high.min(most));
    }
    let is_empty = low.x > high.x || low.y > high.y;
    let center = 0.5 * (low + high);
    let corners = || box_corners(low - center, high - center).map(|p| at.to_world(center + p));
    Some(if is_empty {
        Vec::new()
    } else {
        corners().to_vec()
    })
}

/// The rays that pass through the corners of a window with the window's extreme slopes.
/// Each ray is given by two points in the frame at the light.
fn tube(plane: &VirtualPlane, along: f64, leg: &Leg) -> Vec<[DVec3; 2]> {
    let w = &plane.window;
    let ends = |profile: &Profile| [-1.0, 1.0].map(|s| s * profile.half_width());
    let mut rays = Vec::new();
    for x in ends(&w.x) {
        for u in ends(&w.u) {
            for y in ends(&w.y) {
                for v in ends(&w.v) {
                    let at = DVec3::new(x, y, along);
                    let to = at + DVec3::new(u, v, 1.0);
                    rays.push([at, to].map(|p| leg.frame.to_world(p)));
                }
            }
        }
    }
    rays
}

/// The point where the line through two points meets the plane of a surface, in the
/// surface's frame. Returns `None` if the line runs to the other side of the surface or parallel
/// to it.
fn meets(from: DVec3, to: DVec3, surface: &Frame, side: f64) -> Option<DVec3> {
    let [a, b] = [from, to].map(|p| surface.to_local(p));
    let leaves = (b - a).z;
    (side * leaves > MIN_COSINE).then(|| a - (a.z / leaves) * (b - a))
}

/// If the cosine of the angle between light and a normal is below this limit, the light counts as
/// parallel to the surface. The same limit holds for a distance, as a share of a leg's length.
const MIN_COSINE: f64 = 1e-3;
/// The aimed region exceeds the visible region by this margin, to allow for rounding errors.
const MARGIN: f64 = 1e-9;
