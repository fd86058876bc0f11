//! The tests of `etendue-rays`, one program for all.

mod hostile;
mod public;
mod round_trip;
