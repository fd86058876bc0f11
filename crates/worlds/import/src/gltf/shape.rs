//! Conversion of the meshes of nodes to shapes.

use super::node::PlacedNode;
use super::reader::{GltfReader, GltfSurface};
use crate::meshes::{MENDED, MeshParts, NO_AREA};
use crate::range::{MAX_NUMBER, MAX_SHAPES};
use ::gltf::json::mesh::{Mode, Primitive, Semantic};
use ::gltf::json::validation::Checked;
use ::gltf::json::{Accessor, Index};
use etendue_world::{Geometry, Shape, Triangles};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// Maximum number of characters of a name.
const LONGEST: usize = 100;

/// Maximum number of corners of a mesh, for which 32-bit indices suffice.
const MAX_CORNERS: usize = u32::MAX as usize;

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
            self.primitive(placed, (number, i), primitive, &name);
        }
    }

    fn primitive(
        &mut self,
        placed: &PlacedNode<'a>,
        key: (usize, usize),
        primitive: &Primitive,
        name: &str,
    ) {
        let path = format!("meshes[{}].primitives[{}]", key.0, key.1);
        if self.world.shapes.len() >= MAX_SHAPES {
            // Only the first shape beyond the limit adds a cause of refusal.
            if !self.report.has_causes() {
                self.cause(&placed.path, format!("more than {MAX_SHAPES} shapes"));
            }
            return;
        }
        let Some(surface) = self.material(primitive.material.map(|m| m.value())) else {
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
        self.world.shapes.extend(known.map(|mesh| Shape {
            name: name.to_owned(),
            emission: surface.emission,
            emits_on_both_sides: surface.is_double_sided,
            ..Shape::new(Geometry::Mesh(mesh), placed.to_world, surface.material)
        }));
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

    /// The triangles of a primitive, with the texture coordinates that its material uses;
    /// returns `None` if the primitive has no triangles, or if a cause of refusal was reported.
    fn parts(&mut self, primitive: &Primitive, path: &str, set: Option<u32>) -> Option<MeshParts> {
        let Checked::Valid(mode) = primitive.mode else {
            return None;
        };
        self.tell_dropped(primitive, path);
        let vertices: Vec<DVec3> = self.vectors(attribute(primitive, Semantic::Positions)?)?;
        let normals = match attribute(primitive, Semantic::Normals) {
            Some(index) => Some(self.vectors::<DVec3, 3>(index)?),
            None => None,
        };
        let uvs = match set {
            Some(set) => Some(self.uvs(primitive, path, set)?),
            None => None,
        };
        let listed = match primitive.indices {
            Some(index) => self.indices(index)?,
            None => self.all(vertices.len(), path)?,
        };
        let count = vertices.len();
        if let Some(bad) = listed.iter().find(|i| **i as usize >= count) {
            let message = format!("an index is {bad}, but there are only {count} vertices");
            return self.refuse(path, message);
        }
        let lengths = [normals.as_ref().map(Vec::len), uvs.as_ref().map(Vec::len)];
        if lengths.iter().flatten().any(|length| *length != count) {
            return self.refuse(path, "the attributes have different lengths");
        }
        let mut parts = MeshParts {
            vertices,
            corners: corners(&listed, mode),
            normals,
            uvs,
        };
        self.finish(&mut parts, path)?;
        Some(parts)
    }

    /// The corners of a primitive without indices, which are all vertices in order.
    fn all(&self, count: usize, path: &str) -> Option<Vec<u32>> {
        let count = u32::try_from(count.min(MAX_CORNERS)).ok()?;
        self.accept(path, self.files.spend(u64::from(count) * 4))?;
        Some((0..count).collect())
    }

    fn uvs(&mut self, primitive: &Primitive, path: &str, set: u32) -> Option<Vec<DVec2>> {
        let Some(index) = attribute(primitive, Semantic::TexCoords(set)) else {
            let message = format!("has no TEXCOORD_{set}, which its material needs");
            return self.refuse(path, message);
        };
        self.vectors(index)
    }

    /// Removes triangles without area, and turns normals to the front.
    fn finish(&self, parts: &mut MeshParts, path: &str) -> Option<()> {
        self.accept(path, self.files.spend(parts.bytes()))?;
        parts.drop_empty();
        if parts.corners.is_empty() {
            self.note(path, format!("{NO_AREA} and is left out"));
            return None;
        }
        if parts.mend_normals() {
            self.note(path, MENDED);
        }
        let turned = parts.turn_normals();
        if turned > 0 {
            let message = format!(
                "{turned} normals point away from the front of their triangles, and are reversed"
            );
            self.note(path, message);
        }
        Some(())
    }

    fn tell_dropped(&self, primitive: &Primitive, path: &str) {
        if primitive.targets.is_some() {
            let message = "is left out: the mesh keeps its base shape";
            self.note(&format!("{path}.targets"), message);
        }
        if attribute(primitive, Semantic::Colors(0)).is_some() {
            self.note(&format!("{path}.attributes.COLOR_0"), "is left out");
        }
        let others = primitive.extensions.iter().flat_map(|of| of.others.keys());
        self.tell_others(path, others);
    }
}

fn attribute(primitive: &Primitive, of: Semantic) -> Option<Index<Accessor>> {
    primitive.attributes.get(&Checked::Valid(of)).copied()
}

/// The triangles of a list, a strip or a fan. Every second triangle of a strip is flipped.
fn corners(listed: &[u32], mode: Mode) -> Vec<[u32; 3]> {
    match mode {
        Mode::Triangles => listed.as_chunks().0.to_vec(),
        Mode::TriangleStrip => {
            let turned = |(i, w): (usize, &[u32])| match i % 2 {
                0 => [w[0], w[1], w[2]],
                _ => [w[0], w[2], w[1]],
            };
            listed.windows(3).enumerate().map(turned).collect()
        }
        Mode::TriangleFan => {
            let pairs = listed.get(1..).unwrap_or_default().windows(2);
            pairs.map(|pair| [pair[0], pair[1], listed[0]]).collect()
        }
        _ => Vec::new(),
    }
}
