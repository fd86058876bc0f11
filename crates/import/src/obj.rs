//! Scenes of OBJ files with the materials of MTL files (Wavefront, Advanced Visualizer manual, appendices B1 and B2); and single meshes, PLY.
//!
//! - Coordinates are the file's, right-handed. There is no camera.
//! - Each part between `usemtl` lines is a shape. Without a material it is diffuse, 0.5.
//! - Surfaces scatter light on both sides and shine on their front: where their normals point, or where corners run counterclockwise.
//! - `Kd`, `Ks`, `Ke` and `Tf` are linear; pictures are sRGB, and factors of them. Their first row is at v = 1.
//! - `Ke` is radiance, W m⁻² sr⁻¹.

mod entry;
mod map;
mod material;
mod mtl;
mod ply;
mod reader;
mod surface;

pub(crate) use ply::import as import_ply;

use crate::files::Files;
use crate::report::{Report, SourcePlace};
use crate::{Imported, Options, Refused};
use etendue_scene::ObjFile;
use std::path::Path;

pub(crate) fn import(file: &Path, options: &Options) -> Result<Imported, Refused> {
    let (files, path, bytes) = Files::open(file, options)?;
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let read = ObjFile::parse(&bytes);
    let read =
        read.map_err(|fault| Refused::because(file, format!("is no sound mesh: {fault}")))?;
    drop(bytes);
    let report = Report::default();
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let reader = reader::ObjReader::new(
        &files,
        &report,
        SourcePlace::whole(&name),
        folder,
        options.color,
    );
    let world = reader.world(read);
    report.finish(world)
}
