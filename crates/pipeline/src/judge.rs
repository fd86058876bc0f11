//! Makes independent measurements by other methods. A measurement is tested against them, plane by
//! plane.

use crate::measure::measured;
use crate::method::judge_of;
use crate::reporter::Reporter;
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_store::{Failure, Method};

/// A measurement of some planes of a scene by one method.
#[derive(Debug)]
pub(crate) struct Judge {
    pub(crate) method: Method,
    pub(crate) measurement: Measurement,
    /// The indices of the measured planes in the scene, ascending.
    planes: Vec<usize>,
}

impl Judge {
    /// Measures some planes of a scene by the methods against which a measurement by `method` is
    /// tested at these planes. Returns one measurement for each method.
    pub(crate) fn all(
        scene: &Scene,
        planes: &[usize],
        method: Method,
        reporter: &dyn Reporter,
    ) -> Result<Vec<Self>, Failure> {
        let methods = [Method::Photons, Method::Backward, Method::Even];
        let mut judges = Vec::new();
        for judge in methods {
            let is_judge = |i: &usize| judge_of(method, scene, &scene.planes[*i]) == judge;
            let planes: Vec<usize> = planes.iter().copied().filter(is_judge).collect();
            if planes.is_empty() {
                continue;
            }
            let scene = scene.seen_at(&planes);
            judges.push(Self {
                method: judge,
                measurement: measured(&scene, judge, 0..scene.run.batches, reporter)?,
                planes,
            });
        }
        Ok(judges)
    }

    /// The independent measurement of a plane of the scene, and the index of the plane in
    /// this measurement.
    pub(crate) fn of(all: &[Self], plane: usize) -> Option<(&Self, usize)> {
        all.iter().find_map(|judge| {
            let at = judge.planes.binary_search(&plane).ok()?;
            Some((judge, at))
        })
    }
}
