//! Conversion of the meshes of nodes to shapes.

use super::node::PlacedNode;
use super::reader::{GltfReader, MAX_SHAPES};
use super::surface::GltfSurface;
use crate::range::MAX_NUMBER;
use ::gltf::json::mesh::{Mode, Primitive};
use ::gltf::json::validation::Checked;
use etendue_world::{Geometry, Shape, Triangles};
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// Maximum number of characters of a name.
const LONGEST: usize = 100;

impl<'a> GltfReader<'a> {
    /// Adds the shapes of a mesh, one for each primitive.
    pub(super) fn mesh_of(&mut self, placed: &PlacedNode<'a>, number: usize) {
        let Some(mesh) = self.root.meshes.get(number) else {
            return;
        };
        // The determinant is compared with a small limit, because rounding may keep it from being
        // exactly 0.
        let linear = placed.to_world.matrix3;
        let lengths = [linear.x_axis, linear.y_axis, linear.z_axis].map(DVec3::length);
        let size: f64 = lengths.iter().product();
        let is_tiny = lengths.iter().any(|length| *length < 1.0 / MAX_NUMBER);
        if is_tiny || linear.determinant().abs() <= 1e-12 * size {
            let message = "scales the mesh of this node to size 0: the mesh is left out";
            return self.note(&placed.path, message);
        }
        let own = || mesh.name.clone();
        let name = placed.node.name.clone().or_else(own).unwrap_or_default();
        // The name is shortened because each of many nodes may repeat the name of one mesh.
        let name: String = name.chars().take(LONGEST).collect();
        for (i, primitive) in mesh.primitives.iter().enumerate() {
            self.primitive(placed, [number, i], primitive, &name);
        }
    }

    fn primitive(
        &mut self,
        placed: &PlacedNode<'a>,
        key: [usize; 2],
        primitive: &Primitive,
        name: &str,
    ) {
        let path = format!("meshes[{}].primitives[{}]", key[0], key[1]);
        if self.world.shapes.len() >= MAX_SHAPES {
            // Only the first shape beyond the limit adds a cause of refusal.
            if !self.report.has_causes() {
                self.cause(&placed.path, format!("more than {MAX_SHAPES} shapes"));
            }
            return;
        }
        let key = (key[0], key[1]);
        let surface = self.material(primitive.material.map(|m| m.value()));
        let Some(surface) = surface else {
            return;
        };
        let known = match self.meshes.get(&key) {
            Some(known) => known.clone(),
            None => {
                let made = self.triangles(primitive, &path, &surface);
                self.meshes.insert(key, made.clone());
                made
            }
        };
        let Some(triangles) = known else {
            return;
        };
        self.add(triangles, placed.to_world, name, &surface);
    }

    fn triangles(
        &mut self,
        primitive: &Primitive,
        path: &str,
        surface: &GltfSurface,
    ) -> Option<Arc<Triangles>> {
        let Checked::Valid(mode) = primitive.mode else {
            return None;
        };
        if !matches!(
            mode,
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
        ) {
            self.note(path, format!("{mode:?} is left out; allowed: triangles"));
            return None;
        }
        let parts = self.parts(primitive, path, surface.set)?;
        parts.finish().map(Arc::new)
    }

    fn add(&mut self, mesh: Arc<Triangles>, to_world: DAffine3, name: &str, surface: &GltfSurface) {
        self.world.shapes.push(Shape {
            name: name.to_owned(),
            geometry: Geometry::Mesh(mesh),
            to_world,
            is_flipped: false,
            material: surface.material,
            emission: surface.emission.clone(),
            emits_on_both_sides: surface.is_double_sided,
        });
    }
}
