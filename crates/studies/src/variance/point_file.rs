//! Reads sets of points from NPY files, for studies of variance.

use super::{MAX_POINTS, PointFile, WindowPoint};
use etendue_rayfile::NpyHeader;
use etendue_scene::read_file;
use etendue_store::{ArgumentStyle, Failure};
use std::path::Path;

/// The largest number of bytes of a file: the points, and a long header.
const MAX_BYTES: u64 = (MAX_POINTS * size_of::<WindowPoint>() + (1 << 16)) as u64;

/// Reads an array f64 [N, 4] in C order.
pub fn read(path: &Path, arguments: ArgumentStyle) -> Result<PointFile, Failure> {
    let refused = |fault: &dyn std::fmt::Display| {
        let argument = arguments.with("samplers", path.display());
        Failure::bad_input(format!("{argument}: {fault}"))
    };
    let bytes = read_file(path, MAX_BYTES).map_err(|e| refused(&e))?;
    let array = array(&bytes).map_err(|found| {
        refused(&format!(
            "{found}; allowed: an NPY file of an array of f64 ('<f8') in C order, [N, 4]"
        ))
    })?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    PointFile::new(name.into_owned(), array).map_err(|e| refused(&e))
}

/// The rows of an array, or what the file holds instead.
fn array(bytes: &[u8]) -> Result<Vec<WindowPoint>, String> {
    let (header, start) = NpyHeader::read(bytes).ok_or("it is no NPY file")?;
    let is_plain = header.descr == "<f8" && !header.fortran_order;
    let (numbers, rest) = bytes.get(start..).unwrap_or_default().as_chunks();
    let numbers: Vec<f64> = numbers
        .iter()
        .map(|number| f64::from_le_bytes(*number))
        .collect();
    let (points, odd) = numbers.as_chunks();
    let is_whole = rest.is_empty() && odd.is_empty();
    let has_shape = header.shape == [points.len() as u64, 4];
    if is_whole && is_plain && has_shape {
        return Ok(points.to_vec());
    }
    let order = if header.fortran_order { "Fortran" } else { "C" };
    Err(format!(
        "it holds {} bytes of '{}' in {order} order, {:?}",
        bytes.len() - start,
        header.descr,
        header.shape
    ))
}
