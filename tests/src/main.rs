//! Validation.
fn main() {}
