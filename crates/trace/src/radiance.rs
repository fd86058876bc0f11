//! Radiance of lights along a ray.

use crate::sky;
use etendue_field::{Light, TwoPlane, power};

/// Radiance on a ray given at the light; for a point, with respect to du dv alone, for a beam to dx dy, for rays of a file over the share of flux: dω is
/// du dv / (1 + u² + v²)^(3/2), and a ray of flux Φ adds Φ (1 + u² + v²)² to radiance space.
#[inline]
pub(crate) fn radiance(light: &Light, ray: &TwoPlane) -> f64 {
    match light {
        Light::Area {
            shape,
            radiance,
            exponent,
        } => {
            if !shape.contains(ray.x, ray.y) {
                0.0
            } else if *exponent == 0.0 {
                *radiance
            } else {
                radiance * power(ray.secant_squared(), -0.5 * exponent)
            }
        }
        Light::Point { intensity } => intensity * ray.secant_squared().sqrt(),
        Light::Projector { intensity, image } => {
            intensity * image.value(ray.u, ray.v) * ray.secant_squared().sqrt()
        }
        Light::Beam { irradiance, image } => irradiance * image.value(ray.x, ray.y),
        Light::Environment { environment } => sky::radiance(environment, ray),
        // By the share of the flux that a ray is drawn with.
        Light::Rays { rays } => rays.flux() * ray.secant_squared() * ray.secant_squared(),
    }
}
