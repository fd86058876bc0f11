//! Reads OBJ files with their normals and texture coordinates.

use super::super::detailed::DetailedMesh;
use super::super::shared::check_coordinates;
use super::super::text::{LineWords, number, quoted};
use super::{CornerFault, corner, place, statements, triangles, vertices, without_mark};
use etendue_scenefile::{Fault, fault};
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// The indices of the position, the texture coordinates and the normal of a corner, as in the
/// file.
type CornerKey = (u32, Option<u32>, Option<u32>);

pub(in super::super) fn read(bytes: &[u8]) -> Result<DetailedMesh, Fault> {
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
    let has = |any: bool| any.then_some(());
    Ok(DetailedMesh {
        vertices: keys.iter().map(|key| places[key.0 as usize]).collect(),
        triangles,
        normals: has(keys.iter().any(|key| key.2.is_some()))
            .map(|()| keys.iter().map(|key| normal(key.2)).collect()),
        uvs: has(keys.iter().any(|key| key.1.is_some()))
            .map(|()| keys.iter().map(|key| uv(key.1)).collect()),
        attributes: Vec::new(),
        attribute_names: Vec::new(),
    })
}

/// Returns the numbers on each line whose first word is `word`. A `vt` line may omit its second
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

/// Returns a corner such as `7`, `7/3`, `7//5` or `-1/-1/-1`.
fn key(word: &[u8], before: [usize; 3], counts: [usize; 3]) -> Result<CornerKey, CornerFault> {
    let first = corner(word, before[0], counts[0])?;
    let mut others = word.split(|b| *b == b'/').skip(1);
    let mut other = |i: usize| match others.next() {
        None | Some(b"") => Ok(None),
        Some(part) => corner(part, before[i], counts[i]).map(Some),
    };
    Ok((first, other(1)?, other(2)?))
}
