//! A picture that is asked for.

use crate::world_source::{CameraChoice, WorldSource};

/// A picture that is asked for.
#[derive(Clone, Debug)]
pub struct PictureRequest {
    /// The scene.
    pub source: WorldSource,
    /// The camera.
    pub camera: CameraChoice,
    /// How few shading samples are spent; `None` for a reference.
    pub method: Option<etendue_adaptive::Method>,
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
