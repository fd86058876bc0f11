//! The tests of `etendue-compare`, one program for all.

mod applicability;
mod comparison;
mod made_up;
mod small_objects;
mod two_samples;
mod work;
