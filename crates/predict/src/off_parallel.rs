//! Finds the reasons why the theory of light between parallel planes does not apply.

use etendue_field::{Frame, Mask, Orientation, Profile, Quantity, Side, VirtualPlane};
use etendue_scene::{BlockerLayer, Hit, Object, Scene, Surface};
use etendue_theory::without_closed_form;
use glam::DVec3;

/// The reasons why the theory does not apply to a plane, in words: oblique incidence, other
/// objects in the way, or light that the theory does not cover. The list is empty where the theory
/// applies.
pub(crate) fn obstacles_to_theory(scene: &Scene, plane: &VirtualPlane) -> Vec<String> {
    let mut found = Vec::new();
    for legs in scene.path.legs[..=plane.leg].windows(2) {
        let [before, leg] = legs else { continue };
        if let Some(Hit { object, normal, .. }) = &leg.leaves {
            let [incidence, outgoing] = [-before.frame.d, leg.frame.d]
                .map(|d| libm::acos(d.dot(*normal).clamp(-1.0, 1.0)).to_degrees());
            let is_flat = matches!(object, Object::Surface(_));
            if outgoing > ROUNDING || incidence > ROUNDING || !is_flat {
                let name = scene.name_of(*object);
                found.push(format!(
                    "incidence on {name} at {incidence:.4}°, outgoing at {outgoing:.4}°"
                ));
            }
        }
    }
    // On the first leg, the rays of a file are summed, which needs no closed form.
    let is_sum = plane.leg == 0 && scene.light.listed().is_some();
    let unknown = without_closed_form(&scene.light).filter(|_| !is_sum);
    found.extend(unknown.map(str::to_owned));
    if plane.orientation != Orientation::Orthogonal {
        found.push(format!("{:?}", plane.orientation));
    }
    if plane.leg > 0 && plane.quantity == Quantity::DifferentialIrradiance {
        found.push("the cosine of light that a surface has reflected".to_owned());
    }
    if plane.leg > 1 {
        found.push(format!("{} reflections in a row", plane.leg));
    }
    found.extend(in_the_way(scene, plane));
    if let Some(name) = beyond_edge(scene, plane) {
        found.push(format!("the edge of {name} in view of the window"));
    }
    found
}

/// Angles below this many degrees count as rounding.
const ROUNDING: f64 = 1e-6;

/// The objects that light for the plane may meet: meshes, smooth surfaces, and flat objects
/// that do not lie across the path. Once a surface has reflected the light, flat objects across the
/// path count too.
fn in_the_way(scene: &Scene, plane: &VirtualPlane) -> Vec<String> {
    let mut found = Vec::new();
    // An object that light visits on a later leg may block the light on an earlier leg.
    let ends = (0..=plane.leg).filter_map(|leg| scene.path.ends_at(leg));
    let ends: Vec<Object> = ends.map(|hit| hit.object).collect();
    let visited = |object| ends.contains(&object);
    for (i, surface) in scene.surfaces.iter().enumerate() {
        let name = &surface.name;
        if !visited(Object::Surface(i)) && (plane.leg > 0 || surface.across().is_none()) {
            let on_way_back = surface.across().is_some();
            if passes(scene, plane, &surface.corners(), on_way_back) {
                found.push(format!("visibility of {name}"));
            }
        }
    }
    for layer in scene.blockers.iter().filter(|_| plane.leg > 0) {
        let parts = parts(layer, scene, plane);
        if parts.iter().any(|part| passes(scene, plane, part, true)) {
            found.push(format!("visibility of {} on later legs", layer.name));
        }
    }
    for (i, object) in scene.patches.iter().enumerate() {
        let own = visited(Object::Patch(i));
        if !own && passes(scene, plane, &object.patch.corners(), false) {
            found.push(format!("visibility of {}", object.name));
        }
    }
    for (i, mesh) in scene.meshes.iter().enumerate() {
        let (name, count, [near, far]) = (&mesh.name, mesh.triangles.len(), mesh.extent);
        let own = visited(Object::Mesh(i));
        if !own && passes(scene, plane, mesh.triangles.as_flattened(), false) {
            found.push(format!(
                "visibility of {name}: {count} triangles at {near:.4} to {far:.4} m"
            ));
        }
    }
    found
}

/// The corners of rectangles. Together, they contain every part of a layer that light may
/// meet on its way to a plane.
fn parts(layer: &BlockerLayer, scene: &Scene, plane: &VirtualPlane) -> Vec<[DVec3; 4]> {
    // A half-plane or a grating is infinite. Here it ends at a thousand times the extent of the
    // light.
    let lengths = tube(scene, plane).into_iter().flatten();
    let far = 1e3 * lengths.fold(layer.distance, f64::max).min(1e30);
    let corners = |[[x0, x1], [y0, y1]]: [[f64; 2]; 2]| {
        [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|[x, y]| DVec3::new(x, y, layer.distance))
    };
    let everywhere = [[-far, far]; 2];
    match &layer.mask {
        // The opaque part of an aperture surrounds its hole on all sides.
        Mask::Grating(_) | Mask::Aperture(_) => vec![corners(everywhere)],
        Mask::Opaque {
            shapes,
            half_planes,
        } => {
            let shapes = shapes.iter().map(|shape| {
                let bounds = shape.bounds();
                [0, 1].map(|axis| bounds.extent(axis))
            });
            let halves = half_planes.iter().map(|half| {
                let mut extent = everywhere;
                extent[half.axis][usize::from(!half.above)] = half.edge;
                extent
            });
            shapes.chain(halves).map(corners).collect()
        }
    }
}

/// The half-widths of the regions where light for a plane leaves the source and where it
/// reaches each surface.
fn tube(scene: &Scene, plane: &VirtualPlane) -> [[f64; 2]; 2] {
    let window = [&plane.window.x, &plane.window.y].map(Profile::half_width);
    let slope = [&plane.window.u, &plane.window.v].map(Profile::half_width);
    let along = scene.path.along(plane);
    let light = [0, 1].map(|axis| {
        let [low, high] = scene.light.extent(axis);
        low.abs().max(high.abs()).min(f64::MAX)
    });
    [light, [0, 1].map(|axis| window[axis] + along * slope[axis])]
}

/// Checks whether light for a plane may pass through a box around points, given in the frame at the
/// light.
pub(crate) fn passes(
    scene: &Scene,
    plane: &VirtualPlane,
    points: &[DVec3],
    on_way_back: bool,
) -> bool {
    let legs = &scene.path.legs;
    let window = [&plane.window.x, &plane.window.y].map(Profile::half_width);
    let [light, seen] = tube(scene, plane);
    // A plane directly after an object is at the same distance as the object.
    let after = plane.side == Side::After;
    let along = scene.path.along(plane) * if after { 1.0 + 1e-12 } else { 1.0 };
    let crosses = |leg: usize| {
        let (from, to, end) = if leg < plane.leg {
            (light, seen, legs[leg].length)
        } else if leg == 0 {
            (light, window, along)
        } else {
            (seen, window, along)
        };
        let frame = &legs[leg].frame;
        overlaps(points, frame, from, to, end) && !is_beside(points, frame, from, to, end)
    };
    // No tube is checked after several reflections in a row, because the theory of parallel planes
    // does not apply there.
    let first = usize::from(on_way_back);
    (first..=plane.leg.min(1)).any(crosses)
}

/// Checks whether a box around points meets a tube along a frame. The tube has the half-widths
/// `from` at depth 0 and `to` at depth `end`.
fn overlaps(points: &[DVec3], frame: &Frame, from: [f64; 2], to: [f64; 2], end: f64) -> bool {
    let local = points.iter().map(|p| frame.to_local(*p));
    let (low, high) = local.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
        (low.min(p), high.max(p))
    });
    if high.z <= 0.0 || low.z >= end {
        return false;
    }
    let ends = [low.z, high.z].map(|z| (z / end).clamp(0.0, 1.0));
    [0, 1].into_iter().all(|axis| {
        let half = ends.map(|s| from[axis] + s * (to[axis] - from[axis]));
        let half = half[0].max(half[1]);
        low[axis] < half && high[axis] > -half
    })
}

/// Checks whether four points lie in one plane that a tube does not cross. The tube is given as in
/// [`overlaps`].
fn is_beside(points: &[DVec3], frame: &Frame, from: [f64; 2], to: [f64; 2], end: f64) -> bool {
    let [a, b, c, d] = points else { return false };
    let normal = (b - a).cross(c - a);
    if (d - a).dot(normal).abs() > 1e-9 * normal.length() * (d - a).length() {
        return false;
    }
    let corners = [(from, 0.0), (to, end)].into_iter().flat_map(|(half, z)| {
        [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]]
            .map(|[x, y]| frame.to_world(DVec3::new(x * half[0], y * half[1], z)))
    });
    let sides: Vec<f64> = corners.map(|corner| (corner - *a).dot(normal)).collect();
    sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0)
}

/// The surface whose edge lies within the view of a plane after a reflection. Theory
/// assumes that the surface is infinite.
fn beyond_edge<'a>(scene: &'a Scene, plane: &VirtualPlane) -> Option<&'a str> {
    let surface = reflector(scene, plane)?;
    let (w, travelled) = (&plane.window, scene.path.along(plane));
    let (_, rectangle) = surface.across()?;
    let covers = |axis: usize, space: &Profile, slope: &Profile| {
        let reach = space.half_width() + travelled * slope.half_width();
        let [low, high] = rectangle.extent(axis);
        low <= -reach && reach <= high
    };
    let covered = covers(0, &w.x, &w.u) && covers(1, &w.y, &w.v);
    (!covered).then_some(&surface.name)
}

/// The flat surface that light leaves at the beginning of the leg of a plane.
fn reflector<'a>(scene: &'a Scene, plane: &VirtualPlane) -> Option<&'a Surface> {
    match scene.path.legs[plane.leg].leaves?.object {
        Object::Surface(i) => Some(&scene.surfaces[i]),
        Object::Mesh(_) | Object::Patch(_) => None,
    }
}
