//! Reads a glTF file into a world.

use super::container::Document;
use crate::Color;
use crate::files::Files;
use crate::main_file::MainFile;
use crate::report::{Report, SourcePlace, quoted};
use ::gltf::json::{Material as GltfMaterial, Root};
use etendue_field::Raster;
use etendue_world::{EmittedRadiance, Triangles, World};
use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;
use std::sync::Arc;

/// Converts a glTF file to a world.
pub(super) struct GltfReader<'a> {
    pub(super) root: &'a Root,
    pub(super) chunk: Option<&'a [u8]>,
    pub(super) files: &'a Files,
    pub(super) report: &'a Report,
    pub(super) place: SourcePlace,
    pub(super) folder: PathBuf,
    pub(super) color: Color,
    pub(super) world: World,
    /// Bytes of each buffer that was read so far; `None` if a cause of refusal was reported for
    /// the buffer.
    pub(super) buffers: HashMap<usize, Option<Arc<[u8]>>>,
    /// Meshes by mesh and primitive number; `None` if a primitive has no triangles, or if a cause
    /// of refusal was reported for the primitive.
    pub(super) meshes: HashMap<(usize, usize), Option<Arc<Triangles>>>,
    /// Materials by number in the file; `None` if a cause of refusal was reported for the
    /// material. The default material has no number in the file.
    pub(super) materials: HashMap<Option<usize>, Option<GltfSurface>>,
    /// Pictures by image number and by the channel that is read, in words.
    pub(super) rasters: HashMap<(usize, String), Option<Arc<Raster>>>,
}

/// The material of a surface.
#[derive(Clone, Debug)]
pub(super) struct GltfSurface {
    /// The index of the material in the world.
    pub(super) material: usize,
    pub(super) emission: Option<EmittedRadiance>,
    pub(super) is_double_sided: bool,
    /// The number of the set of texture coordinates that the pictures use.
    pub(super) set: Option<u32>,
}

/// A material that is being converted.
pub(super) struct Draft<'a> {
    pub(super) source: &'a GltfMaterial,
    pub(super) path: String,
    /// The sets of texture coordinates that the pictures converted so far use.
    pub(super) sets: BTreeSet<u32>,
}

impl<'a> GltfReader<'a> {
    pub(super) fn new(document: &'a Document, file: &'a MainFile<'_>) -> Self {
        Self {
            root: &document.root,
            chunk: document.chunk.as_deref(),
            files: &file.files,
            report: &file.report,
            place: file.place(),
            folder: file.folder(),
            color: file.options.color,
            world: World::default(),
            buffers: HashMap::new(),
            meshes: HashMap::new(),
            materials: HashMap::new(),
            rasters: HashMap::new(),
        }
    }

    /// The world that the file describes.
    pub(super) fn world(mut self) -> World {
        self.tell_leftovers();
        self.nodes();
        self.world
    }

    /// Adds a cause for the element at a JSON path.
    pub(super) fn cause(&self, path: &str, message: impl AsRef<str>) {
        self.report
            .cause(&self.place, format!("{path}: {}", message.as_ref()));
    }

    /// Adds a cause for the element at a JSON path, and returns `None` in place of its value.
    pub(super) fn refuse<T>(&self, path: &str, message: impl AsRef<str>) -> Option<T> {
        self.cause(path, message);
        None
    }

    /// Returns a value, or adds a cause at a JSON path that states its error.
    pub(super) fn accept<T>(&self, path: &str, value: Result<T, String>) -> Option<T> {
        value.map_err(|error| self.cause(path, error)).ok()
    }

    /// Adds a note that the element at a JSON path is dropped or approximated.
    pub(super) fn note(&self, path: &str, message: impl AsRef<str>) {
        self.report
            .note(&self.place, format!("{path}: {}", message.as_ref()));
    }

    /// Adds a note for each unknown extension of the element at a JSON path.
    pub(super) fn tell_others<'n>(&self, path: &str, names: impl Iterator<Item = &'n String>) {
        for name in names {
            let message = format!("{} is left out", quoted(name));
            self.note(&format!("{path}.extensions"), message);
        }
    }

    /// Adds a note on the file as a whole, unless the same note was already given.
    pub(super) fn note_once(&self, message: &str) {
        self.report.note_once(&self.place, message);
    }

    /// Adds the note on the units of all lights.
    pub(super) fn note_units(&self) {
        self.note_once("strengths of lights are taken as radiometric: 1 cd as 1 W/sr, 1 lx as 1 W/m², 1 nit of emission as 1 W m⁻² sr⁻¹");
    }

    /// Checks that a number is within range; `None` if a cause of refusal was reported.
    pub(super) fn within(&self, path: &str, value: f32, [low, high]: [f64; 2]) -> Option<f64> {
        let value = f64::from(value);
        if (low..=high).contains(&value) && value.is_finite() {
            return Some(value);
        }
        self.refuse(path, format!("is {value}; allowed: {low} to {high}"))
    }

    /// Checks that numbers are from 0 to 1; `None` if a cause of refusal was reported.
    pub(super) fn shares<const N: usize>(&self, path: &str, values: [f32; N]) -> Option<[f64; N]> {
        for value in values {
            self.within(path, value, [0.0, 1.0])?;
        }
        Some(values.map(f64::from))
    }

    /// Adds notes on ignored content that concerns the whole file.
    fn tell_leftovers(&self) {
        let root = self.root;
        for (i, animation) in root.animations.iter().enumerate() {
            let name = animation.name.as_deref().unwrap_or_default();
            let message = format!(
                "animation {} is left out: nodes keep the transforms that they have without it",
                quoted(name)
            );
            self.note(&format!("animations[{i}]"), message);
        }
        for name in root.extensions.iter().flat_map(|of| of.others.keys()) {
            self.note("extensions", format!("{} left out", quoted(name)));
        }
    }
}
