//! The tests of `etendue-predict`, as one program.

mod applicability;
mod small_objects;
mod work;
