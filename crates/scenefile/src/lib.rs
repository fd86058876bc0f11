//! Reads scene files in RON or JSON, and checks them field by field. A schema describes the fields.
//!
//! The types of [`SceneFile`] are the only place that states the description, the notation and the
//! range of each field. The schema, the hints in messages and the checks of all numbers are derived
//! from these types. The crate `etendue-scene`, which resolves a file to a scene, checks whether
//! the values are consistent with each other.

mod display;
mod fault;
mod file;
mod hints;
pub mod limits;
mod messages;
mod overrides;
mod page;
mod parse;
mod place;
mod schema;
mod suggestion;
mod values;
mod whole_number;

pub use display::{is_printable, number, shown};
pub use fault::{Fault, SceneError, fault};
pub use file::{
    AxisFile, AxisName, BlockersFile, BrdfFile, BulbFile, Color, ColorFile, Emission,
    EnvironmentFile, EventFile, FormFile, FrequenciesFile, FresnelFile, GratingFile, HalfName,
    HoleFile, ImageFile, LightFile, LobeFile, MeshSource, PathFile, PatternFile, Place, PlaneFile,
    RunFile, Sampling, SceneFile, SceneFormat, ShapeFile, SphericalGaussianFile, SurfaceFile,
    TermFile, WindowFile,
};
pub use hints::unit;
pub use page::page;
pub use place::dotted;
pub use schema::schema;
pub use suggestion::{did_you_mean, nearest};
