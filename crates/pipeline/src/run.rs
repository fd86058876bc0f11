//! Étendue as a library: measures, predicts and compares a scene in memory, as `etendue run` does.

use crate::checkpoint::{self, Checkpointing};
use crate::judge::Judge;
use crate::judged::Judged;
use crate::load::SceneSource;
use crate::measure::{MeasuredScene, measured};
use crate::method::{self, source};
use crate::reporter::{Reporter, Silent, Work};
use crate::workers::{Leader, Packing, Task};
use crate::{limits, load, target};
use etendue_compare::{Class, Prediction};
use etendue_predict::{Applicability, predict, predict_reference};
use etendue_scene::{RunFile, Scene};
use etendue_spectrum::{Measurement, PartialBatch, Watch, measure_watched};
use etendue_store::{Failure, Method, predictions};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::slice;

/// A scene, and how to measure it.
#[derive(Clone, Debug)]
pub struct Run {
    /// The scene.
    pub scene: Scene,
    /// The theory that applies to each plane.
    pub theories: Vec<Applicability>,
    /// The method of measurement.
    pub method: Method,
    /// The files from which the scene was read.
    pub inputs: Vec<PathBuf>,
}

/// How the photons of a run are traced.
#[derive(Clone, Copy, Debug)]
pub enum Tracing<'a> {
    /// Batches are stored in the result folder, so that a later process can continue the run.
    Stored(Checkpointing<'a>),
    /// Photons are added until the noise at each plane is low enough.
    Until {
        /// The largest allowed noise, as a share of the spectrum.
        noise: f64,
        /// The largest allowed number of photons; `None` for the default.
        most: Option<u64>,
    },
}

impl Run {
    /// Reads a scene; `options` applies the settings that have their own arguments.
    ///
    /// # Errors
    /// When the scene cannot be read or is not valid; the error lists all faults with their line
    /// numbers.
    pub fn read(
        source: &SceneSource,
        method: Method,
        options: impl FnOnce(&mut RunFile),
    ) -> Result<Self, Failure> {
        let scene = load::scene(source, options)?;
        let inputs = load::inputs(source, &scene);
        Self::of(scene, method, inputs)
    }

    /// The run of a resolved scene; `inputs` are the files from which the scene was read.
    pub fn of(scene: Scene, method: Method, inputs: Vec<PathBuf>) -> Result<Self, Failure> {
        method::check(&scene, method)?;
        Ok(Self {
            theories: Applicability::of_planes(&scene),
            scene,
            method,
            inputs,
        })
    }

    /// The scene with its measurement and predictions.
    #[must_use]
    pub fn with(self, measurement: Measurement, predictions: Vec<Prediction>) -> MeasuredScene {
        MeasuredScene {
            scene: self.scene,
            theories: self.theories,
            method: self.method,
            measurement,
            predictions,
        }
    }

    /// Traces the photons of all batches. Returns `None` if another process that shares the work
    /// has written the result.
    ///
    /// # Errors
    /// When the method of measurement finds no light, when time is up, or when too many photons
    /// would be needed.
    pub fn trace(
        &mut self,
        tracing: Tracing<'_>,
        reporter: &dyn Reporter,
    ) -> Result<Option<Measurement>, Failure> {
        match tracing {
            Tracing::Stored(how) => checkpoint::measured(&self.scene, self.method, how, reporter),
            Tracing::Until { noise, most } => {
                target::reached(&mut self.scene, self.method, (noise, most), reporter).map(Some)
            }
        }
    }

    /// The scene with its measurement and predictions. No batches are stored.
    ///
    /// # Errors
    /// When the method of measurement finds no light.
    pub fn measured_scene(self, reporter: &dyn Reporter) -> Result<MeasuredScene, Failure> {
        let all = 0..self.scene.run.batches;
        let measurement = measured(&self.scene, self.method, all, reporter)?;
        let (measurement, predictions) = self.predicted(measurement, None, reporter)?;
        Ok(self.with(measurement, predictions))
    }

    /// The format in which batches are sent to another process.
    #[must_use]
    pub fn packing(&self) -> Packing<'_> {
        Packing {
            scene: &self.scene,
            method: self.method,
        }
    }

    /// The prediction of a plane to which a theory applies, as bytes for another process.
    pub fn packed_prediction(&self, plane: u32) -> Result<Vec<u8>, Failure> {
        let number = plane as usize;
        let found = self.scene.planes.get(number).zip(self.theories.get(number));
        let (plane, theory) = found.ok_or_else(|| Failure::cannot_run("no such plane"))?;
        let prediction = predict(&self.scene, plane, theory);
        predictions::packed(plane, &prediction)
    }

    /// Fails if a run would take too long, or would not fit into the memory of this machine.
    pub fn check_limits(&self) -> Result<(), Failure> {
        if let Some(other) = self.other()? {
            other.check_limits()?;
        }
        limits::check(&self.scene, &self.theories, rayon::current_num_threads())
    }

    /// Fails if the measurement would not fit into the memory of this machine.
    pub fn check_memory(&self) -> Result<(), Failure> {
        limits::check_memory(&self.scene, &self.theories, rayon::current_num_threads())
    }

    /// Measures some batches, on the threads of the current pool.
    ///
    /// # Errors
    /// When the method of measurement finds no light.
    pub fn measure(&self, batches: &[u32], watch: &dyn Watch) -> Result<Measurement, Failure> {
        let source = source(&self.scene, self.method)?;
        let mut batches = batches.iter().copied().map(PartialBatch::new);
        Ok(measure_watched(&*source, &self.scene.planes, &mut batches, watch).0)
    }

    /// Predicts all planes, on the threads of the current pool and by other processes, if there
    /// are any. If no theory applies to a plane, a measurement by another method replaces the
    /// prediction.
    ///
    /// # Errors
    /// When another method of measurement replaces theory at a plane, and finds no light.
    pub fn predictions(
        &self,
        workers: Option<&Leader<'_>>,
        reporter: &dyn Reporter,
    ) -> Result<Vec<Prediction>, Failure> {
        let (scene, theories) = (&self.scene, &self.theories);
        let is_referred = |i: &u32| theories[*i as usize].class() == Class::Reference;
        let (referred, told): (Vec<u32>, Vec<u32>) =
            (0..).zip(theories).map(|(i, _)| i).partition(is_referred);
        let referred: Vec<usize> = referred.into_iter().map(|i| i as usize).collect();
        // One measurement by the other method serves all planes without theory.
        let judges = Judge::all(scene, &referred, self.method, reporter)?;
        let bar = reporter.begin(Work::Steps {
            verb: "predicting",
            total: scene.planes.len(),
            things: "planes",
        });
        let own = |plane: u32| {
            let at = &scene.planes[plane as usize];
            bar.name(&at.name);
            let prediction = predict(scene, at, &theories[plane as usize]);
            bar.advance(1);
            Ok(prediction)
        };
        let mut told: BTreeMap<u32, Prediction> = match workers {
            None => told
                .iter()
                .map(|i| Ok((*i, own(*i)?)))
                .collect::<Result<_, Failure>>()?,
            Some(workers) => workers.pieces(
                Task::Planes,
                slice::from_ref(scene),
                &told,
                &own,
                &|plane, bytes| {
                    bar.advance(1);
                    predictions::unpacked(&scene.planes[plane as usize], bytes)
                },
            )?,
        };
        (0_u32..)
            .zip(theories)
            .map(|(number, theory)| {
                let i = number as usize;
                let Some((judge, at)) = Judge::of(&judges, i) else {
                    let missing = || Failure::cannot_run("a plane was not predicted");
                    return told.remove(&number).ok_or_else(missing);
                };
                bar.advance(1);
                let mut prediction = predict_reference(scene, i, theory, &judge.measurement, at)
                    .map_err(Failure::cannot_run)?;
                prediction.steps.push(method::step(judge.method));
                Ok(prediction)
            })
            .collect()
    }

    /// Compares the measurement with the predictions.
    ///
    /// # Errors
    /// When the measurement has too few batches to estimate errors.
    pub fn compare(
        &self,
        measurement: Measurement,
        predictions: Vec<Prediction>,
    ) -> Result<Outcome, Failure> {
        let case = self.clone().with(measurement, predictions);
        let judged = Judged::of(&case, None, &Silent)?;
        Ok(Outcome {
            case,
            judged,
            inputs: self.inputs.clone(),
        })
    }
}

/// A scene whose planes have been measured, predicted and compared.
#[derive(Debug)]
pub struct Outcome {
    /// The scene with its measurement and predictions.
    pub case: MeasuredScene,
    /// The comparisons of the planes, in the order of the scene, and their summary.
    pub judged: Judged,
    /// The files from which the scene was read.
    pub inputs: Vec<PathBuf>,
}
