//! The tests of `etendue-paths`, as one program.

#![allow(clippy::too_many_lines, reason = "a test may be a list of cases")]

mod attributes;
mod furnace;
mod gltf;
mod known;
mod masks;
mod probe;
