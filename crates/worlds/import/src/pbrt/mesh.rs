//! Shapes that are meshes.

use super::build;
use super::entity::{CauseGiven, Entity, Read};
use super::reader::PbrtReader;
use super::scene::PbrtShape;
use crate::files::has_extension;
use crate::meshes::{MeshParts, NO_AREA};
use crate::report::quoted;
use etendue_meshfile::DetailedMesh;
use etendue_world::Triangles;
use glam::{DAffine3, DVec2, DVec3};
use std::path::Path;
use std::sync::Arc;

/// Maximum relative deviation of a patch from a plane or a parallelogram.
const FLAT: f64 = 1e-5;

/// Default (u, v) at the corners of triangles.
const TRIANGLE: [DVec2; 3] = [DVec2::ZERO, DVec2::X, DVec2::ONE];

/// Default (u, v) at the corners of patches.
const PATCH: [DVec2; 4] = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];

/// The triangles of a mesh. If they form a single triangle or a single patch, their area in the
/// world is also stored.
pub(super) struct PbrtMesh {
    pub(super) triangles: Arc<Triangles>,
    pub(super) area: Option<f64>,
}

impl PbrtReader<'_> {
    pub(super) fn mesh(&mut self, shape: &PbrtShape<'_>, needs_uv: bool) -> Read<PbrtMesh> {
        let entity = &shape.entity;
        let (triangles, each) = match entity.plugin.as_str() {
            "trianglemesh" => (self.triangle_mesh(entity, needs_uv)?, 1),
            "plymesh" => (self.ply(entity, needs_uv)?, 1),
            _ => (self.bilinear(entity, needs_uv)?, 2),
        };
        let is_one = triangles.corners().len() <= each;
        let area = is_one.then(|| area(&triangles, shape.to_world));
        Ok(PbrtMesh { triangles, area })
    }

    fn ply(&mut self, entity: &Entity<'_>, needs_uv: bool) -> Read<Arc<Triangles>> {
        if entity.has("displacement") {
            return Err(entity.fault("displacement", "displacement of a mesh is not supported"));
        }
        let name = self.file_name(entity)?;
        let unread = |error: &String| self.unread(entity, name, error);
        let path = self.find(name).map_err(|error| unread(&error))?;
        let key = (path, needs_uv);
        if let Some(known) = self.meshes.get(&key) {
            return known.clone().map_err(|error| unread(&error));
        }
        let parts = self.ply_parts(&key.0);
        let made = parts.and_then(|parts| self.finish(parts, needs_uv));
        let made = made.inspect_err(|error| {
            unread(error);
        });
        self.meshes.insert(key, made.clone());
        made.map_err(|_| CauseGiven)
    }

    fn ply_parts(&self, path: &Path) -> Result<MeshParts, String> {
        let bytes = build::bytes(self.files, path)?;
        let inner = match has_extension(path, "gz") {
            true => path.with_extension(""),
            false => path.to_owned(),
        };
        let extension = inner.extension().unwrap_or_default();
        if !extension.eq_ignore_ascii_case("ply") {
            let extension = quoted(&extension.to_string_lossy());
            return Err(format!("has extension {extension}; allowed: ply, ply.gz"));
        }
        let mesh = DetailedMesh::parse(&inner, &bytes);
        mesh.map(MeshParts::from)
            .map_err(|fault| format!("is not a valid mesh: {fault}"))
    }

    fn triangle_mesh(&mut self, entity: &Entity<'_>, needs_uv: bool) -> Read<Arc<Triangles>> {
        let (mut parts, corners) = self.indexed::<3>(entity)?;
        parts.corners = corners;
        self.made(entity, parts, needs_uv)
    }

    /// Converts bilinear patches to meshes with two triangles for each patch.
    fn bilinear(&mut self, entity: &Entity<'_>, needs_uv: bool) -> Read<Arc<Triangles>> {
        let (shared, patches) = self.indexed::<4>(entity)?;
        let mut parts = MeshParts {
            vertices: Vec::new(),
            corners: Vec::new(),
            normals: shared.normals.as_ref().map(|_| Vec::new()),
            uvs: Some(Vec::new()),
        };
        for patch in patches {
            let at = patch.map(|i| i as usize);
            let corners = at.map(|i| shared.vertices[i]);
            self.check_patch(entity, corners, needs_uv)?;
            // The number of vertices is below 2³², since each index of the file gives one vertex.
            let first = u32::try_from(parts.vertices.len()).map_err(|_| CauseGiven)?;
            parts.vertices.extend(corners);
            if let (Some(to), Some(of)) = (&mut parts.normals, &shared.normals) {
                to.extend(at.map(|i| of[i]));
            }
            let uv = |k: usize| shared.uvs.as_ref().map_or(PATCH[k], |uvs| uvs[at[k]]);
            let uvs = parts.uvs.get_or_insert_default();
            uvs.extend([0, 1, 2, 3].map(uv));
            let triangles = [[0, 1, 3], [0, 3, 2]].map(|t| t.map(|k: u32| first + k));
            parts.corners.extend(triangles);
        }
        self.made(entity, parts, needs_uv)
    }

    /// Checks a bilinear patch, which becomes two triangles. A patch that is not planar is a cause
    /// of refusal. A planar patch that is not a parallelogram gets a note, because texture
    /// coordinates inside the patch differ from pbrt's.
    fn check_patch(
        &self,
        entity: &Entity<'_>,
        [a, b, c, d]: [DVec3; 4],
        needs_uv: bool,
    ) -> Read<()> {
        let (along, across, diagonal) = (b - a, c - a, d - a);
        let size = along.length().max(across.length()).max(diagonal.length());
        let volume = along.cross(across).dot(diagonal).abs();
        if volume > FLAT * size * size * size {
            return Err(entity.fault("P", "a patch is not flat; allowed: flat patches"));
        }
        if needs_uv && (along + across - diagonal).length() > FLAT * size {
            let message = "approximated: a patch that is not a parallelogram has the texture coordinates of two triangles";
            self.report.note_once(&entity.place, message);
        }
        Ok(())
    }

    /// Reads the vertices with their attributes, and the indices of each face of `N` corners.
    fn indexed<const N: usize>(&self, entity: &Entity<'_>) -> Read<(MeshParts, Vec<[u32; N]>)> {
        let vertices = entity.points("P", "point3")?;
        let indices = entity.numbers("indices", &["integer"])?;
        let faces = faces(entity, indices, vertices.len())?;
        let parts = MeshParts {
            normals: self.beside(entity, "N", &vertices, entity.points("N", "normal")?),
            uvs: self.beside(entity, "uv", &vertices, entity.pairs("uv")?),
            vertices,
            corners: Vec::new(),
        };
        Ok((parts, faces))
    }

    /// An attribute of the vertices. As in pbrt, an attribute with a wrong number of values
    /// is left out.
    fn beside<T>(
        &self,
        entity: &Entity<'_>,
        name: &str,
        vertices: &[DVec3],
        all: Vec<T>,
    ) -> Option<Vec<T>> {
        if all.len() != vertices.len() && !all.is_empty() {
            let (found, count) = (all.len(), vertices.len());
            let message = format!(
                "{name} is left out: the mesh has {count} vertices, but {name} has values for {found}"
            );
            self.report.note_once(entity.place_of(name), &message);
            return None;
        }
        (!all.is_empty()).then_some(all)
    }

    fn made(&self, entity: &Entity<'_>, parts: MeshParts, needs_uv: bool) -> Read<Arc<Triangles>> {
        let made = self.finish(parts, needs_uv);
        made.map_err(|error| entity.refuse(format!("the mesh {error}")))
    }

    fn finish(&self, mut parts: MeshParts, needs_uv: bool) -> Result<Arc<Triangles>, String> {
        self.files.spend(parts.bytes())?;
        parts.drop_empty();
        if needs_uv && parts.uvs.is_none() {
            parts = apart(parts)?;
            self.files.spend(parts.bytes())?;
        }
        // Normals determine the front, as in pbrt.
        parts.face_normals();
        parts.mend_normals();
        let made = parts.finish().map(Arc::new);
        made.ok_or_else(|| NO_AREA.to_owned())
    }
}

/// The indices of each face of `N` corners, among `count` vertices.
fn faces<const N: usize>(
    entity: &Entity<'_>,
    indices: &[f64],
    count: usize,
) -> Read<Vec<[u32; N]>> {
    if indices.is_empty() && count == N {
        #[expect(clippy::cast_possible_truncation, reason = "3 or 4")]
        let all = std::array::from_fn(|i| i as u32);
        return Ok(vec![all]);
    }
    if indices.is_empty() || !indices.len().is_multiple_of(N) {
        let count = indices.len();
        let message = format!("{count} indices are given; allowed: {N} for each face");
        return Err(entity.fault("indices", message));
    }
    let count = count as f64;
    if let Some(wrong) = indices.iter().find(|i| !(0.0..count).contains(*i)) {
        let message = format!("an index is {wrong}, but there are only {count} vertices");
        return Err(entity.fault("indices", message));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "each number is the index of a vertex"
    )]
    let face = |face: &[f64]| std::array::from_fn(|k| face[k] as u32);
    Ok(indices.chunks_exact(N).map(face).collect())
}

/// The triangles without shared vertices, and with pbrt's default texture coordinates.
fn apart(parts: MeshParts) -> Result<MeshParts, String> {
    let count = u32::try_from(parts.corners.len()).ok();
    let count = count.filter(|count| count.checked_mul(3).is_some());
    let count = count.ok_or("has too many triangles")?;
    let all = || parts.corners.iter().flatten().map(|i| *i as usize);
    let normals = parts.normals.as_ref();
    Ok(MeshParts {
        vertices: all().map(|i| parts.vertices[i]).collect(),
        normals: normals.map(|normals| all().map(|i| normals[i]).collect()),
        uvs: Some(parts.corners.iter().flat_map(|_| TRIANGLE).collect()),
        corners: (0..count).map(|i| [0, 1, 2].map(|k| 3 * i + k)).collect(),
    })
}

fn area(triangles: &Triangles, to_world: DAffine3) -> f64 {
    let corners = triangles.corners().iter();
    let areas = corners.map(|corners| {
        let [a, b, c] =
            corners.map(|i| to_world.transform_point3(triangles.vertices()[i as usize]));
        0.5 * (b - a).cross(c - a).length()
    });
    areas.sum()
}
