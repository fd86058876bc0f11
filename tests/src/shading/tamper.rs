//! Modifications of crossings that plant faults in photons.

use super::bench::on_flat;
use etendue_field::Crossing;
use etendue_scene::Scene;
use glam::{DQuat, DVec3};

pub(super) fn scaled(mut crossing: Crossing, factor: f64) -> Crossing {
    crossing.weight *= factor;
    crossing
}

/// The cosine of the angle of incidence.
pub(super) fn cosine(scene: &Scene, crossing: &Crossing) -> f64 {
    let [_, from] = on_flat(scene, crossing);
    from.z
}

/// The reflectances of glass of index 1.5 for the polarisations s and p, divided by their
/// mean (Fresnel's equations with Snell's law).
pub(super) fn polarised(cosine: f64) -> [f64; 2] {
    const INDEX: f64 = 1.5;
    let inner = (1.0 - (1.0 - cosine * cosine) / (INDEX * INDEX)).sqrt();
    let s = ((cosine - INDEX * inner) / (cosine + INDEX * inner)).powi(2);
    let p = ((INDEX * cosine - inner) / (INDEX * cosine + inner)).powi(2);
    [s, p].map(|share| 2.0 * share / (s + p))
}

/// Multiplies the weight by the texture of `textured_glossy` at the position of the leaving
/// light. The factor 1/cos θ₁ converts a position across the leaving ray to a position along the
/// surface.
pub(super) fn textured_here(scene: &Scene, crossing: Crossing) -> Crossing {
    const MIRROR: f64 = 0.796_083_799;
    let etendue_scene::Event::Reflects(reflectance) = &scene.patches[0].event else {
        return crossing;
    };
    let ray = crossing.ray;
    let texture = reflectance.texture.as_ref();
    let factor = texture.map_or(1.0, |t| t.value(ray.x / MIRROR, ray.y));
    scaled(crossing, factor)
}

/// Rotates the leaving light so that the mirror direction becomes the normal. The rotation of
/// directions preserves solid angles, but not areas in the coordinates (θ, φ).
pub(super) fn around_the_normal(scene: &Scene, mut crossing: Crossing) -> Crossing {
    let [away, from] = on_flat(scene, &crossing);
    let mirrored = DVec3::new(-from.x, -from.y, from.z);
    let turned = DQuat::from_rotation_arc(mirrored, DVec3::Z) * away;
    let latitude = turned.y.clamp(-1.0, 1.0).asin();
    crossing.weight *= crossing.ray.v.cos() / latitude.cos();
    crossing.ray.u = turned.x.atan2(turned.z) - scene.planes[0].longitude;
    crossing.ray.v = latitude;
    crossing
}
