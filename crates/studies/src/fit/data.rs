//! What a fit is fitted to: slices with their noise, from a result of Étendue or from a file.

use etendue_compare::{Prediction, Residuals};
use etendue_field::{Complex, Slices, VirtualPlane};
use etendue_pipeline::read_measurement;
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_store::{ArgumentStyle, Failure, MEASUREMENT, SUMMARY, theory};
use ndarray::Array3;
use serde_json::json;
use std::path::{Path, PathBuf};

/// The smallest number of replicates from which errors and p are computed.
const MIN_REPLICATES: usize = 16;

/// A measured plane.
#[derive(Clone, Debug)]
pub struct FitPlane {
    /// The plane of the scene.
    pub plane: VirtualPlane,
    /// Number of the plane in the scene.
    pub index: usize,
    /// The measured slices, [azimuth, ρ ≥ 0, ν].
    pub mean: Array3<Complex>,
    /// The variance of `mean`, with the same axes.
    pub variance: Array3<f64>,
    /// The independent parts whose mean is `mean`; empty if only the variance is known.
    pub batches: Vec<Slices>,
}

/// The measured planes of a scene.
#[derive(Clone, Debug)]
pub struct FitData {
    /// The planes.
    pub planes: Vec<FitPlane>,
    /// Number of photons, if it is known.
    pub photons: Option<u64>,
    /// The files that were read.
    pub inputs: Vec<PathBuf>,
}

impl FitData {
    /// Reads a measurement of the planes of a scene. `paths` are folders with batches, or a file of
    /// arrays.
    pub fn read(paths: &[PathBuf], scene: &Scene) -> Result<Self, Failure> {
        if let [path] = paths
            && path.is_file()
        {
            return Self::of_file(path, scene);
        }
        for path in paths {
            let holds = |index: &str| path.join(index).is_file();
            if !holds(MEASUREMENT) && !holds(SUMMARY) {
                return Err(Failure::bad_input(format!(
                    "{} is no measurement; allowed: a file of arrays, or a folder of `measure`, of `spectrum` or of `run --save batches`",
                    path.display()
                )));
            }
        }
        let (measurement, inputs) = read_measurement(paths)?;
        let data = Self::of_measurement(&measurement, scene)?;
        Ok(Self { inputs, ..data })
    }

    /// The planes of a measurement that the scene has too.
    pub fn of_measurement(measurement: &Measurement, scene: &Scene) -> Result<Self, Failure> {
        let pairs = paired(measurement.planes(), scene)?.into_iter();
        let planes = pairs.map(|(measured, index)| {
            let batches = measurement.at_plane(measured);
            let batches = batches.map(|batch| batch.slices.clone()).collect();
            FitPlane::of_batches(&scene.planes[index], index, batches)
        });
        Ok(Self {
            planes: planes.collect(),
            photons: Some(measurement.emitted()),
            inputs: Vec::new(),
        })
    }

    /// The arrays of another program: replicates, or slices with their errors.
    fn of_file(path: &Path, scene: &Scene) -> Result<Self, Failure> {
        let found = theory::measured(path, &scene.planes)?.into_iter();
        let planes = found.map(|found| {
            let index = found.plane;
            let plane = &scene.planes[index];
            let Prediction {
                slices, replicates, ..
            } = found.prediction;
            match (replicates.len(), found.sigma) {
                (0, Some(sigma)) if sigma.iter().any(|sigma| *sigma > 0.0) => Ok(FitPlane {
                    plane: plane.clone(),
                    index,
                    mean: slices.half,
                    variance: sigma.mapv(|sigma| sigma * sigma),
                    batches: Vec::new(),
                }),
                (MIN_REPLICATES.., _) => Ok(FitPlane::of_batches(plane, index, replicates)),
                (count, _) => Err(Failure::bad_input(format!(
                    "{}: {} has {count} replicates, and no sigma above 0; allowed: at least {MIN_REPLICATES} replicates, or sigma",
                    path.display(),
                    plane.name,
                ))),
            }
        });
        Ok(Self {
            planes: planes.collect::<Result<_, _>>()?,
            photons: None,
            inputs: vec![path.to_owned()],
        })
    }

    /// The planes of these names, or all planes if there are no names, that photons of each batch
    /// reach: the spread of a plane with dark batches tells no error.
    pub fn at(mut self, names: &[String], arguments: ArgumentStyle) -> Result<Self, Failure> {
        let own: Vec<String> = self.planes.iter().map(|of| of.plane.name.clone()).collect();
        if let Some(unknown) = names.iter().find(|name| !own.contains(name)) {
            return Err(Failure::bad_input(format!(
                "{}: not measured; allowed: {}",
                arguments.with_one("plane", unknown),
                own.join(", ")
            )));
        }
        self.planes.retain(|of| {
            let is_named = names.is_empty() || names.contains(&of.plane.name);
            is_named && !of.batches.iter().any(Slices::is_dark)
        });
        match self.planes.is_empty() {
            true => Err(Failure::bad_input(
                "each plane has batches without photons: more photons are needed",
            )),
            false => Ok(self),
        }
    }
}

impl FitPlane {
    fn of_batches(plane: &VirtualPlane, index: usize, batches: Vec<Slices>) -> Self {
        let halves = batches.iter().map(|batch| batch.half.clone()).collect();
        let residuals = Residuals::of(plane.grid, halves);
        Self {
            plane: plane.clone(),
            index,
            mean: residuals.mean(),
            variance: residuals.variance(),
            batches,
        }
    }
}

/// The numbers of measured planes, and of the planes of the scene to which they belong: those of
/// the same name, or the only one of each.
fn paired(measured: &[VirtualPlane], scene: &Scene) -> Result<Vec<(usize, usize)>, Failure> {
    let is_single = measured.len() == 1 && scene.planes.len() == 1;
    let named = |plane: &VirtualPlane| scene.plane_named(&plane.name).or(is_single.then_some(0));
    let pairs = measured.iter().enumerate();
    let pairs = pairs.filter_map(|(i, plane)| Some((i, named(plane)?)));
    let pairs: Vec<_> = pairs.collect();
    if pairs.is_empty() {
        let names = |planes: &[VirtualPlane]| {
            let names: Vec<&str> = planes.iter().map(|plane| plane.name.as_str()).collect();
            names.join(", ")
        };
        return Err(Failure::bad_input(format!(
            "no plane of the scene was measured: the scene has {}, and the measurement {}",
            names(&scene.planes),
            names(measured)
        )));
    }
    for (i, index) in &pairs {
        let (measured, own) = (&measured[*i], &scene.planes[*index]);
        if measured.grid != own.grid || measured.window != own.window {
            let text = |of: &VirtualPlane| json!({"window": of.window, "frequencies": of.grid});
            return Err(Failure::bad_input(format!(
                "plane {}: the measurement has another window, or other frequencies, than the scene: {}, not {}",
                own.name,
                text(measured),
                text(own)
            )));
        }
    }
    Ok(pairs)
}
