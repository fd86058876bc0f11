//! The points of a sweep, each with its scene.

use crate::sweep::request::SweepRequest;
use crate::sweep::values::{Sweep, SweepPoint, message_at, points, shown};
use etendue_pipeline::load::{self, SceneSource};
use etendue_pipeline::{Reporter, Run, Summary, judged};
use etendue_predict::test_of;
use etendue_scene::{RunFile, Scene};
use etendue_store::framing::{joined, split};
use etendue_store::{ArgumentStyle, Failure, Method, SUMMARY, batches, theory};
use std::collections::BTreeMap;

/// The scene at each point of the requested sweep.
#[derive(Debug)]
pub struct SweepPoints {
    pub(crate) source: SceneSource,
    pub(crate) base: Scene,
    pub(crate) sweeps: Vec<Sweep>,
    pub(crate) method: Method,
    pub(crate) points: Vec<SweepPoint>,
    /// A scene for each point.
    pub(crate) scenes: Vec<Scene>,
    /// Whether batches of the points are kept, because the points have one seed.
    pub(crate) keeps_batches: bool,
}

impl SweepPoints {
    /// Reads the scene at all points.
    pub fn read(request: &SweepRequest) -> Result<Self, Failure> {
        let (source, sweeps) = request.settings();
        check(request, &source.set, &sweeps)?;
        let options = |run: &mut RunFile| {
            run.photons = request.photons.unwrap_or(run.photons);
            run.seed = request.seed.unwrap_or(run.seed);
        };
        let base = load::scene(&source, options)?;
        let points = points(&sweeps, request.together)?;
        let has_own_seed = !request.common_seed && sweeps.iter().all(|s| s.path != "run.seed");
        let at = |point| {
            let mut at = scene_at(&source, point, options)?;
            if has_own_seed {
                at.run.seed = seed_of(&at);
                at.file.run.seed = at.run.seed;
            }
            Ok(at)
        };
        let scenes = points.iter().map(at).collect::<Result<_, _>>()?;
        Ok(Self {
            source,
            base,
            sweeps,
            method: request.method,
            points,
            scenes,
            keeps_batches: request.common_seed,
        })
    }

    /// The name of the scene.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.base.name
    }

    /// The scene at each point.
    #[must_use]
    pub fn scenes(&self) -> &[Scene] {
        &self.scenes
    }

    /// The warnings about the scenes. Each warning is shown once, with the first point
    /// that it concerns.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut told: Vec<String> = Vec::new();
        let mut warnings = Vec::new();
        for (point, scene) in self.points.iter().zip(&self.scenes) {
            for warning in scene.warnings() {
                // Among warnings that differ only in their numbers, only the first is shown.
                let words: String = warning
                    .chars()
                    .filter(|c| !c.is_ascii_digit() && *c != '.')
                    .collect();
                if !told.contains(&words) {
                    warnings.push(format!("at {}: {warning}", shown(point)));
                    told.push(words);
                }
            }
        }
        warnings
    }

    /// The names of the files of a point beside its `summary.json`.
    pub(crate) fn names(&self, point: u32) -> Vec<String> {
        let scene = self
            .scenes
            .get(point as usize)
            .filter(|_| self.keeps_batches);
        scene.map_or(Vec::new(), |scene| {
            let batches = batches::names(&scene.planes).into_iter();
            batches.chain([theory::FILE.to_owned()]).collect()
        })
    }

    /// Runs a point; returns its files as bytes, for this or another process.
    pub fn run(&self, point: u32, reporter: &dyn Reporter) -> Result<Vec<u8>, Failure> {
        let scene = self.scenes.get(point as usize);
        let scene = scene.ok_or_else(|| Failure::cannot_run("no such point"))?;
        let case = Run::of(scene.clone(), self.method, Vec::new())?.measured_scene(reporter)?;
        let summary = Summary::new(&case, &judged(&case, &test_of(&case.scene))?, Vec::new());
        let mut files = vec![(SUMMARY.to_owned(), summary.json(&BTreeMap::new()))];
        if self.keeps_batches {
            let planes = &case.scene.planes;
            let each: Vec<_> = case.measurement.batches().collect();
            files.extend(batches::files(planes, &each)?);
            let predicted = theory::bytes(planes, &case.predictions)?;
            files.push((theory::FILE.to_owned(), predicted));
        }
        let lengths = files.iter().map(|(name, bytes)| (name, bytes.len()));
        let words: Vec<(&String, usize)> = lengths.collect();
        let bytes: Vec<&[u8]> = files.iter().map(|(_, bytes)| bytes.as_slice()).collect();
        Ok(joined(&words, &bytes.concat()))
    }
}

/// The names and the bytes of the files of a point, from the bytes that [`SweepPoints::run`] returns;
/// the first file is `summary.json`.
pub(crate) fn files(bytes: &[u8]) -> Result<Vec<(String, &[u8])>, Failure> {
    let (words, mut rest): (Vec<(String, usize)>, _) = split(bytes).map_err(Failure::cannot_run)?;
    let each = words.into_iter().map(|(name, length)| {
        let (own, others) = rest.split_at_checked(length)?;
        rest = others;
        Some((name, own))
    });
    let files: Option<Vec<_>> = each.collect();
    files.ok_or_else(|| Failure::cannot_run("a message between processes is damaged"))
}

/// The seed of a point. The seed is derived from the point's scene and the seed of the
/// sweep, and does not depend on the other points. The seed is so small that every reader of JSON
/// represents it exactly.
fn seed_of(scene: &Scene) -> u64 {
    let hash = blake3::hash(scene.hash().as_bytes());
    let mut words = hash.as_bytes().chunks_exact(8).map(|word| {
        let word: [u8; 8] = word.try_into().unwrap_or_default();
        u64::from_le_bytes(word)
    });
    words.next().unwrap_or(0) >> 24
}

/// Fails if no field is swept, or if values for one field are given twice.
fn check(
    request: &SweepRequest,
    set: &[(String, String)],
    sweeps: &[Sweep],
) -> Result<(), Failure> {
    if sweeps.is_empty() {
        let given: Vec<String> = set
            .iter()
            .map(|(path, value)| format!("{path}={value} is one value; "))
            .collect();
        let several = match request.scene.arguments {
            ArgumentStyle::Command => {
                "--set PATH=A..B:N or PATH=A,B,C gives a field several values, such as --set blockers.0.pitch=0.05..0.4:8"
            }
            ArgumentStyle::Python => {
                "give a field several values in the argument set, such as {'blockers.0.pitch': [0.05, 0.1]} or {'blockers.0.pitch': '0.05..0.4:8'}"
            }
        };
        let message = format!("nothing is swept: {}{several}", given.concat());
        return Err(Failure::bad_input(message));
    }
    let options = [
        ("run.photons", request.photons.is_some()),
        ("run.seed", request.seed.is_some()),
    ];
    let options = options
        .iter()
        .filter(|(_, given)| *given)
        .map(|(path, _)| *path);
    let fixed = set.iter().map(|(path, _)| path.as_str()).chain(options);
    let given = fixed.chain(sweeps.iter().map(|sweep| sweep.path.as_str()));
    match given_twice(given) {
        Some(path) => Err(Failure::bad_input(format!("{path} is given twice"))),
        None => Ok(()),
    }
}

/// A path that is given more than once.
pub(crate) fn given_twice<'a>(paths: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let mut paths: Vec<&str> = paths.collect();
    paths.sort_unstable();
    let twice = paths.windows(2).find(|pair| pair[0] == pair[1]);
    twice.map(|pair| pair[0])
}

/// The scene with some further fields set to numbers; `options` overrides fields at all
/// points.
pub fn scene_at(
    source: &SceneSource,
    point: &SweepPoint,
    options: impl FnOnce(&mut RunFile),
) -> Result<Scene, Failure> {
    let mut source = source.clone();
    let numbers = point.iter();
    let numbers = numbers.map(|(path, value)| (path.clone(), format!("{value:?}")));
    source.set.extend(numbers);
    load::scene(&source, options).map_err(|failure| Failure {
        message: message_at(point, failure.message),
        ..failure
    })
}
