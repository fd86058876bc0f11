//! The tests of `etendue-trace`, as one program.

#![allow(clippy::too_many_lines, reason = "a test may be a list of cases")]

mod brdfs;
mod common;
mod environment;
mod lattices;
mod legs;
mod memory;
mod meshes;
mod narrow;
mod on_surfaces;
mod tracer;
mod vocabulary;
mod world;
