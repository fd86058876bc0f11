//! The tests of `etendue-paths`, one program for all.

#![allow(clippy::too_many_lines, reason = "a test may be a list of cases")]

mod furnace;
mod known;
mod probe;
