//! Conversion of the parts of OBJ files to shapes.

use super::mtl::{self, MtlEntry, ObjSurface, left_out};
use crate::Color;
use crate::files::Files;
use crate::main_file::MainFile;
use crate::meshes::{MENDED, MeshParts, NO_AREA};
use crate::report::{Report, SourcePlace, quoted};
use etendue_meshfile::{DetailedMesh, ObjFile, ObjPart};
use etendue_world::{Geometry, Shape, World};
use glam::DAffine3;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Converts an OBJ file to a world.
pub(super) struct ObjReader<'a> {
    pub(super) files: &'a Files,
    pub(super) report: &'a Report,
    pub(super) color: Color,
    pub(super) world: World,
    place: SourcePlace,
    folder: PathBuf,
    entries: HashMap<String, MtlEntry>,
    /// Surfaces by material name; `None` if a cause of refusal was reported for the material.
    surfaces: HashMap<Option<String>, Option<ObjSurface>>,
}

impl<'a> ObjReader<'a> {
    pub(super) fn new(file: &'a MainFile<'_>) -> Self {
        Self {
            files: &file.files,
            report: &file.report,
            color: file.options.color,
            world: World::default(),
            place: file.place(),
            folder: file.folder(),
            entries: HashMap::new(),
            surfaces: HashMap::new(),
        }
    }

    pub(super) fn world(mut self, file: ObjFile) -> World {
        for (line, names) in &file.libraries {
            self.library(*line, names);
        }
        for (line, word, count) in &file.left_out {
            self.report.note(&self.at(*line), left_out(word, *count));
        }
        for part in joined(file.parts) {
            self.part(&file.mesh, &part);
        }
        self.world
    }

    fn at(&self, line: usize) -> SourcePlace {
        SourcePlace::at(&self.place.file, line, 1)
    }

    /// Reads a material library statement: one file with spaces in its name, or several files.
    fn library(&mut self, line: usize, names: &str) {
        let folders = [self.folder.clone()];
        if self.files.find(&folders, names).is_ok() {
            return self.read(line, names);
        }
        for name in names.split_whitespace() {
            self.read(line, name);
        }
    }

    fn read(&mut self, line: usize, name: &str) {
        let found = self.files.find(std::slice::from_ref(&self.folder), name);
        let read = found.and_then(|path| Ok((self.files.read(&path)?, path)));
        let read = read.map_err(|error| format!("file {} {error}", quoted(name)));
        if let Some((bytes, path)) = self.report.accept(&self.at(line), read) {
            let folder = path.parent().unwrap_or(&self.folder);
            let text = String::from_utf8_lossy(&bytes);
            mtl::read(&text, name, folder, self.report, &mut self.entries);
        }
    }

    fn part(&mut self, mesh: &DetailedMesh, part: &MaterialPart) {
        let Some(surface) = self.surface_of(&part.material, part.line) else {
            return;
        };
        let Some(mut parts) = self.parts(mesh, part) else {
            return;
        };
        parts.drop_empty();
        parts.face_normals();
        let place = self.at(part.line);
        if parts.mend_normals() {
            self.report.note(&place, MENDED);
        }
        if surface.has_picture && parts.uvs.is_none() {
            let message = "faces have no texture coordinates, but their material needs them";
            return self.report.cause(&place, message);
        }
        let Some(mesh) = parts.finish() else {
            return self
                .report
                .note(&place, format!("{NO_AREA} and is left out"));
        };
        let geometry = Geometry::Mesh(Arc::new(mesh));
        self.world.shapes.push(Shape {
            name: part.material.clone().unwrap_or_default(),
            emission: surface.emission,
            ..Shape::new(geometry, DAffine3::IDENTITY, surface.material)
        });
    }

    fn surface_of(&mut self, name: &Option<String>, line: usize) -> Option<ObjSurface> {
        if let Some(known) = self.surfaces.get(name) {
            return known.clone();
        }
        let made = match name {
            None => {
                let message =
                    "has faces without a material: a diffuse material of reflectance 0.5 is used";
                self.report.note(&self.place, message);
                Some(self.default_surface())
            }
            Some(known) => match self.entries.get(known).cloned() {
                Some(entry) => self.surface(&entry),
                None => {
                    let message = format!("material {} is in no mtllib", quoted(known));
                    self.report.refuse(&self.at(line), message)
                }
            },
        };
        self.surfaces.insert(name.clone(), made.clone());
        made
    }

    /// The triangles of a part with vertices that no other part uses, and with texture
    /// coordinates whose v points downwards.
    fn parts(&self, mesh: &DetailedMesh, part: &MaterialPart) -> Option<MeshParts> {
        let mut known: HashMap<u32, u32> = HashMap::new();
        let mut order: Vec<usize> = Vec::new();
        let mut corner = |i: u32| {
            let next = u32::try_from(order.len()).unwrap_or(u32::MAX);
            *known.entry(i).or_insert_with(|| {
                order.push(i as usize);
                next
            })
        };
        let corners = part
            .triangles
            .iter()
            .map(|i| mesh.triangles[*i].map(&mut corner))
            .collect();
        let parts = MeshParts {
            vertices: order.iter().map(|i| mesh.vertices[*i]).collect(),
            corners,
            normals: some(&mesh.normals, &order),
            uvs: some(&mesh.uvs, &order).map(|mut uvs| {
                uvs.iter_mut().for_each(|uv| uv.y = 1.0 - uv.y);
                uvs
            }),
        };
        let spent = self.files.spend(parts.bytes());
        self.report.accept(&self.place, spent)?;
        Some(parts)
    }
}

/// An attribute of the vertices, or `None` if the attribute is missing or zero at every
/// vertex.
fn some<T: Copy + Default + PartialEq>(all: &Option<Vec<T>>, order: &[usize]) -> Option<Vec<T>> {
    let found: Vec<T> = order
        .iter()
        .map(|i| all.as_ref().map(|all| all[*i]))
        .collect::<Option<_>>()?;
    found.iter().any(|v| *v != T::default()).then_some(found)
}

/// The part of a mesh with one material.
struct MaterialPart {
    material: Option<String>,
    line: usize,
    triangles: Vec<usize>,
}

/// Joins parts of the same material, in order of first use.
fn joined(parts: Vec<ObjPart>) -> Vec<MaterialPart> {
    let mut joined: Vec<MaterialPart> = Vec::new();
    let mut known: HashMap<Option<String>, usize> = HashMap::new();
    for part in parts {
        let at = *known.entry(part.material.clone()).or_insert(joined.len());
        if at == joined.len() {
            joined.push(MaterialPart {
                material: part.material,
                line: part.line,
                triangles: Vec::new(),
            });
        }
        joined[at].triangles.extend(part.triangles);
    }
    joined
}
