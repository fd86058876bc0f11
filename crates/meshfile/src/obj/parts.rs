//! Reads OBJ files as scenes: triangles with their materials.

use super::{read_detailed, statements, without_mark};
use crate::detailed::DetailedMesh;
use crate::fault::Fault;
use crate::text::LineWords;
use std::ops::Range;

/// Statements of OBJ files that affect the appearance but are ignored.
const LEFT_OUT: [&str; 10] = [
    "p",
    "l",
    "lod",
    "usemap",
    "maplib",
    "bevel",
    "c_interp",
    "d_interp",
    "shadow_obj",
    "trace_obj",
];

/// An OBJ file with the materials of its faces.
#[derive(Clone, Debug)]
pub struct ObjFile {
    /// All triangles of the file.
    pub mesh: DetailedMesh,
    /// The parts of the file: all triangles in order, divided at each `usemtl`.
    pub parts: Vec<ObjPart>,
    /// The line number of each `mtllib` statement, with the file that it names.
    pub libraries: Vec<(usize, String)>,
    /// The kinds of statements that are ignored. Each entry holds the line of the first occurrence,
    /// the first word, and the number of occurrences. The statement `s` is counted as ignored in
    /// files without normals.
    pub left_out: Vec<(usize, String, usize)>,
}

/// Consecutive triangles of an OBJ file with one material.
#[derive(Clone, Debug)]
pub struct ObjPart {
    /// The material that `usemtl` names; `None` for triangles before the first `usemtl`.
    pub material: Option<String>,
    /// The line number of the `usemtl` statement.
    pub line: usize,
    /// The range of indices of the part's triangles.
    pub triangles: Range<usize>,
}

impl ObjFile {
    /// Reads the bytes of an OBJ file, as [`DetailedMesh::parse`] does.
    ///
    /// # Errors
    /// The first fault found.
    pub fn parse(bytes: &[u8]) -> Result<Self, Fault> {
        let mesh = read_detailed(bytes)?;
        let has_normals = mesh.normals.is_some();
        let mut file = Self {
            mesh,
            parts: vec![ObjPart {
                material: None,
                line: 0,
                triangles: 0..0,
            }],
            libraries: Vec::new(),
            left_out: Vec::new(),
        };
        for (line, statement) in statements(without_mark(bytes)) {
            let mut words = LineWords(&statement);
            let Some(word) = words.next() else {
                continue;
            };
            let rest = String::from_utf8_lossy(words.0.trim_ascii()).into_owned();
            match word {
                b"f" => file.add(words.count().saturating_sub(2)),
                b"usemtl" => file.begin(line, rest),
                b"mtllib" => file.libraries.push((line, rest)),
                b"v" if words.count() > 4 => file.leave_out(line, "colours of v"),
                b"s" if !has_normals && rest != "off" && rest != "0" => file.leave_out(line, "s"),
                _ => {
                    let known = LEFT_OUT.iter().find(|known| known.as_bytes() == word);
                    known
                        .into_iter()
                        .for_each(|word| file.leave_out(line, word));
                }
            }
        }
        file.parts.retain(|part| !part.triangles.is_empty());
        Ok(file)
    }

    fn add(&mut self, triangles: usize) {
        if let Some(last) = self.parts.last_mut() {
            last.triangles.end += triangles;
        }
    }

    fn begin(&mut self, line: usize, material: String) {
        let at = self.parts.last().map_or(0, |last| last.triangles.end);
        self.parts.push(ObjPart {
            material: Some(material),
            line,
            triangles: at..at,
        });
    }

    fn leave_out(&mut self, line: usize, word: &str) {
        match self.left_out.iter_mut().find(|(_, known, _)| known == word) {
            Some((_, _, count)) => *count += 1,
            None => self.left_out.push((line, word.to_owned(), 1)),
        }
    }
}
