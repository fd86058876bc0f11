//! Judges a run: determines whether its verdict is wrong, and whether a tracer or the prediction
//! causes this.

use super::run::{PlaneSummary, RunEnding, Runner};
use crate::scenes::{traced, traced_backwards, traced_evenly};
use etendue_compare::{Verdict, compare};
use etendue_predict::{Applicability, predict_reference, test_of};
use etendue_scene::{SceneFile, resolve};
use etendue_trace::finds;
use std::io;
use std::path::Path;

/// A fault of a scene, which must persist while the scene is reduced.
#[derive(Clone)]
pub(super) enum SceneTrouble {
    Panic,
    Hang,
    Killed,
    /// The plane of this name fails with photons or with backward rays. It fails again with other
    /// seeds.
    Wrong {
        plane: String,
        backward: bool,
        culprit: Culprit,
    },
}

/// The cause of a failed plane.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Culprit {
    /// The prediction is wrong: both tracers agree with each other, but disagree with the
    /// prediction.
    Theory,
    /// A tracer is wrong: the two tracers disagree.
    Tracer,
    /// The verdict "disagreement" is wrong, because it is based on too few rays.
    Handful,
    /// The comparisons do not determine whether a tracer or the prediction is wrong.
    Unknown,
}

impl Culprit {
    pub(super) fn says(self) -> &'static str {
        match self {
            Self::Theory => "both tracers agree, but theory disagrees with them",
            Self::Tracer => "the two tracers disagree",
            Self::Handful => "a few rays carry the result",
            Self::Unknown => "it is open which side is wrong",
        }
    }
}

/// The judgement of a scene.
#[derive(Default)]
pub(super) struct JudgedScene {
    /// The reason for a refusal.
    pub(super) refused: Option<String>,
    /// The verdicts on the planes of the scene.
    pub(super) verdicts: Vec<String>,
    /// Three counts: runs with a verdict (`runs`), runs with a failed plane (`fails`), and
    /// failures that do not repeat with other seeds (`chance`).
    pub(super) runs: usize,
    pub(super) fails: usize,
    pub(super) chance: usize,
    /// The faults of the scene, each with a description.
    pub(super) troubles: Vec<(SceneTrouble, String)>,
}

/// Minimum number of rays in the window for which the spread of 64 batches is reliable, about ten
/// rays in each batch.
pub(crate) const HANDFUL: u64 = 640;

/// Three seeds: the seed in the scene file, for the first run, and the seeds for two more
/// runs.
fn seeds(file: &SceneFile) -> [u64; 3] {
    [0, 1, 2].map(|i| file.run.seed + i)
}

/// Runs a scene, and investigates failures.
pub(super) fn judge(runner: &Runner, file: &SceneFile) -> io::Result<JudgedScene> {
    let mut judged = JudgedScene::default();
    let [first, ..] = seeds(file);
    let planes = match runner.run(file, first, false)? {
        RunEnding::Done(planes) => planes,
        RunEnding::Refused(why) => {
            judged.refused = Some(why);
            return Ok(judged);
        }
        other => {
            judged.troubles.extend(trouble(&other));
            return Ok(judged);
        }
    };
    let verdicts = planes.iter();
    judged.verdicts = verdicts
        .map(|p| format!("{} {}", p.class, p.verdict))
        .collect();
    judged.count(runner, file, &planes, false)?;
    let open = |p: &PlaneSummary| p.is_undecided() && !p.is_reference();
    if planes.iter().any(open) {
        match runner.run(file, first, true)? {
            RunEnding::Done(planes) => judged.count(runner, file, &planes, true)?,
            other => judged.troubles.extend(trouble(&other)),
        }
    }
    Ok(judged)
}

/// The fault that a run without a result shows.
fn trouble(ending: &RunEnding) -> Option<(SceneTrouble, String)> {
    match ending {
        RunEnding::Panic(says) => Some((SceneTrouble::Panic, says.clone())),
        RunEnding::Hang => Some((SceneTrouble::Hang, "over the limit of time".into())),
        RunEnding::Killed(how) => Some((SceneTrouble::Killed, how.clone())),
        RunEnding::Done(_) | RunEnding::Refused(_) => None,
    }
}

impl JudgedScene {
    /// Records the verdicts of a run; if a plane fails, the scene is run again with other seeds.
    fn count(
        &mut self,
        runner: &Runner,
        file: &SceneFile,
        planes: &[PlaneSummary],
        backward: bool,
    ) -> io::Result<()> {
        self.runs += 1;
        if !planes.iter().any(PlaneSummary::fails) {
            return Ok(());
        }
        self.fails += 1;
        let mut again = Vec::new();
        for seed in &seeds(file)[1..] {
            if let RunEnding::Done(planes) = runner.run(file, *seed, backward)? {
                let failing = planes.into_iter().filter(PlaneSummary::fails);
                again.extend(failing.map(|plane| plane.name));
            }
        }
        let wrong = planes.iter();
        let wrong: Vec<_> = wrong
            .filter(|plane| plane.fails() && again.contains(&plane.name))
            .collect();
        if wrong.is_empty() {
            self.chance += 1;
        }
        for plane in wrong {
            let times = 1 + again.iter().filter(|name| **name == plane.name).count();
            let (culprit, who) = who(runner, file, plane, backward)?;
            let by = if backward { "backward rays" } else { "photons" };
            let [p, chain] = plane.p.map(shown);
            let [off, noise, stated] = plane.errors.map(shown);
            self.troubles.push((
                SceneTrouble::Wrong {
                    plane: plane.name.clone(),
                    backward,
                    culprit,
                },
                format!(
                    "{} ({}) fails by {by} with {times} of 3 seeds, p {p}, of the chain {chain}, \
                     off {off}, noise {noise}, stated {stated}; {}: {who}",
                    plane.name,
                    plane.class,
                    culprit.says()
                ),
            ));
        }
        Ok(())
    }
}

fn shown(x: Option<f64>) -> String {
    x.map_or("–".into(), |x| format!("{x:.3e}"))
}

/// Determines which of photons, backward rays and prediction is wrong.
fn who(
    runner: &Runner,
    file: &SceneFile,
    plane: &PlaneSummary,
    backward: bool,
) -> io::Result<(Culprit, String)> {
    let (folder, copy, name) = (runner.folder.clone(), file.clone(), plane.name.clone());
    let tracers = std::thread::spawn(move || of_tracers(&copy, &folder, &name));
    let Some(tracers) = tracers.join().unwrap_or(None) else {
        return Ok((Culprit::Unknown, "the tracers cannot be compared".into()));
    };
    let [photons, rays] = tracers.inside;
    let looked = match (plane.is_reference(), backward) {
        (true, _) => photons.min(rays),
        (false, false) => photons,
        (false, true) => rays,
    };
    let culprit = match tracers.verdict {
        _ if looked < HANDFUL => Culprit::Handful,
        Verdict::Fail => Culprit::Tracer,
        _ if plane.is_reference() => Culprit::Unknown,
        Verdict::Pass => Culprit::Theory,
        Verdict::Undecided => Culprit::Unknown,
    };
    let other = if plane.is_reference() {
        String::new()
    } else {
        let by = if backward { "photons" } else { "backward rays" };
        let ending = runner.run(file, file.run.seed, !backward)?;
        let found = match &ending {
            RunEnding::Done(planes) => planes.iter().find(|p| p.name == plane.name),
            _ => None,
        };
        let found = found.map_or("no end", |plane| &plane.verdict);
        format!("; {by} to the prediction: {found}")
    };
    let (verdict, p) = (tracers.verdict, shown(tracers.p));
    Ok((
        culprit,
        format!(
            "{photons} photons and {rays} backward rays in the window; one to the other: \
             {verdict:?}, p {p}{other}"
        ),
    ))
}

/// Photons at one plane, and the backward rays (or substitute photons) compared with them.
struct Tracers {
    verdict: Verdict,
    p: Option<f64>,
    /// Numbers of rays that each of the two tracers has in the window.
    inside: [u64; 2],
}

/// Compares photons with backward rays, or, if backward rays find no light, with photons that are
/// not aimed.
fn of_tracers(file: &SceneFile, folder: &Path, name: &str) -> Option<Tracers> {
    let mut scene = resolve("scene", file.clone(), folder, u64::MAX).ok()?;
    scene = scene.seen_at(&[scene.plane_named(name)?]);
    let plane = scene.planes.first()?;
    let photons = traced(&scene);
    let rays = if scene.lights().all(|of| {
        let seen = of.plane_named(name);
        seen.is_none_or(|i| finds(of, &of.planes[i]))
    }) {
        traced_backwards(&scene)?
    } else {
        traced_evenly(&scene)
    };
    let inside = [&photons, &rays].map(|measured| measured.tally(0).inside);
    let theory = Applicability::new(&scene, plane);
    let reference = predict_reference(&scene, 0, &theory, &rays, 0).ok()?;
    let compared = compare(&photons, 0, &reference, &test_of(&scene)).ok()?;
    Some(Tracers {
        verdict: compared.report.verdict,
        p: compared.report.p_value,
        inside,
    })
}

/// Whether a reduced scene still has the same fault, with more than one seed.
pub(super) fn persists(
    runner: &Runner,
    file: &SceneFile,
    trouble: &SceneTrouble,
) -> io::Result<bool> {
    let [first, second, _] = seeds(file);
    let ending = || runner.run(file, first, false);
    match trouble {
        SceneTrouble::Panic => Ok(matches!(ending()?, RunEnding::Panic(_))),
        SceneTrouble::Hang => Ok(matches!(ending()?, RunEnding::Hang)),
        SceneTrouble::Killed => Ok(matches!(ending()?, RunEnding::Killed(_))),
        SceneTrouble::Wrong {
            plane, backward, ..
        } => {
            for seed in [first, second] {
                let RunEnding::Done(planes) = runner.run(file, seed, *backward)? else {
                    return Ok(false);
                };
                if !planes.iter().any(|p| p.name == *plane && p.fails()) {
                    return Ok(false);
                }
            }
            Ok(true)
        }
    }
}
