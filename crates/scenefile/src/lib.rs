//! Scene files as written: read from RON or JSON, described by a schema, and checked field by
//! field.
//!
//! The description, notation and range of each field are stated once, on the types of
//! [`SceneFile`]. The schema, the hints of messages and the check of all numbers are derived from
//! them. Whether values are consistent is checked by `etendue-scene`, which resolves a file to a
//! scene.

mod display;
mod fault;
mod file;
mod hints;
pub mod limits;
mod messages;
mod overrides;
mod parse;
mod place;
mod schema;
mod suggestion;
mod values;
mod whole_number;

pub use display::{is_printable, number, shown};
pub use fault::{Fault, SceneError, fault};
pub use file::{
    AxisFile, AxisName, BlockersFile, BrdfFile, BulbFile, Emission, EnvironmentFile, EventFile,
    FormFile, FrequenciesFile, FresnelFile, GratingFile, HalfName, ImageFile, LightFile, LobeFile,
    MeshSource, PathFile, PatternFile, Place, PlaneFile, RunFile, Sampling, SceneFile, ShapeFile,
    SphericalGaussianFile, SurfaceFile, TermFile, WindowFile,
};
pub use hints::unit;
pub use schema::schema;
pub use suggestion::{did_you_mean, nearest};
