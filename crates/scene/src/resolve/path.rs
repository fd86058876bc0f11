//! Computes the central ray: straight legs from surface to surface.

use super::Resolver;
use super::faults::{names, show, vector};
use super::obstacles::Things;
use crate::scene::{CentralRay, Event, Hit, Leg, MeshObject, Object, PatchObject};
use etendue_field::{Frame, Light, Specular, TwoPlane, interpolated_normal, triangle_distance};
use etendue_scenefile::did_you_mean;
use etendue_scenefile::{SceneFile, SurfaceFile};
use glam::DVec3;

/// Near the beginning of a leg, hits on the surface that the ray leaves are ignored. They are
/// ignored up to this share of the leg's length.
const MIN_LEG_SHARE: f64 = 1e-9;

/// A surface counts as edge-on if the cosine of the angle between the ray and the normal is below
/// this limit.
const GRAZING: f64 = 1.7e-3;

impl Resolver<'_> {
    /// The legs up to and including the first faulty leg, whose length is NaN.
    pub(super) fn path(
        &mut self,
        file: &SceneFile,
        frame: Frame,
        light: &Light,
        things: Things<'_>,
    ) -> CentralRay {
        let visits = &file.path.visits;
        if visits.is_empty() {
            let allowed = "the names of the surfaces that the central ray visits";
            self.faults.add("path.visits", show(visits), allowed);
        }
        let mut leg = Leg {
            frame: Frame::IDENTITY,
            start: 0.0,
            length: f64::NAN,
            leaves: None,
        };
        let mut legs = Vec::new();
        for i in 0..visits.len() {
            let Some((length, hit)) = self.visit(i, file, &leg.frame, things) else {
                break;
            };
            legs.push(Leg { length, ..leg });
            let Some(d) = self.onwards(i, file, &frame, &leg.frame, &hit, things) else {
                return CentralRay { frame, legs };
            };
            leg = Leg {
                frame: leaving(
                    &leg.frame,
                    &hit,
                    d,
                    things.is_left_behind(&hit, d, &leg.frame),
                ),
                start: leg.start + length,
                length: f64::NAN,
                leaves: Some(hit),
            };
        }
        if legs.len() == visits.len() {
            leg.length = things.clear(&leg.frame, light);
        }
        legs.push(leg);
        CentralRay { frame, legs }
    }

    /// The distance along the leg at which the central ray makes visit `i` to a surface,
    /// and the hit.
    fn visit(
        &mut self,
        i: usize,
        file: &SceneFile,
        leg: &Frame,
        things: Things<'_>,
    ) -> Option<(f64, Hit)> {
        let of = format!("path.visits[{i}]");
        let visit = &file.path.visits[i];
        let known = things.objects();
        let Some(&(object, _)) = known.iter().find(|(_, name)| name == visit) else {
            // If the surface is faulty, the fault has been reported already.
            let mut written = file.surfaces.iter().map(SurfaceFile::name);
            if !written.clone().any(|name| name == visit) {
                let value = show(visit) + &did_you_mean(visit, written.clone());
                let allowed = match file.surfaces.is_empty() {
                    true => "a surface, but the scene has none".to_owned(),
                    false => format!("one of the surfaces: {}", names(&mut written)),
                };
                self.faults.add(of, value, allowed);
            }
            return None;
        };
        let hits = known
            .iter()
            .filter_map(|(o, name)| Some((things.hit(*o, leg)?, *o, *name)));
        let hits: Vec<_> = hits.collect();
        let Some(&((length, point, normal), ..)) = hits.iter().find(|(_, o, _)| *o == object)
        else {
            if things.is_finite(object) {
                let allowed = "a surface that the central ray hits";
                self.faults.add_on_path(of, show(visit), allowed);
            }
            return None;
        };
        let before = hits
            .iter()
            .filter(|((distance, ..), ..)| *distance < length);
        for (.., name) in before {
            let allowed = format!("{}, which the central ray hits first", show(name));
            self.faults.add_on_path(&of, show(visit), allowed);
        }
        if let Object::Patch(i) = object {
            let PatchObject { patch, event, .. } = &things.patches[i];
            let behind = patch.normal(point).dot(normal) < 0.0;
            if behind && matches!(event, Event::Reflects(_)) {
                let allowed =
                    "a surface that the central ray meets on its front: its back is black";
                self.faults.add_on_path(of, show(visit), allowed);
            }
        }
        let hit = Hit {
            object,
            point,
            normal,
        };
        Some((length, hit))
    }

    /// The direction in which the central ray leaves the surface of visit `i`.
    fn onwards(
        &mut self,
        i: usize,
        file: &SceneFile,
        world: &Frame,
        leg: &Frame,
        hit: &Hit,
        things: Things<'_>,
    ) -> Option<DVec3> {
        let path = &file.path;
        if let Some((event, lens, facing)) = things.specular(hit, leg) {
            let name = &path.visits[i];
            if facing.dot(leg.d).abs() < GRAZING {
                let allowed =
                    "a surface that the central ray meets at less than 89.9° to its normal";
                self.faults
                    .add_on_path(format!("path.visits[{i}]"), show(name), allowed);
                return None;
            }
            if let Some(leaves) = path.leaves.filter(|_| i + 1 == path.visits.len()) {
                let allowed = format!("nothing: {} determines the direction", show(name));
                self.faults.add("path.leaves", vector(&leaves), allowed);
            }
            let d = event
                .turned(&lens, facing, hit.point, leg.d)
                .map(DVec3::normalize);
            if d.is_none() {
                let allowed = format!(
                    "an angle without total internal reflection at {}",
                    show(name)
                );
                self.faults
                    .add_on_path(format!("path.visits[{i}]"), show(name), allowed);
            }
            return d;
        }
        let (of, value, d) = if let Some(next) = path.visits.get(i + 1) {
            let known = things.objects();
            let Some((object, _)) = known.iter().find(|(_, name)| name == next) else {
                // The fault is reported when the visit is checked.
                return Some(hit.normal);
            };
            let towards = things.center(*object) - hit.point;
            (format!("path.visits[{}]", i + 1), show(next), towards)
        } else if let Some(leaves) = path.leaves {
            let d = world.vector_to_local(DVec3::from(leaves));
            ("path.leaves".to_owned(), vector(&leaves), d)
        } else if things.mirrors(hit.object) {
            return Some(leg.d - 2.0 * leg.d.dot(hit.normal) * hit.normal);
        } else {
            return Some(-leg.d);
        };
        let d = d.try_normalize().filter(|d| d.dot(hit.normal) > 1e-6);
        if d.is_none() {
            let name = show(&path.visits[i]);
            let allowed = format!("in front of {name}, on the side that light comes from");
            self.faults.add_on_path(of, value, allowed);
        }
        d
    }
}

/// The frame of the light that leaves a hit along the direction `d`. The arriving frame is
/// reflected at the surface with X reversed, and is then rotated by the smallest angle that turns D
/// to `d`. For light that goes straight back at normal incidence, the frame is (−X, Y, −D) (Durand
/// et al. 2005, section 4.1, steps 1 and 7, at θ = 0). For light that leaves in the plane of
/// incidence, the frame is as described in docs/conventions.md.
///
/// For transmitted light, the arriving frame is rotated by the smallest angle that turns D to `d`.
fn leaving(arriving: &Frame, hit: &Hit, d: DVec3, through: bool) -> Frame {
    let n = hit.normal;
    if through {
        let origin = hit.point;
        let arriving = Frame {
            origin,
            ..*arriving
        };
        return if arriving.d == d {
            arriving
        } else {
            arriving.turned_to(d)
        };
    }
    let reflected = |v: DVec3| v - 2.0 * v.dot(n) * n;
    let mirrored = Frame {
        origin: hit.point,
        x: -reflected(arriving.x),
        y: reflected(arriving.y),
        d: reflected(arriving.d),
    };
    if mirrored.d == d {
        mirrored
    } else {
        mirrored.turned_to(d)
    }
}

impl Things<'_> {
    /// All reflecting objects, with their names.
    fn objects(&self) -> Vec<(Object, &str)> {
        let surfaces = self.surfaces.iter().enumerate();
        let surfaces = surfaces.map(|(i, s)| (Object::Surface(i), s.name.as_str()));
        let meshes = self.meshes.iter().enumerate();
        let meshes = meshes.filter(|(_, m)| !m.is_black());
        let meshes = meshes.map(|(i, m)| (Object::Mesh(i), m.name.as_str()));
        let patches = self.patches.iter().enumerate();
        let patches = patches.map(|(i, p)| (Object::Patch(i), p.name.as_str()));
        surfaces.chain(meshes).chain(patches).collect()
    }

    /// Describes a smooth surface at the end of a leg. Returns its event, its frame as a lens, and
    /// its normal at the hit, on the side that the surface faces.
    fn specular(&self, hit: &Hit, leg: &Frame) -> Option<(Specular, Frame, DVec3)> {
        match hit.object {
            Object::Surface(_) => None,
            Object::Patch(i) => {
                let PatchObject { patch, event, .. } = &self.patches[i];
                let Event::Specular(event) = event else {
                    return None;
                };
                Some((*event, patch.frame, patch.normal(hit.point)))
            }
            Object::Mesh(i) => {
                let mesh = &self.meshes[i];
                let event = mesh.smooth.as_ref()?.event;
                let (_, facing) = mesh.first_on(leg)?;
                Some((event, Frame::IDENTITY, facing))
            }
        }
    }

    /// Checks whether an object sends light in or near the mirror direction.
    fn mirrors(&self, object: Object) -> bool {
        match object {
            Object::Surface(_) | Object::Mesh(_) => false,
            Object::Patch(i) => self.patches[i].event.mirrors(),
        }
    }

    /// Checks whether light that leaves a hit along `d` has passed through the surface.
    fn is_left_behind(&self, hit: &Hit, d: DVec3, leg: &Frame) -> bool {
        self.specular(hit, leg).is_some() && d.dot(hit.normal) < 0.0
    }

    /// The first hit of the axis of a frame with an object: the distance, the point, and
    /// the normal on the side of the frame's origin.
    fn hit(&self, object: Object, frame: &Frame) -> Option<(f64, DVec3, DVec3)> {
        let found = match object {
            Object::Surface(i) => {
                let surface = &self.surfaces[i];
                let n = surface.frame.d;
                let t = (surface.frame.origin - frame.origin).dot(n) / frame.d.dot(n);
                let at = surface.frame.to_local(frame.origin + t * frame.d);
                let [x, y] = surface.size;
                let inside = 2.0 * at.x.abs() <= x && 2.0 * at.y.abs() <= y;
                (t > MIN_LEG_SHARE && inside).then_some((t, n))
            }
            Object::Mesh(i) => self.meshes[i].first_on(frame),
            Object::Patch(i) => {
                let patch = &self.patches[i].patch;
                let local = patch.frame.decompose(frame);
                let hits = patch.hits(local.origin, local.d);
                let t = hits.into_iter().find(|t| *t > MIN_LEG_SHARE);
                t.map(|t| (t, patch.normal(frame.origin + t * frame.d)))
            }
        };
        let (t, n) = found?;
        let normal = if n.dot(frame.d) > 0.0 { -n } else { n };
        Some((t, frame.origin + t * frame.d, normal))
    }

    fn is_finite(&self, object: Object) -> bool {
        match object {
            Object::Surface(i) => self.surfaces[i].frame.origin.is_finite(),
            Object::Mesh(_) | Object::Patch(_) => true,
        }
    }

    fn center(&self, object: Object) -> DVec3 {
        match object {
            Object::Surface(i) => self.surfaces[i].frame.origin,
            Object::Mesh(i) => self.meshes[i].center,
            Object::Patch(i) => self.patches[i].patch.frame.origin,
        }
    }

    /// The distance along the axis of a frame to the first object, blocker or light that
    /// the axis meets.
    fn clear(&self, frame: &Frame, light: &Light) -> f64 {
        let objects = self.objects();
        let objects = objects
            .iter()
            .filter_map(|(o, _)| Some(self.hit(*o, frame)?.0));
        let black = self.meshes.iter().filter(|m| m.is_black());
        let black = black.filter_map(|mesh| Some(mesh.first_on(frame)?.0));
        let crossing = |z: f64| {
            let t = (z - frame.origin.z) / frame.d.z;
            let at = frame.origin + t * frame.d;
            (t > MIN_LEG_SHARE && t.is_finite()).then_some((t, at.x, at.y))
        };
        let masks = self.blockers.iter().filter_map(|layer| {
            let (t, x, y) = crossing(layer.distance)?;
            (layer.mask.transmittance(x, y) < 1.0).then_some(t)
        });
        let lamp = light.shape().and_then(|shape| {
            let (t, x, y) = crossing(0.0)?;
            shape.contains(x, y).then_some(t)
        });
        let all = objects.chain(black).chain(masks).chain(lamp);
        all.fold(f64::INFINITY, f64::min)
    }
}

impl MeshObject {
    /// The distance at which the axis of a frame first hits the mesh, and the normal at
    /// the hit: the triangle's normal, or the interpolated normal.
    pub(crate) fn first_on(&self, frame: &Frame) -> Option<(f64, DVec3)> {
        let central = TwoPlane::default();
        let hits = self
            .triangles
            .iter()
            .enumerate()
            .filter_map(|(i, corners)| {
                let t = triangle_distance(&corners.map(|p| frame.to_local(p)), &central)?;
                (t > MIN_LEG_SHARE).then_some((t, i))
            });
        let (t, i) = hits.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
        Some((t, self.normal(i, frame.origin + t * frame.d)))
    }

    /// The outward normal at a point of a triangle, on the side given by the triangle's
    /// winding.
    pub(crate) fn normal(&self, triangle: usize, point: DVec3) -> DVec3 {
        let corners = &self.triangles[triangle];
        match &self.smooth {
            Some(smooth) => interpolated_normal(corners, &smooth.normals[triangle], point),
            None => {
                let [a, b, c] = corners;
                (b - a).cross(c - a).normalize()
            }
        }
    }
}
