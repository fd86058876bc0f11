//! Shapes, groups of shapes, and instances of groups.

use super::object::ObjectRef;
use super::reader::MitsubaReader;
use super::transform::frame;
use crate::range::{MAX_SHAPES, fault, is_similarity, similar};
use crate::report::quoted;
use etendue_world::{Geometry, Light, Shape, Texture, Triangles};
use glam::{DAffine3, DMat3, DVec3};
use std::rc::Rc;
use std::sync::Arc;

/// The emitter of light along the normal of its shape. Mitsuba calls its power per area a radiance:
/// a sheet of radiance 3 gives an irradiance of 3, as measured with 3.9.1.
const COLLIMATED: &str = "directionalarea";

/// Plugins supported as shapes.
const ALLOWED: &str =
    "rectangle, disk, sphere, cylinder, cube, obj, ply, serialized, shapegroup, instance";

/// The geometry of a shape, its placement, and whether its front is flipped.
type PlacedGeometry = (Geometry, DAffine3, bool);

impl<'a> MitsubaReader<'a> {
    /// Adds a top-level shape of the scene.
    pub(super) fn top_shape(&mut self, object: ObjectRef<'a>) {
        match object.plugin.as_str() {
            // A group is shown only where an instance refers to it.
            "shapegroup" => {}
            "instance" => self.instance(object),
            _ if self.has_room(object) => {
                let shape = self.shape(object, false);
                self.world.shapes.extend(shape);
            }
            _ => {}
        }
    }

    fn instance(&mut self, object: ObjectRef<'a>) {
        let to_world = self.to_world(object);
        let groups = self.children(object, "shape");
        let [(_, group)] = groups[..] else {
            let message = "an instance has a wrong number of shapegroups; allowed: one";
            return object.cause(message);
        };
        if group.plugin != "shapegroup" {
            let plugin = quoted(&group.plugin);
            return object.cause(format!("an instance of {plugin}; allowed: shapegroup"));
        }
        for shape in self.group(group).iter() {
            if !self.has_room(object) {
                return;
            }
            let placed = Shape {
                to_world: to_world * shape.to_world,
                ..shape.clone()
            };
            if self.is_sound(object, &placed) {
                self.world.shapes.push(placed);
            }
        }
    }

    /// The shapes of a group, which are read once for all instances.
    fn group(&mut self, group: ObjectRef<'a>) -> Rc<[Shape]> {
        if let Some(known) = self.groups.get(&group.number) {
            return Rc::clone(known);
        }
        let mut made = Vec::new();
        for (_, shape) in self.children(group, "shape") {
            if matches!(shape.plugin.as_str(), "shapegroup" | "instance") {
                shape.cause(format!("{} within a shapegroup", quoted(&shape.plugin)));
            } else {
                made.extend(self.shape(shape, true));
            }
        }
        let made: Rc<[Shape]> = made.into();
        self.groups.insert(group.number, Rc::clone(&made));
        made
    }

    /// Checks whether the world can have one more shape; otherwise, adds a cause of refusal.
    fn has_room(&self, object: ObjectRef<'a>) -> bool {
        if self.world.shapes.len() < MAX_SHAPES {
            return true;
        }
        if !self.report.has_causes() {
            object.cause(format!("more than {MAX_SHAPES} shapes, counting instances"));
        }
        false
    }

    /// Reads one shape. The placement of a shape in a group is not checked, because instances place
    /// the shape.
    fn shape(&mut self, object: ObjectRef<'a>, is_in_group: bool) -> Option<Shape> {
        object.is_used.set(true);
        let own = self.to_world(object);
        self.is_left_out = false;
        let placed = self.geometry(object, own);
        if placed.is_none() && (self.is_left_out || !self.wanted(object).is_empty()) {
            // The attributes of a mesh that was not read are unknown.
            self.drop_all(object);
            return None;
        }
        let emission = self.shape_emission(object, is_in_group);
        let material = match self.child(object, "bsdf") {
            Some(bsdf) => self.material(bsdf),
            None => Some(self.default_material(emission.is_some())),
        };
        let Some(((geometry, to_world, is_flipped), material)) = placed.zip(material) else {
            self.lost(object);
            return None;
        };
        if let Geometry::Mesh(mesh) = &geometry
            && emission.is_some()
            && is_smooth(mesh)
        {
            let message = "the mesh emits with vertex normals: light leaves each triangle on its front, while Mitsuba uses the interpolated normal";
            object.note(message);
        }
        let emission = match emission {
            Some((plugin, exitance)) if plugin == COLLIMATED => {
                self.sheet(object, &geometry, exitance);
                None
            }
            other => other.map(|(_, radiance)| radiance),
        };
        let shape = Shape {
            name: object.id.clone().unwrap_or_default(),
            geometry,
            to_world,
            is_flipped,
            material,
            emission,
            emits_on_both_sides: false,
        };
        (is_in_group || self.is_sound(object, &shape)).then_some(shape)
    }

    fn to_world(&self, object: ObjectRef<'a>) -> DAffine3 {
        let found = object.transform("to_world");
        found.unwrap_or(DAffine3::IDENTITY)
    }

    fn geometry(&mut self, object: ObjectRef<'a>, own: DAffine3) -> Option<PlacedGeometry> {
        self.current_mesh = match object.plugin.as_str() {
            "cube" => self.cube(object),
            "obj" | "ply" | "serialized" => self.mesh(object, own),
            _ => None,
        };
        let mesh = self.current_mesh.as_ref();
        let meshed = mesh.map(|mesh| {
            let geometry = Geometry::Mesh(Arc::clone(&mesh.triangles));
            (geometry, own, mesh.is_flipped)
        });
        match object.plugin.as_str() {
            "rectangle" => Some((Geometry::Rectangle, own, object.truth("flip_normals"))),
            "disk" => Some((Geometry::Disc, own, object.truth("flip_normals"))),
            "sphere" => self.sphere(object, own),
            "cylinder" => self.cylinder(object, own),
            "cube" | "obj" | "ply" | "serialized" => meshed,
            _ => self.unsupported(object, ALLOWED),
        }
    }

    fn sphere(&self, object: ObjectRef<'a>, own: DAffine3) -> Option<PlacedGeometry> {
        let center = object.vector_or("center", DVec3::ZERO);
        let radius = self.radius(object)?;
        let placed =
            own * DAffine3::from_translation(center?) * DAffine3::from_scale(DVec3::splat(radius));
        // In Mitsuba, a mirroring transform turns the normals of spheres inwards, but not the
        // normals of cylinders.
        let is_mirrored = own.matrix3.determinant() < 0.0;
        let is_flipped = object.truth("flip_normals") != is_mirrored;
        if is_similarity(placed.matrix3) || placed.matrix3.determinant().abs() <= 0.0 {
            return Some((Geometry::Sphere, placed, is_flipped));
        }
        let like = similar(placed.matrix3);
        let radius = like.x_axis.length();
        let message = format!(
            "the sphere has different scales along its axes: as in Mitsuba, the scale along its X axis determines the radius, {radius:.6}"
        );
        object.note(message);
        let placed = DAffine3::from_mat3_translation(like, placed.translation);
        Some((Geometry::Sphere, placed, is_flipped))
    }

    fn cylinder(&self, object: ObjectRef<'a>, own: DAffine3) -> Option<PlacedGeometry> {
        let p0 = object.vector_or("p0", DVec3::ZERO);
        let p1 = object.vector_or("p1", DVec3::Z);
        let radius = self.radius(object)?;
        let (p0, axis) = (p0?, p1? - p0?);
        let Some(along) = axis.try_normalize() else {
            let message = "p0 and p1 are the same point; allowed: two different points";
            return object.refuse(message);
        };
        let scale = DVec3::new(radius, radius, axis.length());
        let linear = frame(along) * DMat3::from_diagonal(scale);
        let placed = own * DAffine3::from_mat3_translation(linear, p0);
        Some((Geometry::Cylinder, placed, object.truth("flip_normals")))
    }

    fn radius(&self, object: ObjectRef<'a>) -> Option<f64> {
        object.number_or("radius", 1.0, "a number above 0", |r| r > 0.0)
    }

    /// Returns whether a shape can have its placement, which `object` states; if it cannot, adds a
    /// cause of refusal.
    fn is_sound(&self, object: ObjectRef<'a>, shape: &Shape) -> bool {
        let Some(fault) = fault(&shape.geometry, shape.to_world, shape.emission.is_some()) else {
            return true;
        };
        let message = format!("shape {} {fault}", quoted(&object.plugin));
        object.cause_at("to_world", message);
        false
    }

    /// Adds the light of the next shape, which emits along its normal.
    fn sheet(&mut self, object: ObjectRef<'a>, geometry: &Geometry, exitance: Texture) {
        if !matches!(geometry, Geometry::Rectangle | Geometry::Disc) {
            let plugin = quoted(&object.plugin);
            let message = format!("{COLLIMATED} on {plugin}; allowed: rectangle or disk");
            object.cause(message);
        }
        let shape = self.world.shapes.len();
        self.world.lights.push(Light::Sheet { shape, exitance });
    }

    /// The plugin of a shape's emitter, and the radiance, or what else it states.
    fn shape_emission(
        &mut self,
        object: ObjectRef<'a>,
        is_in_group: bool,
    ) -> Option<(&'a str, Texture)> {
        let emitter = self.child(object, "emitter")?;
        if !["area", COLLIMATED].contains(&emitter.plugin.as_str()) {
            return self.unsupported(emitter, "area or directionalarea, within a shape");
        }
        if is_in_group {
            emitter.cause("an emitter within a shapegroup");
        }
        let emission = self.emission(emitter, "radiance")?;
        Some((&emitter.plugin, emission))
    }
}

/// Checks whether a mesh has vertex normals that are not those of its triangles.
fn is_smooth(mesh: &Triangles) -> bool {
    let (places, Some(normals)) = (mesh.vertices(), mesh.normals()) else {
        return false;
    };
    mesh.corners().iter().any(|corners| {
        let [a, b, c] = corners.map(|i| places[i as usize]);
        let own = (b - a).cross(c - a).normalize_or_zero();
        // Normals of a file have few digits.
        let is_own = |i: &u32| own.cross(normals[*i as usize]).length() < 1e-3;
        !corners.iter().all(is_own)
    })
}
