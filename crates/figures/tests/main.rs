//! The tests of `etendue-figures`, as one program.

mod common;
mod layout;
mod pictures;
