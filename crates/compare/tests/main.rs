//! The tests of `etendue-compare`, as one program.

mod applicability;
mod comparison;
mod made_up;
mod small_objects;
mod two_samples;
mod work;
