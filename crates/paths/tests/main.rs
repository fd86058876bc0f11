//! The tests of `etendue-paths`, one program for all.

mod furnace;
mod known;
mod probe;
