//! The scene in the plane of the central ray and X: what the plane y = 0 cuts.

use crate::pictures::spaced;
use etendue_field::{Light, Mask, Patch, Shape, VirtualPlane};
use etendue_figures::{PlaneMark, Section, Segment, SegmentKind};
use etendue_scene::{BlockerLayer, Leg, MeshObject, Object, Scene};
use glam::DVec3;

/// The cut, with the planes given; the path is unfolded: each surface is cut as light arrives at it.
pub(crate) fn cross_section<'a>(
    scene: &Scene,
    planes: impl Iterator<Item = &'a VirtualPlane>,
) -> Section {
    let planes: Vec<PlaneMark> = planes
        .map(|plane| PlaneMark {
            name: spaced(&plane.name),
            distance: plane.distance,
            side: plane.side,
        })
        .collect();
    let mut segments = vec![light(scene)];
    for layer in &scene.blockers {
        let rows = layer_extents(layer);
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
        let mut label = Some(spaced(&object.name));
        let outline = profile(&object.patch, arriving(scene, Object::Patch(i)));
        segments.extend(outline.windows(2).map(|ends| Segment {
            kind: SegmentKind::Surface,
            start: ends[0],
            end: ends[1],
            label: label.take(),
        }));
    }
    for (i, object) in scene.meshes.iter().enumerate() {
        segments.extend(mesh(object, arriving(scene, Object::Mesh(i))));
    }
    let last = scene.path.legs.last().map_or(0.0, |leg| leg.start);
    let farthest = planes.iter().map(|plane| plane.distance);
    Section {
        length: farthest.fold(last, f64::max),
        segments,
        planes,
        cones: Vec::new(),
    }
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
    let [low, high] = match scene.light {
        Light::Area { shape, .. } => shape.bounds().extent(0),
        // A dot.
        Light::Beam { image, .. } => [-0.5, 0.5].map(|half| half * image.width[0]),
        Light::Point { .. } | Light::Projector { .. } => {
            [-0.005, 0.005].map(|x| x * scene.path.first_hit())
        }
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

/// Periods of a grating, and metres of a half-plane, that are drawn.
const DRAWN: f64 = 0.5;

/// Where a layer is opaque, or more opaque than open, along X.
fn layer_extents(layer: &BlockerLayer) -> Vec<[f64; 2]> {
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
                    (0, true) => [half.edge, half.edge + DRAWN],
                    (0, false) => [half.edge - DRAWN, half.edge],
                    _ => [-DRAWN, DRAWN],
                });
            row.map(|r| r.extent(0)).chain(halves).collect()
        }
        Mask::Grating(grating) if grating.axis == 0 => {
            // Half a period around each minimum, where 2πft + p = π (2n + 1).
            let period = 1.0 / grating.frequency;
            let first = (0.5 - grating.phase / std::f64::consts::TAU) * period;
            let count = (DRAWN / period).clamp(3.0, 40.0).ceil();
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
        Mask::Grating(_) => vec![[-DRAWN, DRAWN]],
    }
}

/// The outline in which the plane y = 0 of a leg cuts a mesh.
fn mesh(mesh: &MeshObject, leg: &Leg) -> Vec<Segment> {
    let kind = mesh
        .albedo
        .map_or(SegmentKind::Blocker, |_| SegmentKind::Surface);
    let mut label = Some(spaced(&mesh.name));
    let cuts = mesh.triangles.iter().filter_map(|corners| {
        let [start, end] = cut(corners, leg)?;
        Some(Segment {
            kind,
            start,
            end,
            label: label.take(),
        })
    });
    cuts.collect()
}
