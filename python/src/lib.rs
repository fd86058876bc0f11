//! The Rust side of the Python package: a scene, what is measured and predicted of it, and arrays that become NumPy's without a copy.
//!
//! Everything a user sees is in `etendue/*.py`; this is what it stands on.

mod arrays;
mod job;
mod live;
mod outcome;
mod raised;
mod rays;

use pyo3::prelude::*;

/// The native part of `etendue`.
#[pymodule(gil_used = false)]
mod _etendue {
    #[pymodule_export]
    use crate::job::{Job, Measurement, Prediction};
    #[pymodule_export]
    use crate::outcome::Outcome;
    #[pymodule_export]
    use crate::raised::{CannotRun, SceneError};

    use pyo3::prelude::*;

    /// Runs the command `etendue` with the arguments of this process; returns its exit code.
    #[pyfunction]
    fn command(arguments: Vec<String>) -> u8 {
        etendue::command(arguments)
    }
}
