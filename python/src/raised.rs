//! Converts failures to Python exceptions.

use etendue_store::{Failure, FailureKind};
use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

create_exception!(
    etendue,
    SceneError,
    PyValueError,
    "An invalid scene or another invalid input. `faults` lists all errors, one sentence each."
);
create_exception!(
    etendue,
    CannotRun,
    PyRuntimeError,
    "The request cannot be carried out here: for example, there is too little memory or disk space, or a folder contains something else."
);

/// Returns the exception for a failure.
pub(crate) fn raised(py: Python<'_>, failure: Failure) -> PyErr {
    if failure.kind != FailureKind::BadInput {
        return CannotRun::new_err(failure.message);
    }
    let faults: Vec<String> = failure.message.lines().map(str::to_owned).collect();
    let error = SceneError::new_err(failure.message);
    match error.value(py).setattr("faults", faults) {
        Ok(()) => error,
        Err(other) => other,
    }
}
