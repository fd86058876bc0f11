//! Textures of type `mesh_attribute`: numbers of the vertices or faces of a PLY mesh.

use super::mesh_data::MitsubaMesh;
use super::object::{MitsubaObject, ObjectKind, Value};
use super::reader::MitsubaReader;
use crate::range::MAX_NUMBER;
use crate::report::quoted;
use crate::spectrum::Role;
use etendue_world::{MeshValues, Texture};
use std::collections::HashSet;
use std::rc::Rc;
use std::sync::Arc;

impl<'a> MitsubaReader<'a> {
    /// Returns the names of the attributes that the textures within an object use, in alphabetical
    /// order.
    pub(super) fn wanted(&mut self, object: &'a MitsubaObject) -> Rc<[String]> {
        if let Some(known) = self.wanted.get(&object.number) {
            return Rc::clone(known);
        }
        let mut names = Vec::new();
        let (mut seen, mut left) = (HashSet::new(), vec![object]);
        while let Some(object) = left.pop() {
            if !seen.insert(object.number) {
                continue;
            }
            if object.kind == ObjectKind::Texture && object.plugin == "mesh_attribute" {
                names.extend(object.last("name").and_then(|name| match &name.value {
                    Value::Text(name) => Some(name.clone()),
                    _ => None,
                }));
            }
            let inner = object.properties.iter().filter_map(|p| self.object_of(p));
            left.extend(inner.filter(|inner| {
                matches!(
                    inner.kind,
                    ObjectKind::Bsdf | ObjectKind::Texture | ObjectKind::Emitter
                )
            }));
        }
        names.sort_unstable();
        names.dedup();
        let names: Rc<[String]> = names.into();
        self.wanted.insert(object.number, Rc::clone(&names));
        names
    }

    /// Reads a texture of type `mesh_attribute`.
    pub(super) fn mesh_attribute(
        &mut self,
        object: &'a MitsubaObject,
        role: Role,
    ) -> Option<Texture> {
        let scale = match self.has(object, "scale") {
            true => self.number(object, "scale")?,
            false => 1.0,
        };
        if !self.has(object, "name") {
            self.report
                .cause(&object.place, "mesh_attribute without name");
        }
        let name = self.text(object, "name")?;
        let found = self.current_mesh.clone().ok_or_else(|| {
            "of a shape without a mesh; allowed: vertex_… or face_… of a ply shape".to_owned()
        });
        let values = found.and_then(|mesh| self.values(&mesh, name, scale, role));
        match values {
            Ok(values) => Some(Texture::OfMesh(values)),
            Err(error) => {
                let message = format!("mesh_attribute {} {error}", quoted(name));
                self.fault(object, "name", message)
            }
        }
    }

    /// Returns the numbers of an attribute. A colour becomes one number.
    fn values(
        &self,
        mesh: &MitsubaMesh,
        name: &str,
        scale: f64,
        role: Role,
    ) -> Result<MeshValues, String> {
        let Some(of) = mesh.attributes.read.iter().find(|of| of.name == name) else {
            return Err(format!("is missing; {}", mesh.attributes.listed()));
        };
        let is_color = match (of.channels, role) {
            (1, _) => false,
            (3, Role::Reflectance | Role::Emission) => true,
            (channels, Role::Number) => {
                return Err(format!(
                    "has {channels} numbers; allowed: 1, for this property"
                ));
            }
            (channels, _) => return Err(format!("has {channels} numbers; allowed: 1 or 3")),
        };
        // The memory is counted for each texture, because textures may repeat an attribute.
        self.files
            .spend((of.values.len() * size_of::<f64>()) as u64)?;
        let values: Vec<f64> = match is_color {
            false => of.values.iter().map(|value| scale * value).collect(),
            true => {
                let (colors, _) = of.values.as_chunks::<3>();
                colors.iter().map(|c| scale * self.color.of(*c)).collect()
            }
        };
        if let Some(value) = values.iter().find(|value| value.abs() > MAX_NUMBER) {
            return Err(format!(
                "times scale is {value}; allowed: up to {MAX_NUMBER}"
            ));
        }
        let mesh = Arc::clone(&mesh.triangles);
        let made = match of.is_of_vertices {
            true => MeshValues::of_vertices(mesh, values),
            false => MeshValues::of_triangles(mesh, values),
        };
        made.ok_or_else(|| "does not fit the mesh".to_owned())
    }
}
