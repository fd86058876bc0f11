//! The scene in the plane of the central ray and X: what the plane y = 0 cuts.

use crate::table::spaced;
use etendue_field::{Mask, Patch, Shape, VirtualPlane};
use etendue_figures::{PlaneMark, Section, Segment, SegmentKind};
use etendue_scene::{BlockerLayer, Leg, MeshObject, Object, Scene};
use glam::DVec3;
use std::collections::HashMap;

/// The cut, with the planes given; the path is unfolded: each surface is cut as light arrives at it.
pub(crate) fn cross_section<'a>(
    scene: &Scene,
    planes: impl Iterator<Item = &'a VirtualPlane>,
) -> Section {
    let planes: Vec<&VirtualPlane> = planes.collect();
    let half_width = half_width(scene, &planes);
    let mut segments = vec![light(scene)];
    for layer in &scene.blockers {
        let rows = layer_extents(layer, half_width);
        segments.extend(labelled(
            SegmentKind::Blocker,
            &layer.name,
            rows,
            layer.distance,
        ));
    }
    for (i, surface) in scene.surfaces.iter().enumerate() {
        let outline = cut(&surface.corners(), arriving(scene, Object::Surface(i)));
        segments.extend(outline.map(|[start, end]| Segment {
            kind: SegmentKind::Surface,
            start,
            end,
            label: Some(spaced(&surface.name)),
        }));
    }
    for (i, object) in scene.patches.iter().enumerate() {
        let outline = profile(&object.patch, arriving(scene, Object::Patch(i)));
        let middle = outline.len() / 2;
        segments.extend(outline.windows(2).enumerate().map(|(i, ends)| Segment {
            kind: SegmentKind::Surface,
            start: ends[0],
            end: ends[1],
            label: (i == middle).then(|| spaced(&object.name)),
        }));
    }
    let mut bodies = Vec::new();
    for (i, object) in scene.meshes.iter().enumerate() {
        let pieces = mesh(object, arriving(scene, Object::Mesh(i)));
        bodies.extend(outlines(&pieces));
        segments.extend(pieces);
    }
    let last = scene.path.legs.last().map_or(0.0, |leg| leg.start);
    let length = planes.iter().map(|p| p.distance).fold(last, f64::max);
    let marks = planes.iter().map(|plane| PlaneMark {
        name: spaced(&plane.name),
        distance: plane.distance,
        side: plane.side,
    });
    Section {
        length,
        unfolded: length > scene.path.first_hit(),
        half_width,
        segments,
        planes: marks.collect(),
        bodies,
    }
}

/// Just beyond the light, the blockers as far as they have an end, and the windows.
fn half_width(scene: &Scene, planes: &[&VirtualPlane]) -> f64 {
    let light = light(scene);
    let layers = scene.blockers.iter().filter_map(|layer| match &layer.mask {
        Mask::Opaque {
            shapes,
            half_planes,
        } => Some((shapes, half_planes)),
        _ => None,
    });
    let ends = layers.flat_map(|(shapes, half_planes)| {
        let shapes = shapes.iter().flat_map(|shape| shape.bounds().extent(0));
        let halves = half_planes.iter().filter(|half| half.axis == 0);
        shapes.chain(halves.map(|half| half.edge))
    });
    let black = scene.meshes.iter().filter(|mesh| mesh.is_black());
    let corners = black.flat_map(|mesh| mesh.triangles.as_flattened());
    let windows = planes.iter().map(|plane| plane.window.x.half_width());
    let reach = ends
        .chain(corners.map(|p| p.x))
        .chain(windows)
        .chain([light.start[1], light.end[1]]);
    1.12 * reach.map(f64::abs).fold(0.0, f64::max)
}

/// The leg on which light arrives at something; the first for what the path does not visit.
fn arriving(scene: &Scene, object: Object) -> &Leg {
    let legs = &scene.path.legs;
    let ends = |leg: &usize| {
        scene
            .path
            .ends_at(*leg)
            .is_some_and(|hit| hit.object == object)
    };
    &legs[(0..legs.len()).find(ends).unwrap_or(0)]
}

/// The piece (z, x) in which the plane y = 0 of a leg cuts a flat outline; z is the distance along the path.
fn cut(corners: &[DVec3], leg: &Leg) -> Option<[[f64; 2]; 2]> {
    let corners: Vec<DVec3> = corners.iter().map(|p| leg.frame.to_local(*p)).collect();
    let mut points = Vec::new();
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        if (a.y < 0.0) != (b.y < 0.0) {
            // From below, so that two triangles have the same point on the edge they share.
            let (a, b) = if a.y < 0.0 { (*a, b) } else { (b, *a) };
            let at = a.lerp(b, a.y / (a.y - b.y));
            points.push([leg.start + at.z, at.x]);
        }
    }
    points.try_into().ok()
}

/// The curve (z, x) in which the plane y = 0 of a leg cuts a smooth surface through its vertex.
fn profile(patch: &Patch, leg: &Leg) -> Vec<[f64; 2]> {
    const STEPS: i32 = 24;
    let across = leg.frame.y.cross(patch.frame.d).normalize();
    let [s, t] = [across.dot(patch.frame.x), across.dot(patch.frame.y)];
    let at = |i: i32| {
        let r = patch.aperture * f64::from(i) / f64::from(STEPS);
        let local = leg.frame.to_local(patch.point(r * s, r * t));
        [leg.start + local.z, local.x]
    };
    (-STEPS..=STEPS).map(at).collect()
}

fn light(scene: &Scene) -> Segment {
    let dot = 0.005 * scene.path.first_hit();
    let [low, high] = match scene.light.extent(0) {
        [low, high] if low < high && low.is_finite() => [low, high],
        _ => [-dot, dot],
    };
    Segment {
        kind: SegmentKind::Light,
        start: [0.0, low],
        end: [0.0, high],
        label: Some("light".to_owned()),
    }
}

/// Segments across the central ray; the first carries the name.
fn labelled(
    kind: SegmentKind,
    name: &str,
    extents: Vec<[f64; 2]>,
    distance: f64,
) -> impl Iterator<Item = Segment> {
    let mut label = Some(spaced(name));
    extents.into_iter().map(move |[low, high]| Segment {
        kind,
        start: [distance, low],
        end: [distance, high],
        label: label.take(),
    })
}

/// Everywhere along X.
const ENDLESS: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
/// Periods of a grating on either side that can still be told apart.
const MOST_PERIODS: f64 = 40.0;

/// Where a layer is opaque, or more opaque than open, along X; gratings a little beyond what is shown.
fn layer_extents(layer: &BlockerLayer, half_width: f64) -> Vec<[f64; 2]> {
    match &layer.mask {
        Mask::Opaque {
            shapes,
            half_planes,
        } => {
            // Jitter moves a row of blockers off y = 0: the row nearest to it is shown.
            let off = |shape: &Shape| shape.bounds().center[1].abs();
            let nearest = shapes.iter().map(off).fold(f64::INFINITY, f64::min);
            let row = shapes
                .iter()
                .map(Shape::bounds)
                .filter(|r| r.center[1].abs() <= nearest + 0.5 * r.size[1]);
            let halves = half_planes
                .iter()
                .map(|half| match (half.axis, half.above) {
                    (0, true) => [half.edge, f64::INFINITY],
                    (0, false) => [f64::NEG_INFINITY, half.edge],
                    _ => ENDLESS,
                });
            row.map(|r| r.extent(0)).chain(halves).collect()
        }
        Mask::Grating(grating)
            if grating.axis == 0 && half_width * grating.frequency < MOST_PERIODS =>
        {
            // Half a period around each minimum, where 2πft + p = π (2n + 1).
            let period = 1.0 / grating.frequency;
            let first = (0.5 - grating.phase / std::f64::consts::TAU) * period;
            let count = (half_width / period).ceil() + 1.0;
            let start = first - ((first / period).round() + count) * period;
            let mut dashes = Vec::new();
            let mut n = 0.0;
            while n <= 2.0 * count {
                let middle = start + n * period;
                dashes.push([middle - 0.25 * period, middle + 0.25 * period]);
                n += 1.0;
            }
            dashes
        }
        Mask::Grating(_) => vec![ENDLESS],
    }
}

/// The outline in which the plane y = 0 of a leg cuts a mesh.
fn mesh(mesh: &MeshObject, leg: &Leg) -> Vec<Segment> {
    let kind = mesh
        .albedo
        .map_or(SegmentKind::Blocker, |_| SegmentKind::Surface);
    let cuts = mesh.triangles.iter().filter_map(|corners| {
        let [start, end] = cut(corners, leg)?;
        (key(start) != key(end)).then_some(Segment {
            kind,
            start,
            end,
            label: None,
        })
    });
    let mut pieces: Vec<Segment> = cuts.collect();
    // The name goes to the middle.
    let ends =
        |least: fn(f64, f64) -> f64, from| pieces.iter().map(|p| p.start[0]).fold(from, least);
    let middle = 0.5 * (ends(f64::min, f64::INFINITY) + ends(f64::max, f64::NEG_INFINITY));
    let off = |piece: &&mut Segment| (piece.start[0] - middle).abs();
    let nearest = pieces.iter_mut().min_by(|a, b| off(a).total_cmp(&off(b)));
    if let Some(piece) = nearest {
        piece.label = Some(spaced(&mesh.name));
    }
    pieces
}

/// A point, told from others by every bit.
fn key(point: [f64; 2]) -> [u64; 2] {
    point.map(f64::to_bits)
}

/// The closed lines among pieces that share their ends.
fn outlines(pieces: &[Segment]) -> Vec<Vec<[f64; 2]>> {
    let mut at: HashMap<[u64; 2], Vec<usize>> = HashMap::new();
    for (i, piece) in pieces.iter().enumerate() {
        for end in [piece.start, piece.end] {
            at.entry(key(end)).or_default().push(i);
        }
    }
    let mut used = vec![false; pieces.len()];
    let mut closed = Vec::new();
    for first in 0..pieces.len() {
        let mut line = vec![pieces[first].start];
        let mut next = Some(first).filter(|i| !used[*i]);
        while let Some(i) = next {
            used[i] = true;
            let Segment { start, end, .. } = &pieces[i];
            let here = if line.last() == Some(start) {
                *end
            } else {
                *start
            };
            line.push(here);
            next = at[&key(here)].iter().copied().find(|i| !used[*i]);
            next = next.filter(|_| key(here) != key(line[0]));
        }
        if line.len() > 3 && line.first() == line.last() {
            closed.push(line);
        }
    }
    closed
}
