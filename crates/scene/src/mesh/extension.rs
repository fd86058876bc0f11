//! Selects the format of a mesh file by its extension.

use super::text;
use etendue_scenefile::{Fault, fault};
use std::path::Path;

/// Reads bytes in the format to which the extension of `file` belongs.
pub(super) fn by_extension<T>(
    file: &Path,
    bytes: &[u8],
    obj: fn(&[u8]) -> Result<T, Fault>,
    ply: impl FnOnce(&[u8]) -> Result<T, Fault>,
) -> Result<T, Fault> {
    let extension = file.extension().unwrap_or_default().to_string_lossy();
    match extension.to_ascii_lowercase().as_str() {
        "obj" | "ply" if bytes.is_empty() => Err(fault("the file", "empty", "a mesh")),
        "obj" => obj(bytes),
        "ply" => ply(bytes),
        _ => Err(fault(
            "the extension",
            text::quoted(extension.as_bytes()),
            "obj, ply",
        )),
    }
}
