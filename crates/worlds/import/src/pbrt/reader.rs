//! Reads a pbrt scene into a world.

use super::entity::{CauseGiven, Entity, Read};
use super::scene::PbrtScene;
use crate::Color;
use crate::files::Files;
use crate::main_file::MainFile;
use crate::pictures::Pictures;
use crate::report::{Report, SourcePlace, quoted};
use crate::spectrum::Role;
use etendue_world::{Texture, Triangles, World};
use glam::{DAffine2, DMat2, DVec2};
use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;
use std::sync::Arc;

/// The key of a mesh: the file of the mesh, and whether the mesh needs texture coordinates.
type PbrtMeshKey = (PathBuf, bool);

/// The key of a texture. It consists of the texture's name, the type of its values, and the
/// coordinates of its surface.
type TextureKey = (String, Ask, Uv);

/// Converts a scene to a world.
pub(super) struct PbrtReader<'a> {
    pub(super) scene: &'a PbrtScene<'a>,
    pub(super) files: &'a Files,
    pub(super) report: &'a Report,
    pub(super) color: Color,
    pub(super) folder: PathBuf,
    pub(super) world: World,
    pub(super) pictures: Pictures,
    pub(super) meshes: HashMap<PbrtMeshKey, Result<Arc<Triangles>, String>>,
    pub(super) textures: BTreeMap<TextureKey, Read<Texture>>,
    /// The materials made so far, by index in the scene and kind of texture coordinates; `None`
    /// stands for no surface at all.
    pub(super) materials: BTreeMap<(usize, Uv), Read<Option<usize>>>,
    /// Number of materials made so far, including nested ones.
    pub(super) made_materials: usize,
    /// The current nesting depth of textures or materials.
    pub(super) depth: usize,
}

impl Uv {
    pub(super) fn to_pbrt(self) -> DAffine2 {
        let [x, y, start] = match self {
            Self::Own => [DVec2::X, DVec2::Y, DVec2::ZERO],
            Self::Ball => [DVec2::X, DVec2::NEG_Y, DVec2::Y],
            Self::Disc => [DVec2::NEG_Y, DVec2::X, DVec2::Y],
        };
        DAffine2::from_mat2_translation(DMat2::from_cols(x, y), start)
    }
}

/// The type of a texture. Float textures and spectrum textures have separate names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Ask {
    Float,
    Spectrum(Role),
}

/// The relation between the (u, v) of a surface in pbrt and its (u, v) in a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Uv {
    /// Both are equal.
    Own,
    /// On spheres pbrt's v increases from the lower pole upwards.
    Ball,
    /// On discs pbrt's u is the azimuth, and v increases from the edge inwards.
    Disc,
}

impl<'a> PbrtReader<'a> {
    pub(super) fn new(scene: &'a PbrtScene<'a>, file: &'a MainFile<'_>) -> Self {
        Self {
            scene,
            files: &file.files,
            report: &file.report,
            color: file.options.color,
            folder: file.folder(),
            world: World::default(),
            pictures: Pictures::default(),
            meshes: HashMap::new(),
            textures: BTreeMap::new(),
            materials: BTreeMap::new(),
            made_materials: 0,
            depth: 0,
        }
    }

    /// The world of the scene.
    pub(super) fn world(mut self, whole: &SourcePlace) -> World {
        self.integrator();
        self.settings();
        self.camera(whole);
        for (entity, to_world) in &self.scene.lights {
            self.light(entity, *to_world);
        }
        self.shapes();
        self.instances();
        self.world
    }

    /// The path of a file; names are relative to the folder of the scene.
    pub(super) fn find(&self, name: &str) -> Result<PathBuf, String> {
        self.files.find(std::slice::from_ref(&self.folder), name)
    }

    /// The file name parameter of an entity.
    pub(super) fn file_name<'b>(&self, entity: &'b Entity<'_>) -> Read<&'b str> {
        let name = entity.text("filename")?;
        name.ok_or_else(|| {
            let (kind, plugin) = (entity.kind, quoted(&entity.plugin));
            entity.fault("filename", format!("{kind} {plugin} without filename"))
        })
    }

    /// Adds a cause for a file that cannot be used.
    pub(super) fn unread(&self, entity: &Entity<'_>, name: &str, error: &str) -> CauseGiven {
        entity.fault("filename", format!("file {} {error}", quoted(name)))
    }
}
