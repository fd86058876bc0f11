//! Scenes, with their measurements and predictions.

use crate::arrays::Arrays;
use crate::live::alive;
use crate::outcome::{Measurement, Outcome, Prediction};
use crate::raised::raised;
use crate::rays::{Rays, spectrum};
use crate::scene::SceneArgument;
use etendue_field::{Complex, Crossing, VirtualPlane};
use etendue_pipeline::method::source;
use etendue_pipeline::{Silent, stored_batches};
use etendue_spectrum::Watch;
use etendue_store::{Failure, Method, predictions, theory};
use etendue_theory::{ChainAction, ChainStep};
use ndarray::{Array1, Array2};
use numpy::{PyArray1, PyArray2, PyArray4, PyReadonlyArray1};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A map of rays as its matrix, its offset, and the factor by which it multiplies radiance.
type RayMap = ([[f64; 4]; 4], [f64; 4], f64);

/// A scene with its measurement settings.
#[pyclass(frozen, module = "etendue._etendue")]
pub(crate) struct Run(pub(crate) Arc<etendue_pipeline::Run>);

#[pymethods]
impl Run {
    /// Returns the scene of a file or of a text, with some fields set.
    #[staticmethod]
    fn read(
        py: Python<'_>,
        scene: SceneArgument,
        set: Vec<(String, String)>,
        photons: Option<u64>,
        seed: Option<u64>,
        method: &str,
    ) -> PyResult<Self> {
        let source = scene.source(&set)?;
        let traced = if method == Method::Backward.name() {
            Method::Backward
        } else {
            Method::Photons
        };
        let run = etendue_pipeline::Run::read(&source, traced, |run| {
            run.photons = photons.unwrap_or(run.photons);
            run.seed = seed.unwrap_or(run.seed);
        });
        let mut run = run.map_err(|failure| raised(py, failure))?;
        if method == Method::Given.name() {
            // The rays come from Python, and not from the light of this scene.
            run.method = Method::Given;
        }
        Ok(Self(Arc::new(run)))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.0.scene.name
    }

    /// Returns the scene file in JSON, including defaults and overrides.
    fn json(&self) -> String {
        serde_json::to_string(&self.0.scene.file).unwrap_or_default()
    }

    #[getter]
    fn photons(&self) -> u64 {
        self.0.scene.run.photons
    }

    #[getter]
    fn batches(&self) -> u32 {
        self.0.scene.run.batches
    }

    fn warnings(&self) -> Vec<String> {
        self.0.scene.warnings()
    }

    /// Describes each plane: returns its name, its class, the steps of its chain, and the parts of
    /// the scene that no theory describes.
    fn planes(&self) -> Vec<(String, String, Vec<String>, Vec<String>)> {
        let scene = &self.0.scene;
        let planes = scene.planes.iter().zip(&self.0.theories);
        let planes = planes.map(|(plane, theory)| {
            let class = theory.class().to_string();
            let steps = theory.steps(scene, plane);
            (plane.name.clone(), class, steps, theory.reasons.clone())
        });
        planes.collect()
    }

    /// The steps of the chain to a plane after its light, with their words and, for a map of rays
    /// z' = A z + t, A, t, and the factor of radiance; `None` if the plane has no such chain.
    fn chain(&self, plane: usize) -> Option<Vec<(String, &'static str, Option<RayMap>)>> {
        let steps = self.chain_steps(plane)?.into_iter();
        let steps = steps.map(|step| {
            let kind = match &step.action {
                ChainAction::Map(_) => "map",
                ChainAction::Mask(_) => "mask",
                ChainAction::SlopeCosine => "slopes",
                ChainAction::AngleCosine => "angles",
                ChainAction::Other => "other",
            };
            let map = step.map().map(|map| {
                let rays = map.rays();
                (rays.matrix, rays.offset, map.factor / rays.det().abs())
            });
            (step.words, kind, map)
        });
        Some(steps.collect())
    }

    /// The transmittance of the mask at a step of a chain, at positions on the mask.
    fn transmittance<'py>(
        &self,
        py: Python<'py>,
        plane: usize,
        step: usize,
        x: PyReadonlyArray1<'py, f64>,
        y: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let steps = self.chain_steps(plane).unwrap_or_default();
        let Some(ChainAction::Mask(mask)) = steps.get(step).map(|step| &step.action) else {
            return Err(PyIndexError::new_err("no such mask"));
        };
        let at = x.as_array().into_iter().zip(y.as_array());
        let values = at.map(|(x, y)| mask.transmittance(*x, *y));
        Ok(PyArray1::from_iter(py, values))
    }

    fn measure(
        &self,
        py: Python<'_>,
        batches: Vec<u32>,
        threads: Option<usize>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Measurement> {
        let run = Arc::clone(&self.0);
        let found = alive(py, threads, progress.as_ref(), move |live| {
            run.check_limits()?;
            let settings = &run.scene.run;
            let photons = settings.photons * batches.len() as u64 / u64::from(settings.batches);
            run.measure(&batches, &live.trace(photons, "photons"))
        });
        found.map(Measurement)
    }

    /// The batches in a folder of a measurement of this scene.
    fn stored(&self, py: Python<'_>, folder: PathBuf) -> PyResult<Measurement> {
        let found = py.detach(|| stored_batches(&folder, &self.0.scene));
        found
            .map(Measurement)
            .map_err(|failure| raised(py, failure))
    }

    fn predict(&self, py: Python<'_>, threads: Option<usize>) -> PyResult<Prediction> {
        let run = Arc::clone(&self.0);
        let found = alive(py, threads, None, move |_| {
            run.check_limits()?;
            run.predictions(None, &Silent)
        });
        found.map(Prediction)
    }

    /// Returns the predictions in the bytes of an NPZ file.
    fn theory(&self, py: Python<'_>, bytes: Vec<u8>) -> PyResult<Prediction> {
        let found = theory::parse(Path::new("theory"), bytes, &self.0.scene.planes);
        found.map(Prediction).map_err(|failure| raised(py, failure))
    }

    fn compare(
        &self,
        py: Python<'_>,
        measurement: &Measurement,
        prediction: &Prediction,
        threads: Option<usize>,
    ) -> PyResult<Outcome> {
        let run = Arc::clone(&self.0);
        let (measurement, predictions) = (measurement.0.clone(), prediction.0.clone());
        let found = alive(py, threads, None, move |_| {
            run.compare(measurement, predictions)
        });
        found.map(Outcome)
    }

    /// Returns the photons at a plane, with the columns x, y, u, v and weight, in the order of
    /// their batches. Also returns, for each batch, the number of these photons and the number of
    /// emitted photons.
    #[expect(clippy::type_complexity, reason = "Python receives a tuple")]
    fn crossings<'py>(
        &self,
        py: Python<'py>,
        batches: Vec<u32>,
        plane: usize,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Vec<usize>, Vec<u64>)> {
        let run = Arc::clone(&self.0);
        let (rows, counts, emitted) = alive(py, None, None, move |live| {
            let source = source(&run.scene, run.method)?;
            let photons = batches.iter().map(|batch| source.emitted(*batch)).sum();
            let watch = live.trace(photons, "photons");
            let mut rows = Vec::new();
            let mut counts = Vec::new();
            for batch in &batches {
                let before = rows.len();
                let mut record = |at: usize, crossings: &[Crossing]| {
                    for Crossing { ray, weight } in crossings.iter().filter(|_| at == plane) {
                        rows.push([ray.x, ray.y, ray.u, ray.v, *weight]);
                    }
                };
                source.emit(*batch, &mut record, &|photons| watch.traced(photons));
                counts.push(rows.len() - before);
            }
            let emitted: Vec<u64> = batches.iter().map(|batch| source.emitted(*batch)).collect();
            Ok((Array2::from(rows), counts, emitted))
        })?;
        Ok((PyArray2::from_owned_array(py, rows), counts, emitted))
    }

    /// Computes the spectrum of a user's rays, with the window and the frequencies of the first
    /// plane. `batch` holds the batch number of each ray.
    fn spectrum<'py>(
        &self,
        py: Python<'py>,
        columns: [PyReadonlyArray1<'py, f64>; 5],
        batch: PyReadonlyArray1<'py, u32>,
        batches: u32,
        threads: Option<usize>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let rays = Rays::new(&columns, &batch, batches)?;
        let run = Arc::clone(&self.0);
        let found = alive(py, threads, progress.as_ref(), move |live| {
            spectrum(&rays, &run.scene.planes[0], live)
        })?;
        found.arrays(py)
    }

    /// The axes of a plane's slices, with ρ ≥ 0, and its window in JSON.
    fn axes<'py>(&self, py: Python<'py>, plane: usize) -> PyResult<Bound<'py, PyDict>> {
        let VirtualPlane { grid, window, .. } = &self.0.scene.planes[plane];
        let azimuth = (0..grid.azimuths).map(|k| grid.azimuth(k)).collect();
        let rho = grid.rho.values().split_off(grid.rho.half);
        let axes = Arrays::new(py)
            .add::<f64, _>("azimuth", azimuth)?
            .add("rho", Array1::from(rho))?
            .add("nu", Array1::from(grid.nu.values()))?
            .finish();
        let window = serde_json::to_string(window).unwrap_or_default();
        axes.set_item("window", window)?;
        Ok(axes)
    }

    /// Sums over a user's rays at a plane, for each batch, [batch, azimuth, ρ ≥ 0, ν].
    fn sums<'py>(
        &self,
        py: Python<'py>,
        plane: usize,
        columns: [PyReadonlyArray1<'py, f64>; 5],
        batch: PyReadonlyArray1<'py, u32>,
        batches: u32,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArray4<Complex>>> {
        let rays = Rays::new(&columns, &batch, batches)?;
        let run = Arc::clone(&self.0);
        let sums = alive(py, threads, None, move |live| {
            Ok(rays.sums(&run.scene.planes[plane], live))
        })?;
        Ok(PyArray4::from_owned_array(py, sums))
    }

    /// Returns the batches of a measurement as their numbers and their bytes.
    fn packed<'py>(
        &self,
        py: Python<'py>,
        measurement: &Measurement,
    ) -> PyResult<Vec<(u32, Bound<'py, PyBytes>)>> {
        let batches = measurement.0.batches();
        let packed = batches.map(|batch| {
            let bytes = self.0.packing().packed(batch).map_err(|f| raised(py, f))?;
            Ok((batch.index, PyBytes::new(py, &bytes)))
        });
        packed.collect()
    }

    fn unpacked(
        &self,
        py: Python<'_>,
        batches: Vec<(u32, Bound<'_, PyBytes>)>,
    ) -> PyResult<Measurement> {
        let source = source(&self.0.scene, self.0.method).map_err(|f| raised(py, f))?;
        let packing = self.0.packing();
        let mut all = etendue_spectrum::Measurement::new(self.0.scene.planes.clone());
        for (number, bytes) in batches {
            let batch = packing
                .unpacked(&*source, number, bytes.as_bytes())
                .map_err(|failure| raised(py, failure))?;
            all.insert(batch).map_err(|error| bad(py, &error))?;
        }
        Ok(Measurement(all))
    }

    /// Returns the prediction of each plane as bytes.
    fn packed_prediction<'py>(
        &self,
        py: Python<'py>,
        prediction: &Prediction,
    ) -> PyResult<Vec<Bound<'py, PyBytes>>> {
        let planes = self.0.scene.planes.iter();
        let packed = planes.zip(&prediction.0).map(|(plane, prediction)| {
            let bytes = predictions::packed(plane, prediction);
            Ok(PyBytes::new(py, &bytes.map_err(|f| raised(py, f))?))
        });
        packed.collect()
    }

    fn unpacked_prediction(
        &self,
        py: Python<'_>,
        planes: Vec<Bound<'_, PyBytes>>,
    ) -> PyResult<Prediction> {
        let pairs = self.0.scene.planes.iter().zip(&planes);
        let unpacked = pairs.map(|(plane, bytes)| {
            predictions::unpacked(plane, bytes.as_bytes()).map_err(|f| raised(py, f))
        });
        unpacked.collect::<PyResult<_>>().map(Prediction)
    }
}

impl Run {
    fn chain_steps(&self, plane: usize) -> Option<Vec<ChainStep>> {
        let scene = &self.0.scene;
        self.0.theories[plane].chain_steps(scene, &scene.planes[plane])
    }
}

fn bad(py: Python<'_>, error: &dyn std::fmt::Display) -> PyErr {
    raised(py, Failure::bad_input(error))
}

#[pymethods]
impl Measurement {
    #[getter]
    fn batches(&self) -> Vec<u32> {
        self.0.batches().map(|batch| batch.index).collect()
    }

    #[getter]
    fn photons(&self) -> u64 {
        self.0.emitted()
    }

    /// Merges this measurement with others.
    fn merged(&self, py: Python<'_>, others: Vec<Bound<'_, Self>>) -> PyResult<Self> {
        let others = others.iter().map(|other| other.get().0.clone());
        let merged = others
            .into_iter()
            .try_fold(self.0.clone(), |all, other| all.merge(other));
        merged.map(Self).map_err(|error| bad(py, &error))
    }
}
