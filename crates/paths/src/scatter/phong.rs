//! The modified Phong BRDF (Lafortune and Willems 1994, *Using the modified Phong reflectance model for physically based rendering*).

use super::bounce::{by_cosine, cosine_density, mirrored};
use etendue_world::Texture;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// BRDF times the cosine of wi, both directions being in front.
pub(super) fn value(
    [diffuse, specular, exponent]: &[Texture; 3],
    uv: DVec2,
    wi: DVec3,
    wo: DVec3,
) -> f64 {
    let n = exponent.value(uv);
    let cosine = mirrored(wo, DVec3::Z).dot(wi).max(0.0);
    let lobe = (n + 2.0) / TAU * libm::pow(cosine, n);
    (diffuse.value(uv) / PI + specular.value(uv) * lobe) * wi.z
}

/// The share of the diffuse part in what leaves.
pub(super) fn base_share(of: &[Texture; 3], uv: DVec2, wi: DVec3, wo: DVec3) -> f64 {
    let all = value(of, uv, wi, wo);
    if all > 0.0 {
        of[0].value(uv) / PI * wi.z / all
    } else {
        0.0
    }
}

/// The share of samples about the mirror direction.
fn share([diffuse, specular, _]: &[Texture; 3], uv: DVec2) -> f64 {
    let (kd, ks) = (diffuse.value(uv), specular.value(uv));
    if kd + ks > 0.0 { ks / (kd + ks) } else { 0.5 }
}

pub(super) fn density(of: &[Texture; 3], uv: DVec2, wi: DVec3, wo: DVec3) -> f64 {
    let share = share(of, uv);
    let n = of[2].value(uv);
    let cosine = mirrored(wo, DVec3::Z).dot(wi).max(0.0);
    share * (n + 1.0) / TAU * libm::pow(cosine, n) + (1.0 - share) * cosine_density(wi)
}

pub(super) fn sample(of: &[Texture; 3], uv: DVec2, wo: DVec3, [a, b, c]: [f64; 3]) -> DVec3 {
    if c >= share(of, uv) {
        return by_cosine([a, b]);
    }
    let cosine = libm::pow(a, 1.0 / (of[2].value(uv) + 1.0));
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(TAU * b);
    let mirror = mirrored(wo, DVec3::Z);
    let (s, t) = mirror.any_orthonormal_pair();
    sine * cos * s + sine * sin * t + cosine * mirror
}
