//! Scenes of OBJ files with the materials of MTL files (Wavefront, Advanced Visualizer manual,
//! appendices B1 and B2), and single meshes of PLY files.
//!
//! * Coordinates are kept as they are in the file, and are right-handed. There is no camera.
//! * Each part between `usemtl` lines is a shape. A shape without a material is diffuse with
//!   reflectance 0.5.
//! * Surfaces scatter light on both sides and emit light on their front. The front is the side to
//!   which the normals point or, without normals, the side from which corners run counterclockwise.
//! * `Kd`, `Ks`, `Ke` and `Tf` are linear. Pictures are sRGB, and their linear values multiply the
//!   numbers of `Kd`, `Ks`, `Ke` and `Tf`. The first row of a picture is at v = 1.
//! * `Ke` is radiance, W m⁻² sr⁻¹.

mod material;
mod mtl;
mod reader;

use crate::main_file::MainFile;
use crate::meshes::{MENDED, MeshParts};
use crate::{Imported, Options, Refused};
use etendue_meshfile::{DetailedMesh, ObjFile};
use etendue_world::{Geometry, Material, Shape, World};
use glam::DAffine3;
use std::path::Path;
use std::sync::Arc;

pub(crate) fn import(file: &Path, options: &Options) -> Result<Imported, Refused> {
    let file = MainFile::open(file, options)?;
    let read = ObjFile::parse(&file.read()?);
    let read = read.map_err(|fault| file.refused(format!("is not a valid mesh: {fault}")))?;
    let world = reader::ObjReader::new(&file).world(read);
    file.finish(world)
}

/// Imports one diffuse surface of reflectance 0.5 on both sides.
pub(crate) fn import_ply(file: &Path, options: &Options) -> Result<Imported, Refused> {
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
