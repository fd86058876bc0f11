//! The request of a sweep.

use crate::sweep::values::{Setting, Sweep};
use etendue_pipeline::load::SceneSource;
use etendue_store::Method;

/// A scene with fields that take several values.
#[derive(Clone, Debug)]
pub struct SweepRequest {
    /// The scene, with fields set to a value at all points.
    pub scene: SceneSource,
    /// Further fields, set to one or several values.
    pub set: Vec<Setting>,
    /// Whether all points share one seed; if not, each point has its own seed.
    pub common_seed: bool,
    /// Whether fields vary together, value by value, instead of in all combinations.
    pub together: bool,
    /// Number of photons of each point, which replaces the number of photons in the scene.
    pub photons: Option<u64>,
    /// Seed of the photons, which replaces the seed in the scene.
    pub seed: Option<u64>,
    /// Method of measurement.
    pub method: Method,
    /// Whether files that Étendue did not write may be replaced.
    pub force: bool,
}

impl SweepRequest {
    /// The request for a sweep by photons over all combinations of the fields' values.
    #[must_use]
    pub fn new(scene: SceneSource, set: Vec<Setting>) -> Self {
        Self {
            scene,
            set,
            common_seed: false,
            together: false,
            photons: None,
            seed: None,
            method: Method::Photons,
            force: false,
        }
    }

    /// The scene with the fields that are set to one value, and the swept fields.
    pub(crate) fn settings(&self) -> (SceneSource, Vec<Sweep>) {
        let (mut source, mut sweeps) = (self.scene.clone(), Vec::new());
        for setting in &self.set {
            match setting {
                Setting::Value(path, value) => source.set.push((path.clone(), value.clone())),
                Setting::Sweep(sweep) => sweeps.push(sweep.clone()),
            }
        }
        (source, sweeps)
    }
}
