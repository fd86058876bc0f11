//! Compares two results of one scene.

use super::pairs::unpaired;
use super::planes::{self, PlaneDiff, PlaneDifference};
use super::stored::StoredResult;
use etendue_compare::{Verdict, sidak};
use etendue_store::Failure;
use etendue_store::fields::{FieldChange, differences};
use std::path::Path;

/// Two results and their differences.
#[derive(Debug)]
pub struct Diff {
    pub(super) results: [StoredResult; 2],
    pub(super) alpha: f64,
    /// The reason why the batches of the results are not tested in pairs; `None` if they are.
    pub(super) unpaired: Option<String>,
    /// The fields whose values in the two scenes differ.
    pub(super) scene: Vec<FieldChange>,
    pub(super) planes: Vec<PlaneDiff>,
}

impl Diff {
    /// Compares the results in two folders; `alpha` is the probability of finding a difference
    /// where there is none.
    ///
    /// # Errors
    /// When a folder holds no complete result, or when the results have no plane in common.
    pub fn read(folders: [&Path; 2], alpha: f64) -> Result<Self, Failure> {
        let [a, b] = folders.map(StoredResult::read);
        Self::of([a?, b?], alpha)
    }

    fn of(results: [StoredResult; 2], alpha: f64) -> Result<Self, Failure> {
        let [a, b] = &results;
        let scene = differences(&a.index.scene_file, &b.index.scene_file);
        let is_one_scene = scene.iter().all(is_of_run) && !has_other_inputs(a, b, &scene);
        let unpaired = unpaired(a, b);
        let planes = planes::of_results(a, b, is_one_scene, unpaired.is_none())?;
        if planes
            .iter()
            .all(|plane| matches!(plane.found, PlaneDifference::Missing(_)))
        {
            let [a, b] = [a, b].map(|result| result.folder().display());
            return Err(Failure::bad_input(format!(
                "{a} and {b} have no plane in common: they are results of different scenes"
            )));
        }
        Ok(Self {
            results,
            alpha,
            unpaired,
            scene,
            planes,
        })
    }

    /// The number of tests of slices, and the number of tests of parameters.
    pub(super) fn tests(&self) -> [usize; 2] {
        let compared = || self.planes.iter().filter_map(PlaneDiff::compared);
        let slices = compared().filter(|plane| plane.test.p_value.is_some());
        let parameters = compared().map(|plane| plane.pulls().count());
        [slices.count(), parameters.sum()]
    }

    /// The significance level of each test. If the results do not differ, some test finds a
    /// difference with probability α.
    pub(super) fn level(&self) -> f64 {
        let [slices, parameters] = self.tests();
        sidak(self.alpha, (slices + parameters).max(1))
    }

    /// The reason why the results are not compared in pairs; `None` if they are.
    #[must_use]
    pub fn unpaired(&self) -> Option<&str> {
        self.unpaired.as_deref()
    }

    /// The verdict from all tests together.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let level = self.level();
        let each = self.planes.iter().map(|plane| plane.verdict(level));
        each.fold(Verdict::Pass, Verdict::and)
    }
}

/// Checks whether a field affects only the measurement of a scene, and not the scene itself.
pub(super) fn is_of_run(change: &FieldChange) -> bool {
    change.field.starts_with("run.")
}

/// Checks whether two scenes with equal files use different meshes or pictures.
pub(super) fn has_other_inputs(a: &StoredResult, b: &StoredResult, scene: &[FieldChange]) -> bool {
    let [a, b] = [a, b].map(|result| &result.index);
    // The name of the scene is not part of its hash. Results of different versions are not compared
    // by hash, because the versions may have other defaults.
    scene.is_empty() && a.version == b.version && a.scene_hash != b.scene_hash
}
