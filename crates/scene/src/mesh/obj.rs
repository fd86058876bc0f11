//! OBJ files (Wavefront, Advanced Visualizer manual, appendix B1): vertices and faces.

pub(super) mod detailed;
pub(super) mod parts;

use super::shared::{Mesh, check_coordinate, check_corners, fan};
use super::text::{LineWords, Lines, number, quoted};
use etendue_scenefile::{Fault, fault};
use glam::DVec3;
use std::borrow::Cow;

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

pub(super) fn read(bytes: &[u8]) -> Result<Mesh, Fault> {
    let bytes = without_mark(bytes);
    let vertices = vertices(bytes)?;
    // Faces may refer to vertices that follow them in the file, so faces are read after all
    // vertices.
    let triangles = triangles(bytes, |word, [before, ..]| {
        corner(word, before, vertices.len())
    })?;
    Mesh::new(vertices, triangles)
}

/// Removes the byte order mark with which Windows editors begin UTF-8 files.
fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// Returns the statements of an OBJ file, each with the number of its first line. Comments are
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

/// Returns the points of the `v` lines. At least one point is required, and values after the three
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
        let place = || place(line, &format!("vertex {index}, {}", ["x", "y", "z"][axis]));
        let Some(word) = words.next() else {
            return Err(fault(place(), "missing", "a number"));
        };
        let value = number(word).ok_or_else(|| fault(place(), quoted(word), "a number"))?;
        point[axis] = check_coordinate(value, place)?;
    }
    Ok(point)
}

/// Returns the triangles of the `f` lines; at least one is required. `index` returns the vertex of
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

/// The text of a faulty corner, and a description of the values that are allowed.
type CornerFault = (String, String);

/// Returns the vertex index of a corner such as `7`, `7/3`, `7//5` or `-1/-1/-1`. Indices count
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
