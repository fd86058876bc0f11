//! Passes Rust arrays to NumPy without a copy. The NumPy array takes ownership of the memory.

use ndarray::{Array, Dimension};
use numpy::{Element, PyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Named arrays.
pub(crate) struct Arrays<'py>(Bound<'py, PyDict>);

impl<'py> Arrays<'py> {
    pub(crate) fn new(py: Python<'py>) -> Self {
        Self(PyDict::new(py))
    }

    pub(crate) fn add<T: Element, D: Dimension>(
        self,
        name: &str,
        array: Array<T, D>,
    ) -> PyResult<Self> {
        let array = PyArray::from_owned_array(self.0.py(), array);
        self.0.set_item(name, array)?;
        Ok(self)
    }

    pub(crate) fn finish(self) -> Bound<'py, PyDict> {
        self.0
    }
}
