//! Étendue inside another program: a scene measured, predicted and compared in memory, as `etendue run` does it.

use crate::case::Case;
use crate::conclude::{Ending, Judged, plan, written};
use crate::crew::{Packed, Piece};
use crate::method::{self, source};
use crate::predict::predicted;
use crate::summary::Stopwatch;
use crate::{limits, load};
use etendue_compare::{Applicability, PlaneComparison, Prediction, Verdict};
use etendue_field::PhotonSource;
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_spectrum::{Batch, Measurement, PartialBatch, Watch, measure_watched};
use etendue_store::Failure;
use etendue_store::Method;
use etendue_store::batches::Held;
use etendue_store::kept;
use etendue_store::machine;
use etendue_store::predictions;
use etendue_store::stored::check_earlier;
use etendue_store::{Results, SUMMARY};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What is asked for beside a scene file, as on the command line.
#[derive(Clone, Debug)]
pub struct Options {
    /// Fields set to values, each as by [`SceneFile::with`].
    pub set: Vec<(String, String)>,
    /// Photons, instead of the scene's.
    pub photons: Option<u64>,
    /// Seed of the photons, instead of the scene's.
    pub seed: Option<u64>,
    /// How light is measured.
    pub method: Method,
}

/// A scene, and how it is measured.
#[derive(Clone, Debug)]
pub struct Job {
    scene: Scene,
    theories: Vec<Applicability>,
    method: Method,
    inputs: Vec<PathBuf>,
}

impl Job {
    /// The scene in a file.
    ///
    /// # Errors
    /// When it cannot be read, or is no sound scene: all its faults, with their lines.
    pub fn read(path: &Path, options: &Options) -> Result<Self, Failure> {
        let args = crate::args::SceneArgs {
            path: path.to_owned(),
            set: options.set.clone(),
        };
        let scene = load::scene(&args, |run| {
            run.photons = options.photons.unwrap_or(run.photons);
            run.seed = options.seed.unwrap_or(run.seed);
        })?;
        let inputs = load::inputs(&args, &scene);
        Self::of(scene, options.method, inputs)
    }

    /// The scene that a text describes, in RON or JSON; its meshes and pictures are in `folder`.
    ///
    /// # Errors
    /// When it is no sound scene: all its faults.
    pub fn parse(
        text: &str,
        name: &str,
        folder: &Path,
        options: &Options,
    ) -> Result<Self, Failure> {
        let refused = |e| Failure::bad_input(format!("{name}: {e}"));
        let file = SceneFile::parse(text).map_err(refused)?;
        let mut file = file.with_all(&options.set).map_err(refused)?;
        file.run.photons = options.photons.unwrap_or(file.run.photons);
        file.run.seed = options.seed.unwrap_or(file.run.seed);
        let set = load::named(&options.set);
        let scene = resolve(name, file, folder, machine::available_memory());
        let scene = scene.map_err(|error| load::refused(&error, name, "", &set))?;
        let inputs = scene.inputs.keys().map(|name| folder.join(name)).collect();
        Self::of(scene, options.method, inputs)
    }

    pub(crate) fn of(scene: Scene, method: Method, inputs: Vec<PathBuf>) -> Result<Self, Failure> {
        method::check(&scene, method)?;
        Ok(Self {
            theories: Applicability::of_planes(&scene),
            scene,
            method,
            inputs,
        })
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Which theory applies to each plane.
    #[must_use]
    pub fn theories(&self) -> &[Applicability] {
        &self.theories
    }

    /// What emits its photons.
    ///
    /// # Errors
    /// When the method finds no light.
    pub fn source(&self) -> Result<Box<dyn PhotonSource>, Failure> {
        source(&self.scene, self.method)
    }

    /// A batch as bytes, for another process.
    ///
    /// # Errors
    /// When there is no memory for them.
    pub fn packed(&self, batch: &Batch) -> Result<Vec<u8>, Failure> {
        kept::packed(&self.scene.planes, batch)
    }

    /// The batch of that number in bytes of [`Self::packed`], as `source` would have emitted it.
    ///
    /// # Errors
    /// When they are not of this scene, seed and number of photons.
    pub fn unpacked(
        &self,
        source: &dyn PhotonSource,
        number: u32,
        bytes: &[u8],
    ) -> Result<Batch, Failure> {
        let held = Held {
            seed: self.scene.run.seed,
            method: self.method,
            photons: source.emitted(number),
            batches: number..number.saturating_add(1),
        };
        kept::unpacked(bytes, &held, &self.scene.planes)
    }

    /// The first parts of a batch as bytes, for another process.
    pub(crate) fn packed_partial(&self, batch: &PartialBatch) -> Result<Packed, Failure> {
        let bytes = batch
            .sum
            .as_ref()
            .map_or(Ok(Vec::new()), |sum| self.packed(sum))?;
        let piece = Piece {
            number: batch.index,
            parts: Some(batch.parts),
            length: bytes.len(),
        };
        Ok((piece, bytes))
    }

    /// The first parts of a batch, from bytes of [`Self::packed_partial`].
    pub(crate) fn unpacked_partial(
        &self,
        source: &dyn PhotonSource,
        piece: &Piece,
        bytes: &[u8],
    ) -> Result<PartialBatch, Failure> {
        let index = piece.number;
        let Some(parts) = piece.parts.filter(|parts| *parts > 0) else {
            return Ok(PartialBatch::new(index));
        };
        let sum = Some(self.unpacked(source, index, bytes)?);
        Ok(PartialBatch { index, parts, sum })
    }

    /// The prediction of a plane that theory predicts, as bytes for another process.
    pub(crate) fn packed_prediction(&self, plane: u32) -> Result<Vec<u8>, Failure> {
        let number = plane as usize;
        let found = self.scene.planes.get(number).zip(self.theories.get(number));
        let (plane, theory) = found.ok_or_else(|| Failure::cannot_run("no such plane"))?;
        let prediction = Prediction::new(&self.scene, plane, theory);
        predictions::packed(plane, &prediction)
    }

    /// Fails where a run would not end, or not fit into this machine.
    ///
    /// # Errors
    /// In these two cases.
    pub fn check_limits(&self) -> Result<(), Failure> {
        limits::check(&self.scene, &self.theories, rayon::current_num_threads())
    }

    /// Measures some batches, on the threads of the current pool.
    ///
    /// # Errors
    /// When the method finds no light.
    pub fn measure(&self, batches: &[u32], watch: &dyn Watch) -> Result<Measurement, Failure> {
        let source = source(&self.scene, self.method)?;
        let mut batches = batches.iter().copied().map(PartialBatch::new);
        Ok(measure_watched(&*source, &self.scene.planes, &mut batches, watch).0)
    }

    /// Predicts all planes, on the threads of the current pool.
    ///
    /// # Errors
    /// Where another method stands in for theory, and finds no light.
    pub fn predict(&self) -> Result<Vec<Prediction>, Failure> {
        predicted(&self.scene, &self.theories, self.method, None, true)
    }

    /// Compares what was measured with what was predicted.
    ///
    /// # Errors
    /// When the measurement has too few batches for errors.
    pub fn compare(
        &self,
        measurement: Measurement,
        predictions: Vec<Prediction>,
    ) -> Result<Outcome, Failure> {
        let case = Case {
            scene: self.scene.clone(),
            theories: self.theories.clone(),
            method: self.method,
            measurement,
            predictions,
        };
        let judged = Judged::of(&case, None, true)?;
        Ok(Outcome {
            case,
            judged,
            inputs: self.inputs.clone(),
        })
    }
}

/// A scene whose planes are measured, predicted and compared.
#[derive(Debug)]
pub struct Outcome {
    case: Case,
    judged: Judged,
    inputs: Vec<PathBuf>,
}

impl Outcome {
    /// The planes, in the order of the scene.
    #[must_use]
    pub fn planes(&self) -> &[PlaneComparison] {
        &self.judged.planes
    }

    /// The verdict on all of them.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        self.judged.summary.verdict
    }

    /// What was held against the planes.
    #[must_use]
    pub fn predictions(&self) -> &[Prediction] {
        &self.case.predictions
    }

    /// `summary.json`, without hashes of files.
    #[must_use]
    pub fn summary(&self) -> Vec<u8> {
        self.judged.summary.json(&BTreeMap::new())
    }

    /// The table that `etendue run` prints.
    #[must_use]
    pub fn table(&self) -> String {
        crate::table::text(&self.judged.summary)
    }

    /// Writes what `etendue run` writes; returns the folder.
    ///
    /// # Errors
    /// When the folder holds another scene's result and `force` is not set, or cannot be written.
    pub fn save(&self, folder: &Path, force: bool) -> Result<PathBuf, Failure> {
        let scene = &self.case.scene;
        check_earlier(folder, SUMMARY, scene, force)?;
        let plan = plan(scene, &[], self.inputs.clone(), force);
        let results = Results::claim(folder, plan)?;
        let ending = Ending {
            save: &[],
            expect: None,
            compact: false,
            quiet: true,
        };
        let finished = written(
            &self.case,
            &ending,
            results,
            &self.judged,
            Stopwatch::start(),
        )?;
        Ok(finished.folder)
    }
}
