//! `etendue diff`: two results of one scene held against each other.

mod planes;
mod stored;
mod text;

use crate::args::DiffArgs;
use crate::conclude::code_of;
use crate::print::deliver;
use etendue_compare::{Verdict, sidak};
use etendue_store::Failure;
use etendue_store::fields::{FieldChange, differences};
use planes::{Found, PlaneDiff};
use stored::StoredResult;

/// `etendue diff`: returns the exit code.
pub(crate) fn diff(args: &DiffArgs) -> Result<u8, Failure> {
    let results = [&args.a, &args.b].map(|folder| StoredResult::read(folder));
    let [a, b] = results;
    let diff = Diff::of([a?, b?], args.alpha)?;
    deliver(&text::text(&diff))?;
    Ok(code_of(diff.verdict()))
}

/// Two results, and what differs.
struct Diff {
    results: [StoredResult; 2],
    alpha: f64,
    /// The fields of the scene in which they differ.
    scene: Vec<FieldChange>,
    planes: Vec<PlaneDiff>,
}

impl Diff {
    fn of(results: [StoredResult; 2], alpha: f64) -> Result<Self, Failure> {
        let [a, b] = &results;
        let scene = differences(&a.index.scene_file, &b.index.scene_file);
        let is_one_scene = scene.iter().all(is_of_run) && !has_other_inputs(a, b, &scene);
        let planes = planes::of_results(a, b, is_one_scene)?;
        if planes
            .iter()
            .all(|plane| matches!(plane.found, Found::Missing(_)))
        {
            let [a, b] = [a, b].map(|result| result.folder.display());
            return Err(Failure::bad_input(format!(
                "{a} and {b} have no plane in common: they are results of different scenes"
            )));
        }
        Ok(Self {
            results,
            alpha,
            scene,
            planes,
        })
    }

    /// Tests of slices and of parameters.
    fn tests(&self) -> [usize; 2] {
        let compared = || self.planes.iter().filter_map(PlaneDiff::compared);
        let slices = compared().filter(|plane| plane.test.p_value.is_some());
        let parameters = compared().map(|plane| plane.pulls().count());
        [slices.count(), parameters.sum()]
    }

    /// The level of each test, so that all of them together find a difference where there is none with probability α.
    fn level(&self) -> f64 {
        let [slices, parameters] = self.tests();
        sidak(self.alpha, (slices + parameters).max(1))
    }

    fn verdict(&self) -> Verdict {
        let level = self.level();
        let each = self.planes.iter().map(|plane| plane.verdict(level));
        each.fold(Verdict::Pass, Verdict::and)
    }
}

/// Whether a field says how a scene is run, not what it is.
fn is_of_run(change: &FieldChange) -> bool {
    change.field.starts_with("run.")
}

/// Whether scenes that read alike name meshes or pictures that are not.
fn has_other_inputs(a: &StoredResult, b: &StoredResult, scene: &[FieldChange]) -> bool {
    let [a, b] = [a, b].map(|result| &result.index);
    // A name counts in no hash; another version may have other defaults.
    scene.is_empty() && a.version == b.version && a.scene_hash != b.scene_hash
}
