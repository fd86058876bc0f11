//! Alike in all directions, drawn by the cosine.

use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, TAU};

pub(super) fn value() -> f64 {
    FRAC_1_PI
}

pub(super) fn sample([a, b]: [f64; 2]) -> DVec3 {
    let (sin, cos) = libm::sincos(TAU * b);
    let across = a.sqrt();
    DVec3::new(across * cos, across * sin, (1.0 - a).sqrt())
}

pub(super) fn density(wo: DVec3) -> f64 {
    wo.z.max(0.0) * FRAC_1_PI
}
