//! The tests of `etendue-rayfile`, as one program.

mod hostile;
mod public;
mod round_trip;
