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
mod ply;
mod reader;

pub(crate) use ply::import as import_ply;

use crate::main_file::MainFile;
use crate::{Imported, Options, Refused};
use etendue_meshfile::ObjFile;
use std::path::Path;

pub(crate) fn import(file: &Path, options: &Options) -> Result<Imported, Refused> {
    let file = MainFile::open(file, options)?;
    let read = ObjFile::parse(&file.read()?);
    let read = read.map_err(|fault| file.refused(format!("is not a valid mesh: {fault}")))?;
    let world = reader::ObjReader::new(&file).world(read);
    file.finish(world)
}
