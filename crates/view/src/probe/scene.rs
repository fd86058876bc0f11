//! A scene that is probed, and what is asked of it.

use crate::world_source::{self, CameraChoice, WorldSource};
use etendue_import::Imported;
use etendue_paths::{Paths, Question};
use etendue_store::stored::VERSION;
use etendue_store::{Failure, PROBE, Plan, Results};
use etendue_world::Camera;
use serde_json::{Value, json as tree_of};
use std::path::{Path, PathBuf};

/// Batches of rays and of photons, from whose differences errors and p are found.
pub(super) const BATCHES: u32 = 64;
/// Of all planes together.
pub(super) const ALPHA: f64 = 0.01;
/// A plane passes when its noise is not above this share of its spectrum.
pub(super) const RESOLUTION: f64 = 0.1;

/// Frequencies on either side of zero, half a cycle a window apart.
pub(super) const FREQUENCIES: usize = 12;

/// What is asked of which scene.
#[derive(Clone, Debug)]
pub struct ProbeRequest {
    /// The scene.
    pub source: WorldSource,
    /// The camera.
    pub camera: CameraChoice,
    /// Most surfaces along the ray.
    pub surfaces: u16,
    /// Pixels across the window.
    pub window: f64,
    /// Rays traced back for each plane.
    pub rays: u64,
    /// Photons that check them.
    pub photons: u64,
    /// Seed of both.
    pub seed: u64,
    /// Whether the covariance of each plane's spectrum is measured too.
    pub covariance: bool,
    /// Folder for the results; otherwise one below `out`.
    pub out: Option<PathBuf>,
    /// Whether files that Étendue did not write are replaced.
    pub force: bool,
}

impl ProbeRequest {
    /// Most surfaces along the ray, unless said.
    pub const SURFACES: u16 = 1;
    /// Pixels across the window, unless said.
    pub const WINDOW: f64 = 16.0;
    /// Rays traced back for each plane, unless said.
    pub const RAYS: u64 = 1 << 20;
    /// Rays traced back for each pixel of a map, unless said.
    pub const RAYS_OF_MAP: u64 = 1 << 15;
    /// Photons that check them, unless said.
    pub const PHOTONS: u64 = 1 << 25;
    /// The seed, unless said.
    pub const SEED: u64 = 1;

    /// A probe of the light that the first camera of a scene sees.
    #[must_use]
    pub fn new(source: WorldSource) -> Self {
        Self {
            source,
            camera: CameraChoice::default(),
            surfaces: Self::SURFACES,
            window: Self::WINDOW,
            rays: Self::RAYS,
            photons: Self::PHOTONS,
            seed: Self::SEED,
            covariance: false,
            out: None,
            force: false,
        }
    }
}

/// A scene that is read.
#[derive(Debug)]
pub(super) struct ProbedScene<'a> {
    pub(super) request: &'a ProbeRequest,
    pub(super) imported: Imported,
    pub(super) camera: Camera,
    pub(super) paths: Paths,
}

impl<'a> ProbedScene<'a> {
    pub(super) fn read(request: &'a ProbeRequest) -> Result<Self, Failure> {
        let imported = world_source::load(&request.source)?;
        let arguments = request.source.arguments;
        world_source::require_light(&imported.world, arguments)?;
        Ok(Self {
            request,
            camera: world_source::camera(&imported.world, &request.camera, arguments)?,
            paths: Paths::new(&imported.world),
            imported,
        })
    }

    pub(super) fn name(&self) -> String {
        let name = self.request.source.path.file_stem().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    /// What results are made from.
    pub(super) fn made_from(&self) -> Value {
        let name = self.request.source.path.file_name();
        tree_of!({
            "scene": name.map(|name| name.to_string_lossy()),
            "camera": self.camera.name,
            "seed": self.request.seed,
            "version": VERSION,
            "notes": world_source::notes(&self.imported),
        })
    }

    pub(super) fn question(&self, pixel: [usize; 2], azimuths: usize) -> Question {
        Question {
            pixel,
            surfaces: self.request.surfaces.into(),
            across: self.request.window,
            frequencies: FREQUENCIES,
            azimuths,
        }
    }

    /// Claims the folder that is asked for, or one of this name.
    pub(super) fn claim(
        &self,
        name: String,
        files: Vec<String>,
    ) -> Result<(Results, PathBuf), Failure> {
        let folder = self.request.out.clone();
        let folder = folder.unwrap_or_else(|| Path::new("out").join(name));
        let plan = Plan {
            index: PROBE,
            files,
            inputs: vec![self.request.source.path.clone()],
            force: self.request.force,
            arguments: self.request.source.arguments,
        };
        Ok((Results::claim(&folder, plan)?, folder))
    }
}
