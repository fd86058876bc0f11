//! Gives bytes to the readers of Étendue. A reader must not panic, and must not take memory or
//! time out of proportion to the bytes.

use etendue_import::Options;
use etendue_meshfile::Mesh;
use etendue_scene::{SceneFile, read_channels, resolve};
use std::path::{Path, PathBuf};

/// The largest memory, in bytes, for which a scene may ask.
const MEMORY: u64 = 1 << 28;

/// A scene file in RON or JSON.
pub fn scene(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    if let Ok(file) = SceneFile::parse(text) {
        let _ = resolve("fuzz", file, &empty_folder(), MEMORY);
    }
}

/// A scene of Mitsuba 3.
pub fn mitsuba(bytes: &[u8]) {
    if let Ok(text) = std::str::from_utf8(bytes) {
        let _ = etendue_import::import_mitsuba(text, &empty_folder(), &Options::default());
    }
}

/// A scene of pbrt-v4.
pub fn pbrt(bytes: &[u8]) {
    if let Ok(text) = std::str::from_utf8(bytes) {
        let _ = etendue_import::import_pbrt(text, &empty_folder(), &Options::default());
    }
}

/// A scene in glTF, binary or JSON.
pub fn gltf(bytes: &[u8]) {
    let is_binary = bytes.starts_with(b"glTF");
    imported(if is_binary { "scene.glb" } else { "scene.gltf" }, bytes);
}

/// A scene in OBJ.
pub fn obj(bytes: &[u8]) {
    imported("scene.obj", bytes);
}

/// A mesh in PLY.
pub fn ply(bytes: &[u8]) {
    let _ = Mesh::parse(Path::new("mesh.ply"), bytes);
}

/// A picture in OpenEXR, Radiance HDR, PNG, JPEG or BMP.
pub fn picture(bytes: &[u8]) {
    let first: [(&[u8], &str); 5] = [
        (b"\x76\x2f\x31\x01", "exr"),
        (b"#?", "hdr"),
        (b"\x89PNG", "png"),
        (b"\xff\xd8", "jpg"),
        (b"BM", "bmp"),
    ];
    if let Some((_, ending)) = first.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        let _ = read_channels(&Path::new("picture").with_extension(ending), bytes, u64::MAX);
    }
}

/// A ray file in TM-25, MCPL or NPY.
pub fn rays(bytes: &[u8]) {
    if let Ok(file) = etendue_rayfile::RayFile::read(bytes) {
        let _ = file.rays();
    }
}

/// The arrays of a stored stage, as `batches.npz` has them.
pub fn batches(bytes: &[u8]) {
    let Ok(mut file) =
        etendue_store::npz::NpzFile::new(PathBuf::from("batches.npz"), bytes.to_vec())
    else {
        return;
    };
    let _ = file.axis("rho");
    let _ = file.array::<u32, _>("batch", [4]);
    let _ = file.array::<f64, _>("ledger", [4, 4]);
    let _ = file.array::<etendue_field::Complex, _>("slices", [4, 1, 3, 5]);
}

/// Imports a file that holds the bytes.
fn imported(name: &str, bytes: &[u8]) {
    let path = empty_folder().join(name);
    if std::fs::write(&path, bytes).is_ok() {
        let _ = etendue_import::import(&path, &Options::default());
    }
}

/// Returns a folder of this process that holds no file to which the bytes could refer.
fn empty_folder() -> PathBuf {
    let folder = std::env::temp_dir().join(format!("etendue-fuzz-{}", std::process::id()));
    let _ = std::fs::create_dir_all(&folder);
    folder
}
