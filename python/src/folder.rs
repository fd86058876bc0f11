//! Provides stored results to Python.

use crate::raised::raised;
use etendue_store::ArgumentStyle;
use etendue_store::stored::ResultFolder;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;

/// The folder of a result or of a measurement.
#[pyclass(frozen, module = "etendue._etendue")]
pub(crate) struct Folder(ResultFolder);

#[pymethods]
impl Folder {
    #[new]
    fn new(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let found = ResultFolder::read(&folder);
        found.map(Self).map_err(|failure| raised(py, failure))
    }

    /// The name of the index.
    #[getter]
    fn name(&self) -> &str {
        self.0.name
    }

    /// The bytes of the index.
    #[getter]
    fn index(&self) -> &[u8] {
        &self.0.index
    }

    /// The bytes of a file, which must be unchanged; `None` if the index does not list it.
    fn bytes<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyBytes>>> {
        if self.0.hash(name).is_none() {
            return Ok(None);
        }
        let bytes = self.0.bytes(name).map_err(|failure| raised(py, failure))?;
        Ok(Some(PyBytes::new(py, &bytes)))
    }

    fn save(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<PathBuf> {
        let saved = py.detach(|| self.0.copy(&folder, force, ArgumentStyle::Python));
        saved.map_err(|failure| raised(py, failure))
    }
}
