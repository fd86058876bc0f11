//! What a run of a scene comes to: whether its verdict is wrong, and who of three is.

use super::run::{PlaneSummary, RunEnding, Runner};
use crate::scenes::{measured, traced, traced_backwards};
use etendue_compare::{Applicability, Prediction, Test, Verdict, compare};
use etendue_scene::{SceneFile, resolve};
use etendue_trace::{Tracer, finds};
use std::io;
use std::path::Path;

/// What is wrong with a scene, and stays so while it is made smaller.
#[derive(Clone)]
pub(super) enum SceneTrouble {
    Panic,
    Hang,
    Killed,
    /// This plane fails, by photons or by backward rays, and again with other seeds.
    Wrong {
        plane: String,
        backward: bool,
        culprit: Culprit,
    },
}

/// Who is wrong where a plane fails.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Culprit {
    /// Both tracers agree, the prediction does not.
    Theory,
    /// The tracers do not agree.
    Tracer,
    /// The verdict, given by a handful of rays.
    Handful,
    /// One of these.
    Unknown,
}

impl Culprit {
    pub(super) fn says(self) -> &'static str {
        match self {
            Self::Theory => "the tracers agree, theory does not",
            Self::Tracer => "the tracers do not agree",
            Self::Handful => "a handful of rays decides",
            Self::Unknown => "left open who is wrong",
        }
    }
}

/// A scene looked into.
#[derive(Default)]
pub(super) struct JudgedScene {
    /// Why it was refused.
    pub(super) refused: Option<String>,
    /// What the scene came to.
    pub(super) verdicts: Vec<String>,
    /// Runs with a verdict, those with a plane that fails, and those that do not repeat.
    pub(super) runs: usize,
    pub(super) fails: usize,
    pub(super) chance: usize,
    /// What is wrong, in words.
    pub(super) troubles: Vec<(SceneTrouble, String)>,
}

/// Fewer rays than this in the window are too few for the spread of 64 batches: about ten in each.
pub(crate) const HANDFUL: u64 = 640;

/// The seed of the first run of a scene, which is its own, and those of two more runs.
fn seeds(file: &SceneFile) -> [u64; 3] {
    [0, 1, 2].map(|i| file.run.seed + i)
}

/// Runs a scene, and looks into what fails.
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

/// What is wrong with a run that did not come to an end.
fn trouble(ending: &RunEnding) -> Option<(SceneTrouble, String)> {
    match ending {
        RunEnding::Panic(says) => Some((SceneTrouble::Panic, says.clone())),
        RunEnding::Hang => Some((SceneTrouble::Hang, "over the limit of time".into())),
        RunEnding::Killed(how) => Some((SceneTrouble::Killed, how.clone())),
        RunEnding::Done(_) | RunEnding::Refused(_) => None,
    }
}

impl JudgedScene {
    /// Takes the verdicts of a run; what fails is run again with other seeds.
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

/// Who of photons, backward rays and prediction is wrong.
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

/// Photons of one plane, and backward rays or what takes their place.
struct Tracers {
    verdict: Verdict,
    p: Option<f64>,
    /// How many were in the window.
    inside: [u64; 2],
}

/// Photons compared with backward rays, or with photons sent evenly where these find no light.
fn of_tracers(file: &SceneFile, folder: &Path, name: &str) -> Option<Tracers> {
    let mut scene = resolve("scene", file.clone(), folder, u64::MAX).ok()?;
    scene.planes.retain(|plane| plane.name == name);
    let plane = scene.planes.first()?;
    let photons = traced(&scene);
    let rays = if finds(&scene, plane) {
        traced_backwards(&scene)?
    } else {
        measured(&scene, &Tracer::evenly(&scene))
    };
    let inside = [&photons, &rays].map(|measured| measured.tally(0).inside);
    let theory = Applicability::new(&scene, plane);
    let reference = Prediction::reference(&scene, 0, &theory, &rays, 0).ok()?;
    let compared = compare(&photons, 0, &reference, &Test::of(&scene)).ok()?;
    Some(Tracers {
        verdict: compared.report.verdict,
        p: compared.report.p_value,
        inside,
    })
}

/// Whether a scene is still in the same trouble, chance left out.
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
