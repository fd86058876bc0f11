//! Provides the result of a comparison to Python.

use crate::arrays::Arrays;
use crate::raised::raised;
use etendue_compare::PlaneComparison;
use etendue_field::{Complex, ProjectionGrid};
use etendue_store::ArgumentStyle;
use etendue_store::arrays::SliceArrays;
use ndarray::{Array1, Axis};
use numpy::{IntoPyArray, PyArray4};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The measurement of some or all batches of a scene.
#[pyclass(frozen, module = "etendue._etendue")]
pub(crate) struct Measurement(pub(crate) etendue_spectrum::Measurement);

/// The prediction that a measurement is compared with.
#[pyclass(frozen, module = "etendue._etendue")]
pub(crate) struct Prediction(pub(crate) Vec<etendue_compare::Prediction>);

/// A scene with its planes measured, predicted and compared.
#[pyclass(frozen, module = "etendue._etendue")]
pub(crate) struct Outcome(pub(crate) etendue_pipeline::Outcome);

impl Outcome {
    fn plane(&self, plane: usize) -> PyResult<&PlaneComparison> {
        let found = self.0.judged.planes.get(plane);
        found.ok_or_else(|| PyIndexError::new_err("no such plane"))
    }
}

/// Returns the axes of a light field: the centres of its cells along x and along u.
pub(crate) fn cells(grid: &ProjectionGrid) -> [Array1<f64>; 2] {
    [grid.half_x, grid.half_u].map(|half| (0..grid.bins).map(|i| grid.center(i, half)).collect())
}

#[pymethods]
impl Outcome {
    fn summary(&self) -> String {
        let summary = self.0.judged.summary.json(&BTreeMap::new());
        String::from_utf8_lossy(&summary).into_owned()
    }

    fn table(&self) -> String {
        etendue_report::table::text(&self.0.judged.summary)
    }

    fn measurement(&self) -> Measurement {
        Measurement(self.0.case.measurement.clone())
    }

    /// The slices of each batch at a plane, [batch, azimuth, ρ ≥ 0, ν].
    fn batches<'py>(
        &self,
        py: Python<'py>,
        plane: usize,
    ) -> PyResult<Bound<'py, PyArray4<Complex>>> {
        self.plane(plane)?;
        let batches = self.0.case.measurement.at_plane(plane);
        let slices: Vec<_> = batches.map(|batch| batch.slices.half.view()).collect();
        let stacked = ndarray::stack(Axis(0), &slices);
        let stacked = stacked.map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(stacked.into_pyarray(py))
    }

    fn prediction(&self) -> Prediction {
        Prediction(self.0.case.predictions.clone())
    }

    fn slices<'py>(&self, py: Python<'py>, plane: usize) -> PyResult<Bound<'py, PyDict>> {
        let SliceArrays {
            azimuth,
            measured,
            predicted,
            sigma,
            measured_sigma,
            rho,
            nu,
        } = SliceArrays::of(self.plane(plane)?);
        let measured_sigma = measured_sigma.unwrap_or_else(|| sigma.clone());
        Ok(Arrays::new(py)
            .add("azimuth", azimuth)?
            .add("rho", rho)?
            .add("nu", nu)?
            .add("measured", measured)?
            .add("predicted", predicted)?
            .add("sigma", sigma)?
            .add("sigma_measured", measured_sigma)?
            .finish())
    }

    fn radial<'py>(&self, py: Python<'py>, plane: usize) -> PyResult<Bound<'py, PyDict>> {
        let plane = self.plane(plane)?;
        let grid = plane.measured.grid;
        Ok(Arrays::new(py)
            .add("rho", Array1::from(grid.rho.values()))?
            .add("nu", Array1::from(grid.nu.values()))?
            .add("measured", plane.radial.power.clone())?
            .add("predicted", plane.predicted_radial.clone())?
            .add("sigma", plane.radial_sigma.clone())?
            .add("sigma_measured", plane.radial.sigma.clone())?
            .add("shot_noise", plane.radial.shot_noise.clone())?
            .finish())
    }

    fn light_field<'py>(&self, py: Python<'py>, plane: usize) -> PyResult<Bound<'py, PyDict>> {
        let found = self.plane(plane)?;
        let predicted = self.0.case.predictions[plane].projection.values.clone();
        let [x, u] = cells(&found.projection.mean.grid);
        Ok(Arrays::new(py)
            .add("x", x)?
            .add("u", u)?
            .add("measured", found.projection.mean.values.clone())?
            .add("predicted", predicted)?
            .add("sigma", found.projection.standard_error.clone())?
            .finish())
    }

    fn save(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<PathBuf> {
        let saved =
            py.detach(|| etendue_report::save(&self.0, &folder, force, ArgumentStyle::Python));
        saved.map_err(|failure| raised(py, failure))
    }
}
