//! The scene in the plane of the central ray and X: what the plane y = 0 cuts.

use crate::pictures::spaced;
use etendue_field::{Light, Mask, Shape, VirtualPlane};
use etendue_figures::{PlaneMark, Section, Segment, SegmentKind};
use etendue_scene::{BlockerLayer, MeshObject, Scene};

/// The cut, with the planes given; the way back from the surface is unfolded behind it.
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
    for surface in &scene.surfaces {
        let extent = vec![surface.rectangle.extent(0)];
        segments.extend(labelled(
            SegmentKind::Surface,
            &surface.name,
            extent,
            surface.distance,
        ));
    }
    segments.extend(scene.meshes.iter().flat_map(mesh));
    let farthest = planes.iter().map(|plane| plane.distance);
    Section {
        length: farthest.fold(scene.path.length, f64::max),
        segments,
        planes,
        cones: Vec::new(),
    }
}

fn light(scene: &Scene) -> Segment {
    let [low, high] = match scene.light {
        Light::Area { shape, .. } => shape.bounds().extent(0),
        // A dot.
        Light::Point { .. } => [-0.005, 0.005].map(|x| x * scene.path.length),
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

/// The outline in which the plane y = 0 cuts a mesh.
fn mesh(mesh: &MeshObject) -> Vec<Segment> {
    let kind = mesh
        .albedo
        .map_or(SegmentKind::Blocker, |_| SegmentKind::Surface);
    let mut label = Some(spaced(&mesh.name));
    let cuts = mesh.triangles.iter().filter_map(|corners| {
        let mut points = Vec::new();
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            if (a.y < 0.0) != (b.y < 0.0) {
                let at = a.lerp(b, a.y / (a.y - b.y));
                points.push([at.z, at.x]);
            }
        }
        let &[start, end] = points.as_slice() else {
            return None;
        };
        Some(Segment {
            kind,
            start,
            end,
            label: label.take(),
        })
    });
    cuts.collect()
}
