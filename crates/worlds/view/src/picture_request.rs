//! A request for a picture.

use crate::world_source::{CameraChoice, WorldSource};
use etendue_adaptive::SampleMethod;

/// A request for a picture.
#[derive(Clone, Debug)]
pub struct PictureRequest {
    /// The scene.
    pub source: WorldSource,
    /// The camera.
    pub camera: CameraChoice,
    /// The method that places few shading samples; `None` requests a reference picture.
    pub method: Option<SampleMethod>,
    /// Paths for each pixel of a reference.
    pub samples: u32,
    /// Shading samples of the whole picture; one for each 20 pixels by default.
    pub shading_samples: Option<u32>,
    /// Paths of each shading sample.
    pub paths: u32,
    /// Rays per point that estimate the distance of blockers; by default, those of the method.
    pub blocker_rays: Option<u32>,
    /// Whether sample density is the same along all directions.
    pub isotropic: bool,
    /// Seed of the paths.
    pub seed: u64,
    /// Whether files that Étendue did not write may be replaced.
    pub force: bool,
}

impl PictureRequest {
    /// Default number of paths for each pixel of a reference.
    pub const SAMPLES: u32 = 64;
    /// Default number of paths of each shading sample.
    pub const PATHS: u32 = 128;
    /// Default seed.
    pub const SEED: u64 = 1;

    /// The methods by name.
    pub const METHODS: [(&str, Option<SampleMethod>); 7] = [
        ("reference", None),
        ("auto", Some(SampleMethod::Auto)),
        ("uniform", Some(SampleMethod::Uniform)),
        ("predicted", Some(SampleMethod::Predicted)),
        ("paper", Some(SampleMethod::Paper)),
        ("weighted", Some(SampleMethod::Weighted)),
        ("variance", Some(SampleMethod::Variance)),
    ];

    /// A reference picture of a scene from its first camera.
    #[must_use]
    pub fn new(source: WorldSource) -> Self {
        Self {
            source,
            camera: CameraChoice::default(),
            method: None,
            samples: Self::SAMPLES,
            shading_samples: None,
            paths: Self::PATHS,
            blocker_rays: None,
            isotropic: false,
            seed: Self::SEED,
            force: false,
        }
    }

    /// The default method. If no number of shading samples is given, this is a reference.
    #[must_use]
    pub fn usual_method(shading_samples: Option<u32>) -> Option<SampleMethod> {
        shading_samples.map(|_| SampleMethod::Auto)
    }
}
