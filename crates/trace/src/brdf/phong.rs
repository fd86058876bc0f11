//! Phong's lobe: cosⁿ of the angle to the mirror direction, drawn as it is.

use etendue_field::{Frame, power};
use glam::DVec3;
use std::f64::consts::TAU;

fn mirrored(wi: DVec3) -> DVec3 {
    DVec3::new(-wi.x, -wi.y, wi.z)
}

/// Its integral over the sphere is 1: there is nothing of it beyond 90°, not of cos⁰ either.
pub(super) fn value(exponent: f64, wi: DVec3, wo: DVec3) -> f64 {
    let cosine = mirrored(wi).dot(wo).min(1.0);
    if cosine <= 0.0 {
        return 0.0;
    }
    (exponent + 1.0) / TAU * power(cosine, exponent)
}

pub(super) fn sample(exponent: f64, wi: DVec3, [a, b]: [f64; 2]) -> DVec3 {
    let (sin, cos) = libm::sincos(TAU * b);
    let along = power(a, 1.0 / (exponent + 1.0));
    let across = ((1.0 - along) * (1.0 + along)).sqrt();
    let around = Frame::IDENTITY.turned_to(mirrored(wi));
    around.vector_to_world(DVec3::new(across * cos, across * sin, along))
}

/// The lobe itself: near grazing a part of it lies below the surface.
pub(super) fn density(exponent: f64, wi: DVec3, wo: DVec3) -> f64 {
    value(exponent, wi, wo)
}
