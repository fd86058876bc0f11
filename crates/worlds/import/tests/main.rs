//! The tests of `etendue-import`, as one program.

#![allow(clippy::too_many_lines, reason = "a test may be a list of cases")]

mod attributes;
mod bounds;
mod cameras;
mod colors;
mod common;
mod files;
mod gltf;
mod gltf_files;
mod gltf_scene;
mod lights;
mod materials;
mod mutations;
mod obj;
mod pbrt_cameras;
mod pbrt_files;
mod pbrt_lights;
mod pbrt_materials;
mod pbrt_scenes;
mod pbrt_shapes;
mod properties;
mod ranges;
mod shapes;
mod transforms;
