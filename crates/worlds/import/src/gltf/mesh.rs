//! Primitives of meshes, as triangles.

use super::reader::GltfReader;
use crate::meshes::{MeshParts, NO_AREA};
use ::gltf::json::mesh::{Mode, Primitive, Semantic};
use ::gltf::json::validation::Checked;
use ::gltf::json::{Accessor, Index};
use glam::{DVec2, DVec3};

/// Maximum number of corners of a mesh, for which 32-bit indices suffice.
const MAX_CORNERS: usize = u32::MAX as usize;

fn attribute(primitive: &Primitive, of: Semantic) -> Option<Index<Accessor>> {
    primitive.attributes.get(&Checked::Valid(of)).copied()
}

impl GltfReader<'_> {
    /// Returns the triangles of a primitive, with the texture coordinates that its material uses;
    /// returns `None` if the primitive has no triangles, or if a cause of refusal was reported.
    pub(super) fn parts(
        &mut self,
        primitive: &Primitive,
        path: &str,
        set: Option<u32>,
    ) -> Option<MeshParts> {
        let Checked::Valid(mode) = primitive.mode else {
            return None;
        };
        self.tell_dropped(primitive, path);
        let vertices: Vec<[f64; 3]> = self.numbers(attribute(primitive, Semantic::Positions)?)?;
        let vertices: Vec<DVec3> = vertices.into_iter().map(DVec3::from).collect();
        let normals = match attribute(primitive, Semantic::Normals) {
            Some(index) => Some(self.numbers::<3>(index)?),
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
            return self.refuse(
                path,
                format!("an index is {bad}, but there are only {count} vertices"),
            );
        }
        let agrees = |length: usize| length == count;
        if !normals.as_ref().is_none_or(|n| agrees(n.len()))
            || !uvs.as_ref().is_none_or(|uvs| agrees(uvs.len()))
        {
            return self.refuse(path, "the attributes have different lengths");
        }
        let mut parts = MeshParts {
            vertices,
            corners: corners(&listed, mode),
            normals: normals.map(|n| n.into_iter().map(DVec3::from).collect()),
            uvs: uvs.map(|uvs| uvs.into_iter().map(DVec2::from).collect()),
        };
        self.finish(&mut parts, path)?;
        Some(parts)
    }

    /// Returns the corners of a primitive without indices, which are all vertices in order.
    fn all(&self, count: usize, path: &str) -> Option<Vec<u32>> {
        let count = u32::try_from(count.min(MAX_CORNERS)).ok()?;
        let spent = self.files.spend(u64::from(count) * 4);
        spent.map_err(|error| self.cause(path, error)).ok()?;
        Some((0..count).collect())
    }

    fn uvs(&mut self, primitive: &Primitive, path: &str, set: u32) -> Option<Vec<[f64; 2]>> {
        let Some(index) = attribute(primitive, Semantic::TexCoords(set)) else {
            let message = format!("has no TEXCOORD_{set}, which its material needs");
            return self.refuse(path, message);
        };
        self.numbers(index)
    }

    /// Removes triangles without area, and turns normals to the front.
    fn finish(&self, parts: &mut MeshParts, path: &str) -> Option<()> {
        let spent = self.files.spend(parts.bytes());
        spent.map_err(|error| self.cause(path, error)).ok()?;
        parts.drop_empty();
        if parts.corners.is_empty() {
            self.note(path, format!("{NO_AREA} and is left out"));
            return None;
        }
        let mended = parts.mend_normals();
        if mended {
            let message = "approximated: vertices without a normal use the normal of a triangle";
            self.note(path, message);
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
            self.note(
                &format!("{path}.targets"),
                "is left out: the mesh keeps its base shape",
            );
        }
        if attribute(primitive, Semantic::Colors(0)).is_some() {
            self.note(&format!("{path}.attributes.COLOR_0"), "is left out");
        }
        let others = primitive.extensions.iter().flat_map(|of| of.others.keys());
        for name in others {
            let name = crate::report::quoted(name);
            self.note(&format!("{path}.extensions"), format!("{name} is left out"));
        }
    }
}

/// Returns the triangles of a list, a strip or a fan. Every second triangle of a strip is flipped.
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
