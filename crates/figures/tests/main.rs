//! The tests of `etendue-figures`, one program for all.

mod common;
mod layout;
mod pictures;
