//! The tests of `etendue-compare`, as one program.

mod comparison;
mod made_up;
mod two_samples;
