//! What a run of a scene comes to: whether its verdict is wrong, and who of three is.

use super::run::{Ending, PlaneSummary, Runner};
use etendue_compare::{Prediction, Verdict, compare, sidak};
use etendue_field::PhotonSource;
use etendue_scene::{LightFile, Scene, SceneFile, resolve};
use etendue_spectrum::{Measurement, measure};
use etendue_trace::{Backward, Tracer};
use std::io;
use std::path::Path;

/// What is wrong with a scene, and stays so while it is made smaller.
#[derive(Clone)]
pub(super) enum Trouble {
    Panic,
    Hang,
    Killed,
    /// This plane fails, by photons or by backward rays, and again with other seeds.
    Wrong {
        plane: String,
        backward: bool,
    },
}

/// A scene looked into.
#[derive(Default)]
pub(super) struct Judged {
    /// Why it was refused.
    pub(super) refused: Option<String>,
    /// What the scene came to.
    pub(super) verdicts: Vec<String>,
    /// Runs with a verdict, those with a plane that fails, and those that do not repeat.
    pub(super) runs: usize,
    pub(super) fails: usize,
    pub(super) chance: usize,
    /// What is wrong, in words.
    pub(super) troubles: Vec<(Trouble, String)>,
}

/// The seed of the first run, and others.
const FIRST: u64 = 1;
const OTHERS: [u64; 2] = [2, 3];

/// Runs a scene, and looks into what fails.
pub(super) fn judge(runner: &Runner, file: &SceneFile) -> io::Result<Judged> {
    let mut judged = Judged::default();
    let planes = match runner.run(file, FIRST, false)? {
        Ending::Done(planes) => planes,
        Ending::Refused(why) => {
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
    if planes.iter().any(open) && has_backward(file) {
        match runner.run(file, FIRST, true)? {
            Ending::Done(planes) => judged.count(runner, file, &planes, true)?,
            other => judged.troubles.extend(trouble(&other)),
        }
    }
    Ok(judged)
}

/// What is wrong with a run that did not come to an end.
fn trouble(ending: &Ending) -> Option<(Trouble, String)> {
    match ending {
        Ending::Panic(says) => Some((Trouble::Panic, says.clone())),
        Ending::Hang => Some((Trouble::Hang, "over the limit of time".into())),
        Ending::Killed(how) => Some((Trouble::Killed, how.clone())),
        Ending::Done(_) | Ending::Refused(_) => None,
    }
}

/// Whether rays can be traced back to the light.
fn has_backward(file: &SceneFile) -> bool {
    !matches!(
        file.light,
        LightFile::Point { .. } | LightFile::Projector { .. } | LightFile::Beam { .. }
    )
}

impl Judged {
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
        for seed in OTHERS {
            if let Ending::Done(planes) = runner.run(file, seed, backward)? {
                let failing = planes.into_iter().filter(PlaneSummary::fails);
                again.extend(failing.map(|plane| plane.name));
            }
        }
        let wrong = planes.iter().enumerate();
        let wrong: Vec<_> = wrong
            .filter(|(_, plane)| plane.fails() && again.contains(&plane.name))
            .collect();
        if wrong.is_empty() {
            self.chance += 1;
        }
        for (i, plane) in wrong {
            let times = 1 + again.iter().filter(|name| **name == plane.name).count();
            let who = who(runner, file, i, plane, backward)?;
            let by = if backward { "backward rays" } else { "photons" };
            let [p, chain] = plane.p.map(shown);
            let [off, noise, stated] = plane.errors.map(shown);
            self.troubles.push((
                Trouble::Wrong {
                    plane: plane.name.clone(),
                    backward,
                },
                format!(
                    "{} ({}) fails by {by} with {times} of 3 seeds, p {p}, of the chain {chain}, \
                     off {off}, noise {noise}, stated {stated}: {who}",
                    plane.name, plane.class
                ),
            ));
        }
        Ok(())
    }
}

fn shown(x: Option<f64>) -> String {
    x.map_or("–".into(), |x| format!("{x:.3e}"))
}

/// Which two of photons, backward rays and prediction agree.
fn who(
    runner: &Runner,
    file: &SceneFile,
    i: usize,
    plane: &PlaneSummary,
    backward: bool,
) -> io::Result<String> {
    if plane.is_reference() {
        return Ok("the two tracers do not agree".into());
    }
    if !has_backward(file) {
        return Ok("no backward rays in this light".into());
    }
    let ending = runner.run(file, FIRST, !backward)?;
    let other = match &ending {
        Ending::Done(planes) => planes.get(i).map_or("", |plane| &plane.verdict),
        _ => "no end",
    };
    let by = if backward { "photons" } else { "backward rays" };
    let (folder, file) = (runner.folder.clone(), file.clone());
    let tracers = std::thread::spawn(move || of_tracers(&file, &folder, i));
    let tracers = tracers.join().unwrap_or(None);
    let Some((verdict, p)) = tracers else {
        return Ok("the tracers cannot be compared".into());
    };
    let finding = match verdict {
        Verdict::Fail => "the tracers do not agree",
        Verdict::Pass => "the tracers agree, theory does not",
        Verdict::Undecided => "the tracers leave it open",
    };
    let p = shown(p);
    Ok(format!(
        "{finding} (photons to backward rays: {verdict:?}, p {p}; {by} to the prediction: {other})"
    ))
}

/// Photons compared with backward rays.
fn of_tracers(file: &SceneFile, folder: &Path, i: usize) -> Option<(Verdict, Option<f64>)> {
    let scene = resolve("scene", file.clone(), folder, u64::MAX).ok()?;
    let measured = |source: &dyn PhotonSource| -> Measurement {
        measure(source, &scene.planes, 0..scene.run.batches, &|_| ())
    };
    let photons = measured(&Tracer::new(&scene));
    let rays = measured(&Backward::new(&scene).ok()?);
    let reference = Prediction::reference(&scene, i, &rays, i).ok()?;
    verdict(&scene, &photons, i, &reference)
}

fn verdict(
    scene: &Scene,
    photons: &Measurement,
    i: usize,
    reference: &Prediction,
) -> Option<(Verdict, Option<f64>)> {
    let level = sidak(scene.run.alpha, scene.planes.len());
    let compared = compare(photons, i, reference, level, scene.run.seed).ok()?;
    Some((compared.report.verdict, compared.report.p_value))
}

/// Whether a scene is still in the same trouble, chance left out.
pub(super) fn persists(runner: &Runner, file: &SceneFile, trouble: &Trouble) -> io::Result<bool> {
    match trouble {
        Trouble::Panic => Ok(matches!(runner.run(file, FIRST, false)?, Ending::Panic(_))),
        Trouble::Hang => Ok(matches!(runner.run(file, FIRST, false)?, Ending::Hang)),
        Trouble::Killed => Ok(matches!(runner.run(file, FIRST, false)?, Ending::Killed(_))),
        Trouble::Wrong { plane, backward } => {
            for seed in [FIRST, OTHERS[0]] {
                let Ending::Done(planes) = runner.run(file, seed, *backward)? else {
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
