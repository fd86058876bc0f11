//! The radiance of lights along a ray.

use crate::sky;
use etendue_field::{Light, TwoPlane, power};

/// The radiance along a ray given at the light. The value is per du dv alone for a point light,
/// per dx dy for a beam, and per share of flux for rays of a file. The value follows from dω = du
/// dv / (1 + u² + v²)^(3/2), and from the contribution Φ (1 + u² + v²)² of a ray of flux Φ to
/// radiance space.
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
        // The value is divided by the share of the flux with which the ray is drawn.
        Light::Rays { rays } => rays.flux() * ray.secant_squared() * ray.secant_squared(),
    }
}
