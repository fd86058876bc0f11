//! A plane that cuts the scene, and the resulting segments.

use crate::table::spaced;
use etendue_field::{Mask, Patch, Rectangle, Shape, Specular, VirtualPlane};
use etendue_figures::{PlaneMark, Section, Segment, SegmentKind};
use etendue_scene::limits::MAX_NUMBER;
use etendue_scene::{BlockerLayer, Event, Leg, MeshObject, Object, Scene};
use glam::DVec3;
use std::collections::HashMap;

/// A plane that cuts the scene.
#[derive(Clone, Copy)]
pub(super) struct CuttingPlane<'a> {
    pub(super) scene: &'a Scene,
    /// The index of the cutting plane: 0 for the plane of X, 1 for the plane of Y.
    pub(super) axis: usize,
}

impl CuttingPlane<'_> {
    pub(super) fn section(&self, planes: &[&VirtualPlane]) -> Section {
        let scene = self.scene;
        let pieces = self.pieces(planes);
        let last = scene.path.legs.last().map_or(0.0, |leg| leg.start);
        let length = planes.iter().map(|p| p.distance).fold(last, f64::max);
        let marks = planes.iter().map(|plane| PlaneMark {
            name: spaced(&plane.name),
            distance: plane.distance,
            side: plane.side,
        });
        let meshes = scene.meshes.iter().enumerate().map(|(i, object)| {
            let leg = &scene.path.legs[self.arriving(Object::Mesh(i))];
            outlines(&self.mesh(object, leg))
        });
        Section {
            across: ["*x*", "*y*"][self.axis].to_owned(),
            length,
            unfolded: length > scene.path.first_hit(),
            half_width: self.half_width(planes),
            segments: pieces.into_iter().map(|(_, segment)| segment).collect(),
            planes: marks.collect(),
            bodies: meshes.flatten().collect(),
            other: None,
            world: None,
        }
    }

    /// All segments of the cut, each with the leg on which light arrives at the segment.
    pub(super) fn pieces(&self, planes: &[&VirtualPlane]) -> Vec<(usize, Segment)> {
        let scene = self.scene;
        let half_width = self.half_width(planes);
        let lights = self.lights().into_iter();
        let mut pieces: Vec<_> = lights.map(|segment| (0, segment)).collect();
        for layer in &scene.blockers {
            let rows = self.layer_extents(layer, half_width);
            let segments = labelled(SegmentKind::Blocker, &layer.name, rows, layer.distance);
            pieces.extend(segments.map(|segment| (0, segment)));
        }
        for (i, surface) in scene.surfaces.iter().enumerate() {
            let leg = self.arriving(Object::Surface(i));
            let outline = self.cut(&surface.corners(), &scene.path.legs[leg]);
            let segment = outline.map(|[start, end]| Segment {
                kind: SegmentKind::Surface,
                start,
                end,
                label: Some(spaced(&surface.name)),
            });
            pieces.extend(segment.map(|segment| (leg, segment)));
        }
        for (i, object) in scene.patches.iter().enumerate() {
            let leg = self.arriving(Object::Patch(i));
            let outline = self.profile(&object.patch, &scene.path.legs[leg]);
            let middle = outline.len() / 2;
            let kind = match &object.event {
                Event::Specular(Specular::Mirror) | Event::Reflects(_) => SegmentKind::Surface,
                Event::Specular(_) => SegmentKind::Glass,
            };
            pieces.extend(outline.windows(2).enumerate().map(|(i, ends)| {
                let label = (i == middle).then(|| spaced(&object.name));
                let [start, end] = [ends[0], ends[1]];
                let segment = Segment {
                    kind,
                    start,
                    end,
                    label,
                };
                (leg, segment)
            }));
        }
        for (i, object) in scene.meshes.iter().enumerate() {
            let leg = self.arriving(Object::Mesh(i));
            let segments = self.mesh(object, &scene.path.legs[leg]);
            pieces.extend(segments.into_iter().map(|segment| (leg, segment)));
        }
        pieces
    }

    /// Three coordinates of a point in a leg's frame. The first is along the leg, the
    /// second is across the leg within the cut, and the third is across the cut.
    fn local(&self, leg: &Leg, point: DVec3) -> [f64; 3] {
        let local = leg.frame.to_local(point);
        let [within, off] = if self.axis == 0 {
            [local.x, local.y]
        } else {
            [local.y, local.x]
        };
        [leg.start + local.z, within, off]
    }

    /// The half-width of the drawing. It is slightly larger than the half-width of the
    /// light, of each bounded blocker and of each window.
    fn half_width(&self, planes: &[&VirtualPlane]) -> f64 {
        let (scene, axis) = (self.scene, self.axis);
        let lights = self.lights().into_iter();
        let lights = lights.flat_map(|light| [light.start[1], light.end[1]]);
        let layers = scene.blockers.iter().filter_map(|layer| match &layer.mask {
            Mask::Opaque {
                shapes,
                half_planes,
            } => Some((shapes, half_planes)),
            _ => None,
        });
        let ends = layers.flat_map(|(shapes, half_planes)| {
            // A bar along the cut is as endless as a half-plane.
            let shapes = shapes
                .iter()
                .map(Shape::bounds)
                .filter(move |bounds| bounds.size[axis] < MAX_NUMBER)
                .flat_map(move |bounds| bounds.extent(axis));
            let halves = half_planes.iter().filter(move |half| half.axis == axis);
            shapes.chain(halves.map(|half| half.edge))
        });
        let black = scene.meshes.iter().filter(|mesh| mesh.is_black());
        let holes = scene.blockers.iter().filter_map(|layer| match &layer.mask {
            Mask::Aperture(hole) => Some(hole.bounds().extent(axis)),
            _ => None,
        });
        let corners = black.flat_map(|mesh| mesh.triangles.as_flattened());
        let windows = planes.iter().map(|plane| {
            let profile = [&plane.window.x, &plane.window.y][axis];
            profile.half_width()
        });
        let reach = ends
            .chain(corners.map(|p| p[axis]))
            .chain(windows)
            .chain(holes.flatten())
            .chain(lights);
        1.12 * reach.map(f64::abs).fold(0.0, f64::max)
    }

    /// The leg on which light arrives at an object. For an object that the path does not
    /// visit, returns the first leg.
    fn arriving(&self, object: Object) -> usize {
        let path = &self.scene.path;
        let ends = |leg: &usize| path.ends_at(*leg).is_some_and(|hit| hit.object == object);
        (0..path.legs.len()).find(ends).unwrap_or(0)
    }

    /// The segment that the cut of a leg has in common with a flat outline, as points (z,
    /// x). z is the distance along the path.
    fn cut(&self, corners: &[DVec3], leg: &Leg) -> Option<[[f64; 2]; 2]> {
        let corners: Vec<[f64; 3]> = corners.iter().map(|p| self.local(leg, *p)).collect();
        let mut points = Vec::new();
        for (i, a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            if (a[2] < 0.0) != (b[2] < 0.0) {
                // The ends of each edge are taken in a fixed order, so two triangles get the same
                // point on a shared edge.
                let (a, b) = if a[2] < 0.0 { (*a, b) } else { (b, *a) };
                let t = a[2] / (a[2] - b[2]);
                points.push([0, 1].map(|i| a[i] + t * (b[i] - a[i])));
            }
        }
        points.try_into().ok()
    }

    /// The curve (z, x) in which the cut of a leg meets a smooth surface. The curve passes
    /// through the vertex of the surface.
    fn profile(&self, patch: &Patch, leg: &Leg) -> Vec<[f64; 2]> {
        const STEPS: i32 = 24;
        let off = [leg.frame.y, leg.frame.x][self.axis];
        let across = off.cross(patch.frame.d).normalize();
        let [s, t] = [across.dot(patch.frame.x), across.dot(patch.frame.y)];
        let at = |i: i32| {
            let r = patch.aperture * f64::from(i) / f64::from(STEPS);
            let [z, x, _] = self.local(leg, patch.point(r * s, r * t));
            [z, x]
        };
        (-STEPS..=STEPS).map(at).collect()
    }

    /// The segments of all lights. If there are several, their labels have numbers.
    fn lights(&self) -> Vec<Segment> {
        let mut all: Vec<Segment> = self.scene.lights().map(|of| self.light(of)).collect();
        if all.len() > 1 {
            for (light, number) in all.iter_mut().zip(1..) {
                light.label = light.label.take().map(|label| format!("{label} {number}"));
            }
        }
        all
    }

    /// The segment of a light. `scene` is the scene in which it is the only light.
    fn light(&self, scene: &Scene) -> Segment {
        let depth = self.scene.path.first_hit() - scene.path.first_hit();
        let dot = 0.005 * scene.path.first_hit();
        let kind = match scene.light.environment() {
            Some(_) => SegmentKind::Sky,
            None => SegmentKind::Light,
        };
        let [low, high] = match scene.light.extent(self.axis) {
            [low, high] if low < high && low.is_finite() => [low, high],
            _ => [-dot, dot],
        };
        Segment {
            kind,
            start: [depth, low],
            end: [depth, high],
            label: Some(
                if kind == SegmentKind::Sky {
                    "sky"
                } else {
                    "light"
                }
                .to_owned(),
            ),
        }
    }

    /// The intervals in which a layer stops at least half of the light. The intervals of
    /// gratings extend slightly beyond the visible range.
    fn layer_extents(&self, layer: &BlockerLayer, half_width: f64) -> Vec<[f64; 2]> {
        let axis = self.axis;
        match &layer.mask {
            Mask::Opaque {
                shapes,
                half_planes,
            } => {
                // If no shape is on the cut, the nearest is shown. Jitter may move a row of an
                // array partly off the cut, so all of the row nearest to the cut is shown.
                let is_array = layer.pitch.is_some();
                let half = |r: &Rectangle| 0.5 * r.size[1 - axis];
                let off = |r: &Rectangle| {
                    let center = r.center[1 - axis].abs();
                    center - if is_array { 0.0 } else { half(r).min(center) }
                };
                let bounds = shapes.iter().map(Shape::bounds);
                let nearest = bounds
                    .clone()
                    .map(|r| off(&r))
                    .fold(f64::INFINITY, f64::min);
                let row =
                    bounds.filter(|r| off(r) <= nearest + if is_array { half(r) } else { 0.0 });
                let halves = half_planes.iter().filter_map(|half| {
                    match (half.axis == axis, half.above) {
                        (true, true) => Some([half.edge, f64::INFINITY]),
                        (true, false) => Some([f64::NEG_INFINITY, half.edge]),
                        // A half-plane along the other axis covers either the whole cut or none of
                        // it.
                        (false, above) => (above == (half.edge < 0.0)).then_some(ENDLESS),
                    }
                });
                row.map(|r| r.extent(axis)).chain(halves).collect()
            }
            Mask::Grating(grating)
                if grating.axis == axis && half_width * grating.frequency < MOST_PERIODS =>
            {
                // The intervals are half a period around each minimum, where 2πft + p = π (2n + 1).
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
            Mask::Aperture(hole) => match hole.chord(axis, 0.0) {
                Some([low, high]) => vec![[f64::NEG_INFINITY, low], [high, f64::INFINITY]],
                None => vec![ENDLESS],
            },
        }
    }

    /// The outline in which the cut of a leg meets a mesh.
    fn mesh(&self, mesh: &MeshObject, leg: &Leg) -> Vec<Segment> {
        let kind = mesh
            .albedo
            .map_or(SegmentKind::Blocker, |_| SegmentKind::Surface);
        let cuts = mesh.triangles.iter().filter_map(|corners| {
            let [start, end] = self.cut(corners, leg)?;
            (key(start) != key(end)).then_some(Segment {
                kind,
                start,
                end,
                label: None,
            })
        });
        let mut pieces: Vec<Segment> = cuts.collect();
        // The name of the mesh is placed at the middle piece of the outline.
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
}

/// Returns segments across the central ray. The first segment has the name of the object.
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

/// The interval that covers the whole axis.
const ENDLESS: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
/// If a grating has more periods than this number on either side of the ray, single periods cannot
/// be distinguished.
const MOST_PERIODS: f64 = 40.0;

/// The bits of a point's coordinates, which serve as the key of a map.
fn key(point: [f64; 2]) -> [u64; 2] {
    point.map(f64::to_bits)
}

/// Joins segments with common ends, and returns the closed lines that result.
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
