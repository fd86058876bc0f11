//! PLY files, each of which contains one mesh.

use crate::main_file::MainFile;
use crate::meshes::{MENDED, MeshParts};
use crate::{Imported, Options, Refused};
use etendue_meshfile::DetailedMesh;
use etendue_world::{Geometry, Material, Shape, World};
use glam::DAffine3;
use std::path::Path;
use std::sync::Arc;

/// Imports one diffuse surface of reflectance 0.5 on both sides.
pub(crate) fn import(file: &Path, options: &Options) -> Result<Imported, Refused> {
    let scene = MainFile::open(file, options)?;
    let unsound = |error: String| scene.refused(format!("is not a valid mesh: {error}"));
    let read = DetailedMesh::parse(file, &scene.read()?);
    let read = read.map_err(|fault| unsound(fault.to_string()))?;
    let mut parts = MeshParts::from(read);
    parts.drop_empty();
    parts.face_normals();
    let mended = parts.mend_normals();
    let mesh = parts.finish().map(|mesh| Geometry::Mesh(Arc::new(mesh)));
    let mesh = mesh.ok_or_else(|| unsound("no triangle with an area above 0".to_owned()))?;
    let place = scene.place();
    if mended {
        scene.report.note(&place, MENDED);
    }
    let message = "has no material: a diffuse material of reflectance 0.5 is used on both sides";
    scene.report.note(&place, message);
    let world = World {
        shapes: vec![Shape::new(mesh, DAffine3::IDENTITY, 0)],
        materials: vec![Material::diffuse(0.5).on_both_sides()],
        ..World::default()
    };
    scene.finish(world)
}
