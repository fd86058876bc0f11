//! The tests of `etendue-scene`, as one program.

mod book;
mod colors;
mod json;
mod limits;
mod meshes_refused;
mod other_lights;
mod pictures;
mod places;
mod reading;
mod scene_file;
mod smooth;
mod vocabulary;
