//! The tests of `etendue-rays`, as one program.

mod hostile;
mod public;
mod round_trip;
