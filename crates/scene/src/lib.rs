//! Defines the experiment: a scene file, and the [`Scene`] to which [`resolve`] converts this
//! file.
//!
//! A [`SceneFile`] holds exactly what is written in the file. The function [`resolve`] checks the
//! file, reports all faults together, and returns a [`Scene`] that is valid by construction. Later
//! stages do not check validity again.
//!
//! This crate neither traces nor predicts.
//!
//! ```
//! let text = r#"(
//!     light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2), radiance: 1.0),
//!     surfaces: [Rectangle(name: "receiver", center: (0, 0, 2), size: (4, 4), albedo: 0.5)],
//!     path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["receiver"]),
//!     planes: [(name: "arrival", at: Before("receiver"))],
//!     window: (x: Hann(0.5), u: Hann(0.5)),
//!     frequencies: (rho: (max: 8.0), nu: (max: 16.0)),
//! )"#;
//! let file = etendue_scene::SceneFile::parse(text).unwrap();
//! let scene = etendue_scene::resolve("example", file, ".".as_ref(), u64::MAX).unwrap();
//! assert_eq!(scene.planes[0].distance, 2.0);
//! ```

mod curvature;
mod mistakes;
mod picture;
mod read;
mod resolve;
mod scene;
mod triangles;
mod warnings;

pub use etendue_scenefile::{
    AxisFile, AxisName, BlockersFile, BrdfFile, BulbFile, Color, ColorFile, Emission,
    EnvironmentFile, EventFile, Fault, FormFile, FrequenciesFile, FresnelFile, GratingFile,
    HalfName, HoleFile, ImageFile, LightFile, LobeFile, MeshSource, PathFile, PatternFile, Place,
    PlaneFile, RunFile, Sampling, SceneError, SceneFile, SceneFormat, ShapeFile,
    SphericalGaussianFile, SurfaceFile, TermFile, WindowFile, dotted, limits, nearest, page,
    schema, shown, unit,
};
pub use picture::{Channels, PictureSize, Samples, read_channels};
pub use read::{ReadError, read_below, read_file};
pub use resolve::resolve;
pub use scene::{
    BlockerLayer, CentralRay, Event, Hit, Leg, MeshObject, Object, PatchObject, RunSettings, Scene,
    SmoothMesh, Surface, scene_hash,
};
pub use triangles::Triangles;
