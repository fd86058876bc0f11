//! A picture that is asked for.

use crate::world_source::{CameraChoice, WorldSource};
use etendue_adaptive::{BLOCKER_RAYS, SampleMethod};

/// A picture that is asked for.
#[derive(Clone, Debug)]
pub struct PictureRequest {
    /// The scene.
    pub source: WorldSource,
    /// The camera.
    pub camera: CameraChoice,
    /// How few shading samples are spent; `None` for a reference.
    pub method: Option<SampleMethod>,
    /// Paths for each pixel of a reference.
    pub samples: u32,
    /// Shading samples of the whole picture; otherwise one for each 20 pixels.
    pub shading_samples: Option<u32>,
    /// Paths of each shading sample.
    pub paths: u32,
    /// Rays of each point by which the distance of blockers is found.
    pub blocker_rays: u32,
    /// Whether samples are as dense along all directions.
    pub isotropic: bool,
    /// Seed of the paths.
    pub seed: u64,
    /// Whether files that Étendue did not write are replaced.
    pub force: bool,
}

impl PictureRequest {
    /// Paths for each pixel of a reference, unless said.
    pub const SAMPLES: u32 = 64;
    /// Paths of each shading sample, unless said.
    pub const PATHS: u32 = 128;
    /// Rays by which the distance of blockers is found, unless said.
    pub const BLOCKER_RAYS: u32 = BLOCKER_RAYS;
    /// The seed, unless said.
    pub const SEED: u64 = 1;

    /// Each method by its name.
    pub const METHODS: [(&str, Option<SampleMethod>); 6] = [
        ("reference", None),
        ("uniform", Some(SampleMethod::Uniform)),
        ("predicted", Some(SampleMethod::Predicted)),
        ("printed", Some(SampleMethod::Printed)),
        ("weighted", Some(SampleMethod::Weighted)),
        ("variance", Some(SampleMethod::Variance)),
    ];

    /// A reference of a scene as its first camera sees it.
    #[must_use]
    pub fn new(source: WorldSource) -> Self {
        Self {
            source,
            camera: CameraChoice::default(),
            method: None,
            samples: Self::SAMPLES,
            shading_samples: None,
            paths: Self::PATHS,
            blocker_rays: Self::BLOCKER_RAYS,
            isotropic: false,
            seed: Self::SEED,
            force: false,
        }
    }

    /// The method where none is named: a reference, unless a number of shading samples is.
    #[must_use]
    pub fn usual_method(shading_samples: Option<u32>) -> Option<SampleMethod> {
        shading_samples.map(|_| SampleMethod::Predicted)
    }
}
