//! Reads a measurement, in one or several parts, and a prediction from their folders.

use crate::measure::MeasuredScene;
use etendue_predict::Applicability;
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_store::batches::{self, Held};
use etendue_store::stored::{Index, Stored};
use etendue_store::{Failure, MEASUREMENT, PREDICTION, SUMMARY, predictions, theory};
use serde_json::json;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The minimum number of batches. Errors are computed from batches; a scene has the same minimum.
const LEAST_BATCHES: usize = 32;

/// Where predictions come from.
#[derive(Clone, Copy, Debug)]
pub enum PredictionSource<'a> {
    /// A folder written by `etendue predict`.
    Folder(&'a Path),
    /// A file of a program of the user ([`theory`]).
    File(&'a Path),
}

/// Reads the measurement and the predictions, and checks that they belong to the same scene.
/// Returns the scene, its measurement and its predictions, and the paths of all files that were
/// read.
pub fn read_case(
    measured: &[PathBuf],
    predicted: PredictionSource<'_>,
) -> Result<(MeasuredScene, Vec<PathBuf>), Failure> {
    let shards = shards(measured)?;
    let first = &shards[0];
    let scene = first.scene()?;
    let method = first.index.content.method;
    let mut inputs: Vec<PathBuf> = shards.iter().flat_map(Stored::paths).collect();
    let theories = Applicability::of_planes(&scene);
    let predictions = match predicted {
        PredictionSource::Folder(folder) => {
            let predicted = Stored::read(folder, PREDICTION)?;
            first.check_scene(&predicted, false)?;
            predicted.check_inputs()?;
            inputs.extend(predicted.paths());
            let classes: Vec<_> = theories.iter().map(Applicability::class).collect();
            predictions::read(&predicted, &scene, &classes, method)?
        }
        PredictionSource::File(file) => {
            inputs.push(file.to_owned());
            theory::read(file, &scene.planes)?
        }
    };
    let measurement = merged(&shards, &scene)?;
    let case = MeasuredScene {
        method,
        predictions,
        theories,
        measurement,
        scene,
    };
    Ok((case, inputs))
}

/// Reads a measurement, which may be in several parts. Returns the measurement and the paths of all
/// files that were read.
pub fn read_measurement(measured: &[PathBuf]) -> Result<(Measurement, Vec<PathBuf>), Failure> {
    let shards = shards(measured)?;
    let measurement = merged(&shards, &shards[0].scene()?)?;
    Ok((measurement, shards.iter().flat_map(Stored::paths).collect()))
}

/// The batches of a part of a measurement of `scene`, or of a run that has saved them.
pub fn stored_batches(folder: &Path, scene: &Scene) -> Result<Measurement, Failure> {
    let part = shard(folder)?;
    if !part.is_of(scene) {
        return Err(part.fault("the measurement is one of another scene"));
    }
    batches_of(&part, scene)
}

/// A part of a measurement, or a run that has saved its batches.
fn shard(folder: &Path) -> Result<Stored<Held>, Failure> {
    if folder.join(MEASUREMENT).is_file() || !folder.join(SUMMARY).is_file() {
        return Stored::read(folder, MEASUREMENT);
    }
    let run = Stored::read(folder, SUMMARY)?;
    match run.lists(batches::LEDGER) {
        true => Ok(run),
        false => Err(run.fault("the run has no batches; allowed: a run with --save batches")),
    }
}

/// The parts of a measurement, which belong to one experiment.
fn shards(measured: &[PathBuf]) -> Result<Vec<Stored<Held>>, Failure> {
    let shards = measured
        .iter()
        .map(|folder| shard(folder))
        .collect::<Result<Vec<Stored<Held>>, _>>()?;
    let first = &shards[0];
    let experiment = |index: &Index<Held>| {
        let Index { scene, content, .. } = index;
        json!({"scene": scene, "method": content.method})
    };
    for shard in &shards[1..] {
        // Batches of different experiments are not replicates of each other.
        first.check_scene(shard, true)?;
        first.check_same(shard, &experiment(&first.index), &experiment(&shard.index))?;
    }
    shards[1..].iter().try_for_each(Stored::check_inputs)?;
    Ok(shards)
}

fn merged(shards: &[Stored<Held>], scene: &Scene) -> Result<Measurement, Failure> {
    let mut all = Measurement::new(scene.planes.clone());
    for shard in shards {
        all = all.merge(batches_of(shard, scene)?).map_err(|e| {
            Failure::bad_input(format!("cannot add {}: {e}", shard.folder.display()))
        })?;
    }
    let held = all.batches().len();
    if held < LEAST_BATCHES {
        let missing = missing(&all, scene.run.batches);
        return Err(Failure::bad_input(format!(
            "{held} batches are too few: at least {LEAST_BATCHES} are needed; not measured: {missing}"
        )));
    }
    Ok(all)
}

fn batches_of(part: &Stored<Held>, scene: &Scene) -> Result<Measurement, Failure> {
    let Range { start, end } = part.index.content.batches;
    if start >= end || end > scene.run.batches {
        let all = scene.run.batches;
        return Err(part.fault(format!("batches {start}..{end}; allowed: within 0..{all}")));
    }
    batches::read(part, &scene.planes)
}

/// The numbers of the missing batches, written as ranges.
fn missing(measurement: &Measurement, all: u32) -> String {
    let mut ranges: Vec<Range<u32>> = Vec::new();
    for batch in (0..all).filter(|batch| !measurement.contains(*batch)) {
        match ranges.last_mut() {
            Some(range) if range.end == batch => range.end += 1,
            _ => ranges.push(batch..batch + 1),
        }
    }
    let ranges: Vec<String> = ranges.iter().map(|r| format!("{r:?}")).collect();
    ranges.join(", ")
}
