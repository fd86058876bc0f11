//! Mitsuba's own mesh files, versions 3 and 4: several meshes, each compressed with zlib.

use crate::files::Files;
use crate::meshes::MeshParts;
use crate::range::MAX_NUMBER;
use flate2::read::ZlibDecoder;
use glam::{DVec2, DVec3};
use std::io::Read;

const MAGIC: u16 = 0x041c;
const HAS_NORMALS: u32 = 0x1;
const HAS_UVS: u32 = 0x2;
const HAS_COLORS: u32 = 0x8;
const IS_DOUBLE: u32 = 0x2000;
/// Maximum length, in bytes, of a mesh's name, which the reader skips.
const LONGEST_NAME: u64 = 1 << 16;
/// Maximum ratio of unpacked to packed bytes: zlib reaches 1032 for zeros, and less than 20 for
/// meshes.
const MAX_PER_BYTE: u64 = 64;

/// Reads the mesh with the given index, counted from 0.
pub(super) fn read(bytes: &[u8], number: u32, files: &Files) -> Result<MeshParts, String> {
    let (version, start) = find(bytes, number)?;
    let packed = bytes
        .get(start..)
        .ok_or("has a mesh that starts after the end of the file")?;
    let most = files.left().min(packed.len() as u64 * MAX_PER_BYTE);
    let mut stream = UnpackedStream {
        inner: ZlibDecoder::new(packed).take(most),
        most,
    };
    let mesh = stream.mesh(version);
    let parts = mesh.map_err(|error| match stream.inner.limit() {
        0 => format!(
            "unpacks to more than {most} bytes; allowed: {MAX_PER_BYTE} times the size of the file"
        ),
        _ => error,
    })?;
    files.spend(most - stream.inner.limit())?;
    Ok(parts)
}

/// The version of the file, and the offset of the packed mesh.
fn find(bytes: &[u8], number: u32) -> Result<(u16, usize), String> {
    let version = head(bytes, 0)?;
    if number == 0 {
        return Ok((version, 4));
    }
    let (table, count) = bytes
        .split_last_chunk::<4>()
        .map(|(table, count)| (table, u32::from_le_bytes(*count)))
        .ok_or("ends before its table of meshes")?;
    if number >= count {
        return Err(format!("has {count} meshes, but shape_index is {number}"));
    }
    let size = if version >= 4 { 8 } else { 4 };
    let back = (count - number) as usize;
    let at = back
        .checked_mul(size)
        .and_then(|back| table.len().checked_sub(back))
        .ok_or("ends before its table of meshes")?;
    let mut offset = [0; 8];
    offset[..size].copy_from_slice(&table[at..at + size]);
    let offset = usize::try_from(u64::from_le_bytes(offset)).unwrap_or(usize::MAX);
    head(bytes, offset)?;
    Ok((version, offset.saturating_add(4)))
}

/// The version that is stored at the start of a mesh.
fn head(bytes: &[u8], at: usize) -> Result<u16, String> {
    let Some([a, b, c, d]) = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>()) else {
        return Err("ends before a mesh".to_owned());
    };
    match (u16::from_le_bytes([*a, *b]), u16::from_le_bytes([*c, *d])) {
        (MAGIC, version @ 3..=4) => Ok(version),
        (MAGIC, version) => Err(format!("is of version {version}; allowed: 3, 4")),
        _ => Err("is not a file of serialized meshes".to_owned()),
    }
}

/// A reader of the unpacked data of a mesh.
struct UnpackedStream<R> {
    inner: std::io::Take<R>,
    most: u64,
}

impl<R: Read> UnpackedStream<R> {
    fn mesh(&mut self, version: u16) -> Result<MeshParts, String> {
        let flags = u32::from_le_bytes(self.some()?);
        if version >= 4 {
            self.name()?;
        }
        let vertices = self.count()?;
        let triangles = self.count()?;
        let is_double = flags & IS_DOUBLE != 0;
        let vertex = self.rows::<DVec3, 3>(vertices, is_double)?;
        let normals = (flags & HAS_NORMALS != 0)
            .then(|| self.rows::<DVec3, 3>(vertices, is_double))
            .transpose()?;
        let uvs = (flags & HAS_UVS != 0)
            .then(|| self.rows::<DVec2, 2>(vertices, is_double))
            .transpose()?;
        if flags & HAS_COLORS != 0 {
            self.rows::<DVec3, 3>(vertices, is_double)?;
        }
        Ok(MeshParts {
            vertices: vertex,
            corners: self.corners(triangles, vertices)?,
            normals,
            uvs,
        })
    }

    fn some<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let mut bytes = [0; N];
        let read = self.inner.read_exact(&mut bytes);
        read.map_err(|error| format!("is damaged or truncated ({error})"))?;
        Ok(bytes)
    }

    fn name(&mut self) -> Result<(), String> {
        for _ in 0..LONGEST_NAME {
            if self.some()? == [0] {
                return Ok(());
            }
        }
        Err(format!("has a name of more than {LONGEST_NAME} bytes"))
    }

    /// Reads the number of vertices or triangles, and checks that the file is long enough. Each
    /// vertex or triangle takes more than a byte.
    fn count(&mut self) -> Result<u64, String> {
        let count = u64::from_le_bytes(self.some()?);
        if count <= self.most && u32::try_from(count).is_ok() {
            Ok(count)
        } else {
            Err(format!(
                "states {count} vertices or triangles, more than it can hold"
            ))
        }
    }

    /// Reads rows of numbers from the unpacked data. Memory is allocated only as rows are read,
    /// because the number of rows that the file states may be wrong.
    fn rows<T: From<[f64; N]>, const N: usize>(
        &mut self,
        count: u64,
        is_double: bool,
    ) -> Result<Vec<T>, String> {
        let mut rows = Vec::new();
        for i in 0..count {
            let mut row = [0.0; N];
            for value in &mut row {
                *value = match is_double {
                    true => f64::from_le_bytes(self.some()?),
                    false => f32::from_le_bytes(self.some()?).into(),
                };
                if value.is_nan() || value.abs() > MAX_NUMBER {
                    return Err(format!(
                        "has {value} at vertex {i}; allowed: up to {MAX_NUMBER}"
                    ));
                }
            }
            rows.push(row.into());
        }
        Ok(rows)
    }

    fn corners(&mut self, count: u64, vertices: u64) -> Result<Vec<[u32; 3]>, String> {
        let mut corners = Vec::new();
        for i in 0..count {
            let mut triangle = [0; 3];
            for corner in &mut triangle {
                *corner = u32::from_le_bytes(self.some()?);
                if u64::from(*corner) >= vertices {
                    return Err(format!(
                        "refers to vertex {corner} in triangle {i}; allowed: numbers below {vertices}"
                    ));
                }
            }
            corners.push(triangle);
        }
        Ok(corners)
    }
}
