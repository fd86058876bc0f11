//! The tests of `etendue-spectrum`, one program for all.

mod batches;
mod common;
mod field_aliasing;
mod field_covariance;
mod field_measure;
mod noise;
mod reference;
