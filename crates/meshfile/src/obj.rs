//! OBJ files (Wavefront, Advanced Visualizer manual, appendix B1): vertices and faces, with normals and
//! texture coordinates.

pub(crate) mod parts;

use crate::detailed::DetailedMesh;
use crate::fault::{Fault, fault};
use crate::mesh::{AXES, Mesh, check_coordinate, check_coordinates, check_corners, fan};
use crate::text::{LineWords, Lines, number, quoted};
use glam::{DVec2, DVec3};
use std::borrow::Cow;
use std::collections::HashMap;

/// Statements of OBJ files that do not affect the triangles.
const PASSED_OVER: [&[u8]; 19] = [
    b"vt",
    b"vn",
    b"vp",
    b"o",
    b"g",
    b"s",
    b"mg",
    b"p",
    b"l",
    b"usemtl",
    b"mtllib",
    b"usemap",
    b"maplib",
    b"lod",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"shadow_obj",
    b"trace_obj",
];

pub(crate) fn read(bytes: &[u8]) -> Result<Mesh, Fault> {
    let bytes = without_mark(bytes);
    let vertices = vertices(bytes)?;
    // Faces may refer to vertices that follow them in the file, so faces are read after all
    // vertices.
    let triangles = triangles(bytes, |word, [before, ..]| {
        corner(word, before, vertices.len())
    })?;
    Mesh::new(vertices, triangles)
}

/// Reads a mesh with its normals and texture coordinates.
pub(crate) fn read_detailed(bytes: &[u8]) -> Result<DetailedMesh, Fault> {
    let bytes = without_mark(bytes);
    let places = vertices(bytes)?;
    let uvs: Vec<[f64; 2]> = rows(bytes, b"vt")?;
    let normals: Vec<[f64; 3]> = rows(bytes, b"vn")?;
    let counts = [places.len(), uvs.len(), normals.len()];
    let mut known: HashMap<CornerKey, u32> = HashMap::new();
    let mut keys = Vec::new();
    // Each distinct corner becomes a vertex.
    let triangles = triangles(bytes, |word, before| {
        let key = key(word, before, counts)?;
        // A file that fits into memory has fewer distinct corners than the largest u32.
        let next = u32::try_from(keys.len()).unwrap_or(u32::MAX);
        let index = *known.entry(key).or_insert(next);
        if index == next {
            keys.push(key);
        }
        Ok(index)
    })?;
    let uv = |i: Option<u32>| i.map_or(DVec2::ZERO, |i| uvs[i as usize].into());
    let normal = |i: Option<u32>| i.map_or(DVec3::ZERO, |i| normals[i as usize].into());
    Ok(DetailedMesh {
        vertices: keys.iter().map(|key| places[key.0 as usize]).collect(),
        triangles,
        normals: (keys.iter().any(|key| key.2.is_some()))
            .then(|| keys.iter().map(|key| normal(key.2)).collect()),
        uvs: (keys.iter().any(|key| key.1.is_some()))
            .then(|| keys.iter().map(|key| uv(key.1)).collect()),
        ..DetailedMesh::default()
    })
}

/// Removes the byte order mark with which Windows editors begin UTF-8 files.
fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// The statements of an OBJ file, each with the number of its first line. Comments are
/// removed, and continued lines are joined.
fn statements(bytes: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, [u8]>)> {
    let mut lines = Lines::new(bytes).map(|(number, line)| {
        let end = line.iter().position(|b| *b == b'#');
        (number, &line[..end.unwrap_or(line.len())])
    });
    std::iter::from_fn(move || {
        let (number, first) = lines.next()?;
        let Some(start) = first.strip_suffix(b"\\") else {
            return Some((number, first.into()));
        };
        let mut joined = start.to_vec();
        for (_, line) in lines.by_ref() {
            joined.push(b' ');
            joined.extend(line.strip_suffix(b"\\").unwrap_or(line));
            if !line.ends_with(b"\\") {
                break;
            }
        }
        Some((number, joined.into()))
    })
}

/// The points of the `v` lines. At least one point is required, and values after the three
/// coordinates (weight, color) are ignored.
fn vertices(bytes: &[u8]) -> Result<Vec<DVec3>, Fault> {
    let mut vertices = Vec::new();
    for (line, statement) in statements(bytes) {
        let mut words = LineWords(&statement);
        match words.next() {
            Some(b"v") => vertices.push(vertex(line, vertices.len() + 1, words)?),
            None | Some(b"f") => {}
            Some(word) if PASSED_OVER.contains(&word) => {}
            Some(word) => {
                let allowed = "v, f and the other keywords of polygonal OBJ files";
                return Err(fault(place(line, "the word"), quoted(word), allowed));
            }
        }
    }
    match vertices.is_empty() {
        true => Err(fault("vertices (`v` lines)", 0, "at least 3")),
        false => Ok(vertices),
    }
}

fn vertex(line: usize, index: usize, mut words: LineWords<'_>) -> Result<DVec3, Fault> {
    let mut point = DVec3::ZERO;
    for axis in 0..3 {
        let place = || place(line, &format!("vertex {index}, {}", AXES[axis]));
        let Some(word) = words.next() else {
            return Err(fault(place(), "missing", "a number"));
        };
        let value = number(word).ok_or_else(|| fault(place(), quoted(word), "a number"))?;
        point[axis] = check_coordinate(value, place)?;
    }
    Ok(point)
}

/// The triangles of the `f` lines; at least one is required. `index` returns the vertex of
/// a corner. Its arguments are the corner's word and the numbers of `v`, `vt` and `vn` lines above
/// the corner's line.
fn triangles(
    bytes: &[u8],
    mut index: impl FnMut(&[u8], [usize; 3]) -> Result<u32, CornerFault>,
) -> Result<Vec<[u32; 3]>, Fault> {
    let (mut triangles, mut corners) = (Vec::new(), Vec::new());
    let (mut before, mut face) = ([0; 3], 0);
    for (line, statement) in statements(bytes) {
        let mut words = LineWords(&statement);
        match words.next() {
            Some(b"v") => before[0] += 1,
            Some(b"vt") => before[1] += 1,
            Some(b"vn") => before[2] += 1,
            Some(b"f") => {
                face += 1;
                corners.clear();
                for word in words {
                    let found = index(word, before).map_err(|(value, allowed)| {
                        let what = format!("face {face}, corner {}", corners.len() + 1);
                        fault(place(line, &what), value, allowed)
                    })?;
                    corners.push(found);
                }
                check_corners(corners.len(), || {
                    place(line, &format!("face {face}, number of corners"))
                })?;
                triangles.extend(fan(&corners));
            }
            _ => {}
        }
    }
    match triangles.is_empty() {
        true => Err(fault("faces (`f` lines)", 0, "at least 1")),
        false => Ok(triangles),
    }
}

/// The numbers on each line whose first word is `word`. A `vt` line may omit its second
/// number.
fn rows<const N: usize>(bytes: &[u8], word: &[u8]) -> Result<Vec<[f64; N]>, Fault> {
    let mut rows = Vec::new();
    for (line, statement) in statements(bytes) {
        let mut words = LineWords(&statement);
        if words.next() != Some(word) {
            continue;
        }
        let name = String::from_utf8_lossy(word);
        let what = |i: usize| place(line, &format!("number {} of {name}", i + 1));
        let mut values = [0.0; N];
        for (i, value) in values.iter_mut().enumerate() {
            *value = match words.next() {
                Some(word) => {
                    number(word).ok_or_else(|| fault(what(i), quoted(word), "a number"))?
                }
                None if N == 2 && i == 1 => 0.0,
                None => return Err(fault(what(i), "missing", "a number")),
            };
        }
        rows.push(check_coordinates(values, what)?);
    }
    Ok(rows)
}

/// The indices of a corner such as `7`, `7/3`, `7//5` or `-1/-1/-1`.
fn key(word: &[u8], before: [usize; 3], counts: [usize; 3]) -> Result<CornerKey, CornerFault> {
    let first = corner(word, before[0], counts[0])?;
    let mut others = word.split(|b| *b == b'/').skip(1);
    let mut other = |i: usize| match others.next() {
        None | Some(b"") => Ok(None),
        Some(part) => corner(part, before[i], counts[i]).map(Some),
    };
    Ok((first, other(1)?, other(2)?))
}

/// The indices of the position, the texture coordinates and the normal of a corner, as in the
/// file.
type CornerKey = (u32, Option<u32>, Option<u32>);

/// The text of a faulty corner, and a description of the values that are allowed.
type CornerFault = (String, String);

/// The vertex index of a corner such as `7`, `7/3`, `7//5` or `-1/-1/-1`. Indices count
/// from 1, and negative indices count backwards from the last of the `before` vertices above the
/// line.
fn corner(word: &[u8], before: usize, count: usize) -> Result<u32, CornerFault> {
    let mut parts = word.split(|b| *b == b'/');
    let vertex: Option<i64> = parts.next().and_then(number);
    let others_sound = parts.clone().count() <= 2
        && parts.all(|part| part.is_empty() || number::<i64>(part).is_some());
    let Some(vertex) = vertex.filter(|_| others_sound) else {
        let allowed = "an index of a vertex, optionally with indices of texture and normal: 7, 7/3, 7//5, 7/3/5";
        return Err((quoted(word), allowed.into()));
    };
    let named = usize::try_from(vertex.unsigned_abs()).unwrap_or(usize::MAX);
    let index = if vertex < 0 {
        before.checked_sub(named)
    } else {
        named.checked_sub(1).filter(|index| *index < count)
    };
    index
        .and_then(|index| u32::try_from(index).ok())
        .ok_or_else(|| {
            let back = match before {
                0 => String::new(),
                _ => format!(", or -{before} to -1"),
            };
            (vertex.to_string(), format!("1 to {count}{back}"))
        })
}

fn place(line: usize, what: &str) -> String {
    format!("line {line}, {what}")
}
