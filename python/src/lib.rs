//! The Rust side of the Python package: a scene, its measurements and predictions, and arrays that
//! become NumPy arrays without a copy.
//!
//! The user's interface is in `etendue/*.py`, which builds on this module.

mod arguments;
mod arrays;
mod difference;
mod figure;
mod fit;
mod folder;
mod import;
mod live;
mod outcome;
mod probe;
mod raised;
mod rays;
mod render;
mod run;
mod scene;
mod sweep;
mod variance;
mod world;

use pyo3::prelude::*;

/// The native module of `etendue`.
#[pymodule(gil_used = false)]
mod _etendue {
    #[pymodule_export]
    use crate::difference::two_samples;
    #[pymodule_export]
    use crate::figure::figure;
    #[pymodule_export]
    use crate::fit::fit;
    #[pymodule_export]
    use crate::folder::Folder;
    #[pymodule_export]
    use crate::import::import_scene;
    #[pymodule_export]
    use crate::outcome::{Measurement, Outcome, Prediction};
    #[pymodule_export]
    use crate::probe::probe;
    #[pymodule_export]
    use crate::raised::{CannotRun, SceneError};
    #[pymodule_export]
    use crate::render::render;
    #[pymodule_export]
    use crate::run::Run;
    #[pymodule_export]
    use crate::sweep::{derivative, sweep};
    #[pymodule_export]
    use crate::variance::variance;

    /// Runs the command `etendue` with the arguments of this process; returns its exit code.
    #[cfg(feature = "command")]
    #[pyo3::pyfunction]
    fn command(arguments: Vec<String>) -> u8 {
        etendue::command(arguments)
    }
}
