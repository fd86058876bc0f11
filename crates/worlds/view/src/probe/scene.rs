//! A scene that is probed, and the request.

use crate::world_source::{self, CameraChoice, WorldSource};
use etendue_import::Imported;
use etendue_paths::{Budget, Paths, Question};
use etendue_store::{Failure, PROBE, Plan, Results};
use etendue_studies::variance::VarianceOptions;
use etendue_world::Camera;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Number of batches of rays, and of photons. Errors and p-values are computed from the differences
/// between batches.
pub(super) const BATCHES: u32 = 64;
/// The level of the test over all planes together.
pub(super) const ALPHA: f64 = 0.01;
/// A plane can pass only if its noise, as a share of the spectrum, is at most this number.
pub(super) const RESOLUTION: f64 = 0.1;

/// Number of frequencies on either side of zero; adjacent frequencies differ by one cycle per
/// width of the window.
pub(super) const FREQUENCIES: usize = 12;

/// The number of rays of each batch.
pub(super) fn budget(count: u64, seed: u64) -> Budget {
    Budget {
        each: count.div_ceil(u64::from(BATCHES)),
        seed,
    }
}

/// The seed of rays that are traced for one plane alone.
pub(super) fn seed_at(seed: u64, plane: usize) -> u64 {
    seed ^ ((plane as u64 + 1) << 48)
}

/// A request for a probe, with its scene.
#[derive(Clone, Debug)]
pub struct ProbeRequest {
    /// The scene.
    pub source: WorldSource,
    /// The camera.
    pub camera: CameraChoice,
    /// The largest number of surfaces along the ray.
    pub surfaces: u16,
    /// Pixels across the window; `None` for the narrowest window that shows the bandwidth of the
    /// picture.
    pub window: Option<f64>,
    /// Number of backward rays for each plane.
    pub rays: u64,
    /// Number of photons that check the rays; planes that photons cannot decide get at least as many
    /// BSDF rays. If it is `None`, planes get as many of both and of backward rays as their verdicts
    /// need.
    pub photons: Option<u64>,
    /// Seed of rays and photons.
    pub seed: u64,
    /// Whether the covariance of each plane's spectrum is measured too.
    pub covariance: bool,
    /// The samplers whose errors at each plane are predicted and found, if requested.
    pub variance: Option<VarianceOptions>,
    /// The results folder; by default a folder below `out`.
    pub out: Option<PathBuf>,
    /// Whether files that Étendue did not write may be replaced.
    pub force: bool,
}

impl ProbeRequest {
    /// Default for the largest number of surfaces along the ray.
    pub const SURFACES: u16 = 1;
    /// Default number of backward rays for each plane.
    pub const RAYS: u64 = 1 << 20;
    /// Default number of backward rays for each pixel of a map.
    pub const RAYS_OF_MAP: u64 = 1 << 15;
    /// The number of photons with which a probe begins if their number is not fixed.
    const FIRST_PHOTONS: u64 = 1 << 20;
    /// Default seed.
    pub const SEED: u64 = 1;

    /// A probe of the light seen by the first camera of a scene.
    #[must_use]
    pub fn new(source: WorldSource) -> Self {
        Self {
            source,
            camera: CameraChoice::default(),
            surfaces: Self::SURFACES,
            window: None,
            rays: Self::RAYS,
            photons: None,
            seed: Self::SEED,
            covariance: false,
            variance: None,
            out: None,
            force: false,
        }
    }

    /// The number of photons with which a probe begins.
    pub(super) fn first_photons(&self) -> u64 {
        self.photons.unwrap_or(Self::FIRST_PHOTONS)
    }

    /// The first number of BSDF rays of a plane. BSDF rays have more noise than backward
    /// rays, so a fixed number is at least four times as large.
    pub(super) fn first_bsdf_rays(&self) -> u64 {
        match self.photons {
            Some(photons) => photons.max(self.rays.saturating_mul(4)),
            None => Self::FIRST_PHOTONS,
        }
    }
}

/// A scene that has been read.
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
            paths: world_source::paths(&imported.world)?,
            imported,
        })
    }

    pub(super) fn name(&self) -> String {
        let name = self.request.source.path.file_stem().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    /// The settings that a result depends on, for its index.
    pub(super) fn made_from(&self) -> Value {
        let request = self.request;
        world_source::made_from(&request.source, &self.imported, &self.camera, request.seed)
    }

    pub(super) fn question(&self, pixel: [usize; 2], across: f64, azimuths: usize) -> Question {
        Question {
            pixel,
            surfaces: self.request.surfaces.into(),
            across,
            frequencies: FREQUENCIES,
            azimuths,
        }
    }

    /// Claims the requested folder or, by default, a folder of this name below `out`.
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
