//! Shapes that are meshes.

use super::mesh_data::{MitsubaAttributes, MitsubaMesh, MitsubaMeshKey, ReadMesh};
use super::object::ObjectRef;
use super::reader::MitsubaReader;
use super::serialized;
use crate::files::has_extension;
use crate::meshes::{MENDED, MeshParts, NO_AREA};
use crate::report::quoted;
use etendue_meshfile::DetailedMesh;
use glam::{DAffine3, DMat3, DVec2, DVec3};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

/// The normal and corners of each side of the cube. Bit k of a corner is set if coordinate k of the
/// corner is 1.
const SIDES: [([f64; 3], [u32; 4]); 6] = [
    ([0.0, -1.0, 0.0], [1, 5, 4, 0]),
    ([0.0, 1.0, 0.0], [3, 2, 6, 7]),
    ([1.0, 0.0, 0.0], [1, 3, 7, 5]),
    ([0.0, 0.0, 1.0], [5, 7, 6, 4]),
    ([-1.0, 0.0, 0.0], [4, 6, 2, 0]),
    ([0.0, 0.0, -1.0], [3, 1, 0, 2]),
];

impl<'a> MitsubaReader<'a> {
    pub(super) fn cube(&self, object: ObjectRef<'a>) -> Option<MitsubaMesh> {
        let triangles = cube_parts().finish()?;
        Some(MitsubaMesh {
            triangles: Arc::new(triangles),
            attributes: Rc::default(),
            is_flipped: object.truth("flip_normals"),
        })
    }

    /// Reads an OBJ, PLY or serialized mesh.
    pub(super) fn mesh(
        &mut self,
        object: ObjectRef<'a>,
        to_world: DAffine3,
    ) -> Option<MitsubaMesh> {
        let flips = object.truth("flip_normals");
        let is_flat = object.truth("face_normals");
        let is_obj = object.plugin == "obj";
        let flips_uv = match object.plugin.as_str() {
            "serialized" => false,
            // By default Mitsuba flips texture coordinates of OBJ files.
            _ if !object.has("flip_tex_coords") => is_obj,
            _ => object.truth("flip_tex_coords"),
        };
        let number = self.shape_index(object)?;
        let name = object.file_name()?;
        let key = MitsubaMeshKey {
            path: self.mesh_path(object, name)?,
            number,
            is_flat,
            is_flipped: flips_uv,
            attributes: self.wanted(object),
            linear: (!is_flat).then(|| bits(to_world.matrix3)),
        };
        let (triangles, is_made) = self.triangles(object, &key, to_world);
        let (triangles, attributes) = match triangles {
            Ok(read) => read,
            Err(error) if error == NO_AREA => {
                object.note(format!("file {} {NO_AREA} and is left out", quoted(name)));
                self.is_left_out = true;
                return None;
            }
            Err(error) => return object.unread(name, &error),
        };
        // Mitsuba computes missing normals from the placed triangles, so a mirroring placement
        // flips computed normals. Normals from a file are transformed with the mesh.
        let is_mirrored = to_world.matrix3.determinant() < 0.0;
        Some(MitsubaMesh {
            triangles,
            attributes,
            is_flipped: flips != (is_mirrored && is_made),
        })
    }

    fn shape_index(&self, object: ObjectRef<'a>) -> Option<u32> {
        if object.plugin != "serialized" || !object.has("shape_index") {
            return Some(0);
        }
        let value = object.whole("shape_index")?;
        let number = u32::try_from(value).ok();
        number.or_else(|| {
            let message = format!("shape_index is {value}; allowed: 0 or more");
            object.fault("shape_index", message)
        })
    }

    fn mesh_path(&self, object: ObjectRef<'a>, name: &str) -> Option<PathBuf> {
        let path = match self.files.find(&object.folders, name) {
            Ok(path) => path,
            Err(error) => return object.unread(name, &error),
        };
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        let extension = extension.to_ascii_lowercase();
        if object.plugin != "serialized" && extension != object.plugin {
            let error = format!("has extension {}", quoted(&extension));
            return object.unread(name, &error);
        }
        Some(path)
    }

    /// The triangles of a mesh, and whether their normals were computed.
    fn triangles(
        &mut self,
        object: ObjectRef<'a>,
        key: &MitsubaMeshKey,
        to_world: DAffine3,
    ) -> (ReadMesh, bool) {
        // A mesh that has its own normals can be shared by all its placements.
        let everywhere = MitsubaMeshKey {
            linear: None,
            is_flat: false,
            ..key.clone()
        };
        if !key.is_flat
            && let Some(known) = self.meshes.get(&everywhere)
        {
            return (known.clone(), false);
        }
        if let Some(known) = self.meshes.get(key) {
            return (known.clone(), true);
        }
        let read = self.parts(key);
        let has_normals = !key.is_flat
            && read
                .as_ref()
                .is_ok_and(|(parts, _)| parts.normals.is_some());
        let made = read.and_then(|read| self.finish(object, read, key, to_world.matrix3));
        let key = if has_normals { everywhere } else { key.clone() };
        self.meshes.insert(key, made.clone());
        (made, !has_normals)
    }

    fn parts(&mut self, key: &MitsubaMeshKey) -> Result<(MeshParts, MitsubaAttributes), String> {
        let bytes = self.mesh_bytes(&key.path)?;
        if !["obj", "ply"]
            .map(|e| has_extension(&key.path, e))
            .contains(&true)
        {
            let parts = serialized::read(&bytes, key.number, self.files)?;
            return Ok((parts, MitsubaAttributes::default()));
        }
        let read = DetailedMesh::parse_with(&key.path, &bytes, &key.attributes);
        let mut mesh = read.map_err(|fault| format!("is not a valid mesh: {fault}"))?;
        let attributes = MitsubaAttributes::take(&mut mesh);
        Ok((MeshParts::from(mesh), attributes))
    }

    fn mesh_bytes(&mut self, path: &Path) -> Result<Arc<[u8]>, String> {
        if let Some(known) = self.packed.get(path) {
            return known.clone();
        }
        let read = self.files.read(path).map(Arc::from);
        self.packed.insert(path.to_owned(), read.clone());
        read
    }

    fn finish(
        &self,
        object: ObjectRef<'a>,
        (mut parts, mut attributes): (MeshParts, MitsubaAttributes),
        key: &MitsubaMeshKey,
        linear: DMat3,
    ) -> ReadMesh {
        // The memory is counted for each mesh, because shapes that share a file may have different
        // meshes.
        self.files.spend(parts.bytes() + attributes.bytes())?;
        attributes.keep(&parts.drop_empty());
        if key.is_flipped {
            for uv in parts.uvs.iter_mut().flatten() {
                uv.y = 1.0 - uv.y;
            }
        }
        match (key.is_flat, &parts.normals) {
            (true, _) => parts.normals = None,
            (false, None) => parts.smooth(linear),
            (false, Some(_)) => {
                parts.face_normals();
                if parts.mend_normals() {
                    object.note(MENDED);
                }
            }
        }
        let made = parts.finish().map(Arc::new);
        made.map(|triangles| (triangles, Rc::new(attributes)))
            .ok_or_else(|| NO_AREA.to_owned())
    }
}

fn bits(linear: DMat3) -> [u64; 9] {
    // Adding 0 to a number turns −0 into 0.
    linear.to_cols_array().map(|v| (v + 0.0).to_bits())
}

/// The direction to which a map takes Z, or `None` for a singular map.
pub(super) fn z_of(map: DAffine3) -> Option<DVec3> {
    map.matrix3.z_axis.try_normalize()
}

fn cube_parts() -> MeshParts {
    let (mut vertices, mut normals, mut uvs) = (Vec::new(), Vec::new(), Vec::new());
    let mut corners = Vec::new();
    for (side, (normal, places)) in (0_u32..).zip(SIDES) {
        let first = 4 * side;
        for place in places {
            let coordinate = |k: u32| if place >> k & 1 == 1 { 1.0 } else { -1.0 };
            vertices.push(DVec3::new(coordinate(0), coordinate(1), coordinate(2)));
            normals.push(DVec3::from(normal));
        }
        uvs.extend([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]].map(DVec2::from));
        corners.push([first, first + 1, first + 2]);
        corners.push([first + 3, first, first + 2]);
    }
    MeshParts {
        vertices,
        corners,
        normals: Some(normals),
        uvs: Some(uvs),
    }
}
