//! Predicts a plane as if the assumptions of theory held, and compares the prediction with
//! photons.

use super::kind::{DARK, UNKNOWN, assumption};
use crate::scenes::traced;
use crate::wild::HANDFUL;
use etendue_compare::{Prediction, Verdict, compare};
use etendue_field::{Light, ProjectionGrid, VirtualPlane};
use etendue_predict::{Applicability, Theory, predict, seconds, test_of, too_much_work};
use etendue_scene::{Object, Scene};
use etendue_theory::{Model, Predicted, RayBudget};
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The trial of a plane that `check` reports as outside theory, or as dark.
pub(super) struct Trial {
    pub(super) plane: String,
    /// The violated assumptions, each once.
    pub(super) broken: BTreeSet<&'static str>,
    /// The outcome of the unchecked prediction. If a plane violates more than one assumption, the
    /// outcome would be inconclusive and is `None`.
    pub(super) ending: Option<TrialEnding>,
}

/// The outcome of an unchecked prediction.
#[derive(Debug)]
pub(super) enum TrialEnding {
    /// The prediction was compared with photons; `inside` is the number of photons in the window.
    Judged { verdict: Verdict, inside: u64 },
    /// No theory can describe the surfaces on the central ray.
    Speechless,
    /// The prediction would take too long.
    Skipped,
    /// The prediction panicked; the text is the message of the panic.
    Panicked(#[expect(dead_code, reason = "the message is only printed")] String),
}

/// Two seeds. A plane counts as failed only if it fails with both seeds, because with a single seed
/// one correct plane in a hundred fails.
const SEEDS: [u64; 2] = [1, 2];
/// Maximum time for a prediction and its derivatives, in seconds of one core.
const LONGEST: f64 = 60.0;
/// The budget of rays that a run with 2·10⁵ photons gives to a prediction.
const BUDGET: RayBudget = RayBudget::new(1.1e6, 3e-3);

/// Tries the planes of a scene for which `check` reports a violation, one plane at a time.
pub(super) fn trials(scene: &Scene) -> Vec<Trial> {
    let alone = (0..scene.planes.len()).map(|plane| scene.seen_at(&[plane]));
    alone.filter_map(|scene| trial(&scene)).collect()
}

fn trial(scene: &Scene) -> Option<Trial> {
    let plane = &scene.planes[0];
    let trial = |broken: BTreeSet<&'static str>, ending| {
        Some(Trial {
            plane: plane.name.clone(),
            broken,
            ending,
        })
    };
    let checked = match caught(|| Applicability::new(scene, plane)) {
        Ok(checked) => checked,
        Err(says) => return trial([UNKNOWN].into(), Some(TrialEnding::Panicked(says))),
    };
    let name = |reason: &String| assumption(reason).unwrap_or(UNKNOWN);
    let reasons = checked.reasons.iter().chain(&checked.declined);
    let mut broken: BTreeSet<_> = reasons.map(name).collect();
    broken.extend(checked.dark.is_some().then_some(DARK));
    let tried = (broken.len() == 1).then(|| {
        let ending = caught(|| unchecked(scene, plane, &checked));
        ending.unwrap_or_else(TrialEnding::Panicked)
    });
    if broken.is_empty() {
        None
    } else {
        trial(broken, tried)
    }
}

/// The result of `work`, or its panic message.
fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    // After `work` panics, nothing that `work` modified is used.
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let text = panic.downcast_ref::<&str>().map(ToString::to_string);
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
        text.unwrap_or_default()
    })
}

/// Predicts a plane without the check of assumptions, and compares the prediction with photons.
fn unchecked(scene: &Scene, plane: &VirtualPlane, checked: &Applicability) -> TrialEnding {
    let theory = Theory::of(scene, plane);
    if !has_words(scene, plane, &theory) {
        return TrialEnding::Speechless;
    }
    let regardless = [Applicability {
        theory,
        reasons: Vec::new(),
        declined: Vec::new(),
        dark: None,
        others: Vec::new(),
        off_patches: None,
    }];
    let [_, longest, _] = seconds(scene, &regardless);
    if longest > LONGEST || too_much_work(scene, &regardless).is_some() {
        return TrialEnding::Skipped;
    }
    let found = predicted(plane, &regardless[0].theory);
    // The affine chain is not compared, because a run judges the chain by a verdict of its own.
    let prediction = Prediction {
        slices: found.slices,
        replicates: found.replicates,
        quadrature_error: found.error,
        unblocked: found.unblocked,
        ..predict(scene, plane, checked)
    };
    match judged(scene, SEEDS[0], &prediction) {
        TrialEnding::Judged {
            verdict: Verdict::Fail,
            ..
        } => judged(scene, SEEDS[1], &prediction),
        other => other,
    }
}

/// Checks whether a theory can describe the surfaces on the central ray. The theory of parallel
/// planes describes at most one surface, which must be Lambertian and lit by a lamp.
fn has_words(scene: &Scene, plane: &VirtualPlane, theory: &Theory) -> bool {
    let Theory::Parallel(_) = theory else {
        return true;
    };
    let mut hits = scene.path.legs[..=plane.leg].iter();
    let lamp = !scene.light.is_picture() && !matches!(scene.light, Light::Environment { .. });
    lamp && plane.leg < 2
        && hits.all(|leg| match leg.leaves.map(|hit| hit.object) {
            Some(Object::Patch(_)) => false,
            Some(Object::Mesh(i)) => scene.meshes[i].albedo.is_some(),
            Some(Object::Surface(_)) | None => true,
        })
}

/// The prediction of a theory for a plane, without derivatives.
fn predicted(plane: &VirtualPlane, theory: &Theory) -> Predicted {
    let picture = ProjectionGrid::new(&plane.window, 1);
    let over = (&plane.window, &plane.grid, &picture);
    match theory {
        Theory::Parallel(chain) => chain.predict(&[], over, BUDGET),
        Theory::Path(view) => view.predict(&[], over, BUDGET),
        Theory::None => unreachable!("a plane has some theory if nothing is checked"),
    }
}

/// Compares the prediction of a scene's only plane with photons drawn with the given seed.
fn judged(scene: &Scene, seed: u64, prediction: &Prediction) -> TrialEnding {
    let mut scene = scene.clone();
    scene.run.seed = seed;
    let photons = traced(&scene);
    let inside = photons.tally(0).inside;
    let compared = compare(&photons, 0, prediction, &test_of(&scene));
    let verdict = compared.map_or(Verdict::Undecided, |compared| compared.report.verdict);
    let few = verdict == Verdict::Fail && inside < HANDFUL;
    TrialEnding::Judged {
        verdict: if few { Verdict::Undecided } else { verdict },
        inside,
    }
}
