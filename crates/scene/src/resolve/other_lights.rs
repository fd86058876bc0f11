//! Resolves further lights, each to a scene in which it is the only light.

use super::faults::vector;
use super::{Resolver, SAME_PLANE};
use crate::scene::{Leg, MeshObject, Scene};
use crate::triangles::Triangles;
use etendue_field::{Frame, byte_size, tidy};
use etendue_scenefile::{Fault, LightFile, fault};
use glam::DVec3;

/// A light without offset may stand this far from the central ray, as a share of the length of
/// the first leg. The offset is a rounding error of the frame.
const ON_RAY: f64 = 1e-9;
/// Bytes of a triangle and its part of the hierarchy, which is built anew.
const TRIANGLE: f64 = 150.0;

impl Resolver<'_> {
    /// A scene for each further light of a scene.
    pub(super) fn other_lights(&mut self, scene: &Scene) -> Vec<Scene> {
        self.copies(scene);
        let others = scene.file.other_lights.iter().enumerate();
        let others = others.filter_map(|(i, light)| self.other_light(i, light, scene));
        others.collect()
    }

    /// Checks that the meshes fit in memory once for each light at a depth of its own.
    fn copies(&mut self, scene: &Scene) {
        let lights = scene.file.other_lights.iter();
        let depths = lights.map(|light| scene.path.frame.to_local(light.center().into()).z);
        let copies = depths.filter(|depth| *depth != 0.0).count();
        let triangles = scene.meshes.iter().map(|mesh| mesh.triangles.len());
        let bytes = (triangles.sum::<usize>() * copies) as f64 * TRIANGLE;
        if bytes > self.memory as f64 {
            self.faults.add_fault(Fault {
                memory: true,
                ..fault(
                    "other_lights",
                    format!(
                        "{copies} lights, which need {} for copies of all meshes",
                        byte_size(bytes)
                    ),
                    format!(
                        "at most the available memory, {}",
                        byte_size(self.memory as f64)
                    ),
                )
            });
        }
    }

    fn other_light(&mut self, number: usize, file: &LightFile, scene: &Scene) -> Option<Scene> {
        let frame = &scene.path.frame;
        let center = frame.to_local(DVec3::from(file.center()));
        if !center.is_finite() || self.faults.astray {
            return None;
        }
        let (faults, name) = (self.faults.all.len(), format!("other_lights[{number}]"));
        let mut light = self.light(file, frame);
        for fault in &mut self.faults.all[faults..] {
            fault.field = fault.field.replace("light.", &format!("{name}."));
        }
        self.layers(file, &scene.blockers);
        let length = scene.path.first_hit();
        if let Some(shape) = light.values().shape {
            *shape = shape.centered_at([center.x, center.y]);
        } else if libm::hypot(center.x, center.y) > ON_RAY * length {
            let allowed = "a place on the central ray: only a Rectangle, a Disc or a Spot may stand beside it";
            let shown = vector(&file.center());
            self.faults
                .add_on_path(format!("{name}.center"), shown, allowed);
        }
        let depth = if center.z.abs() <= ON_RAY * length {
            0.0
        } else {
            center.z
        };
        self.depth(&name, depth, scene);
        let planes = scene.planes.iter();
        if !self.faults.all.is_empty() {
            // To move a large scene takes long.
            return None;
        }
        let mut planes: Vec<_> = planes.filter(|p| p.distance >= depth).cloned().collect();
        for plane in &mut planes {
            plane.distance -= depth;
        }
        Some(Scene {
            light,
            planes,
            ..moved(scene, depth)
        })
    }

    /// Checks the distance of a light along the first leg. As for the first light, oblique surfaces
    /// may reach behind the light.
    fn depth(&mut self, name: &str, depth: f64, scene: &Scene) {
        let mut refuse = |allowed: String| {
            let shown = format!("at distance {} m along the central ray", tidy(depth));
            self.faults
                .add_on_path(format!("{name}.center"), shown, allowed);
        };
        let across = scene.surfaces.iter();
        let across = across.filter_map(|s| Some((&s.name, s.across()?.0)));
        let meshes = scene.meshes.iter().map(|m| (&m.name, m.extent[0]));
        let mut near = across.chain(meshes).filter(|(_, at)| *at <= depth);
        let mut layers = scene.blockers.iter();
        let beside = |at: f64| (at - depth).abs() <= SAME_PLANE * depth.abs();
        if let Some((of, at)) = near.next() {
            refuse(format!("in front of {of}, which begins at {} m", tidy(at)));
        } else if scene.path.first_hit() <= depth {
            refuse("in front of the first surface of the path".to_owned());
        } else if let Some(layer) = layers.find(|layer| beside(layer.distance)) {
            refuse(format!("another depth than that of {}", layer.name));
        } else if scene.planes.iter().all(|plane| plane.distance < depth) {
            refuse("in front of at least one plane".to_owned());
        }
    }
}

/// A frame of the scene in the coordinates at a light at the distance `depth`.
fn behind(depth: f64, frame: &Frame) -> Frame {
    let origin = frame.origin - DVec3::Z * depth;
    Frame { origin, ..*frame }
}

/// A scene whose distances begin at the distance `depth` on the central ray. Layers before
/// this distance are kept, because light that a surface sends back may meet them.
fn moved(scene: &Scene, depth: f64) -> Scene {
    let mut moved = scene.clone();
    if depth == 0.0 {
        return moved;
    }
    moved.path.frame = scene.path.frame.travelled(depth);
    for (i, leg) in moved.path.legs.iter_mut().enumerate() {
        match i {
            0 => leg.length -= depth,
            _ => {
                *leg = Leg {
                    frame: behind(depth, &leg.frame),
                    start: leg.start - depth,
                    ..*leg
                }
            }
        }
        if let Some(hit) = &mut leg.leaves {
            hit.point.z -= depth;
        }
    }
    for layer in &mut moved.blockers {
        layer.distance -= depth;
    }
    for surface in &mut moved.surfaces {
        surface.frame = behind(depth, &surface.frame);
    }
    for object in &mut moved.patches {
        object.patch.frame = behind(depth, &object.patch.frame);
    }
    for mesh in &mut moved.meshes {
        *mesh = mesh_moved(mesh, depth);
    }
    moved
}

fn mesh_moved(mesh: &MeshObject, depth: f64) -> MeshObject {
    let by = DVec3::Z * depth;
    let corners: Vec<_> = mesh.triangles.iter().map(|t| t.map(|p| p - by)).collect();
    let [low, high] = mesh.triangles.bounds();
    let reach = low.abs().max(high.abs()).max_element() + depth.abs();
    MeshObject {
        center: mesh.center - by,
        triangles: Triangles::new(corners, reach),
        extent: mesh.extent.map(|z| z - depth),
        ..mesh.clone()
    }
}
