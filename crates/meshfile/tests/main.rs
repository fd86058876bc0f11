//! The tests of `etendue-meshfile`, as one program.

mod detailed;
mod mesh;
