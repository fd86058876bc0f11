//! Computes the radiance of lights along a ray.

use crate::lanes::{inside, lanes};
use crate::photon_group::{PhotonColumn, ray};
use crate::sky;
use etendue_field::{Light, TwoPlane, power};

/// The radiance along several rays, given as columns of x, y, u and v.
#[inline(always)]
pub(crate) fn radiances(light: &Light, rays: &[PhotonColumn; 4]) -> PhotonColumn {
    match light {
        Light::Area {
            shape,
            radiance,
            exponent: 0.0,
        } => {
            let is_lit = inside(shape, [&rays[0], &rays[1]]);
            lanes(|i| if is_lit[i] { *radiance } else { 0.0 })
        }
        light => lanes(|i| radiance(light, &ray(rays, i))),
    }
}

/// The radiance along a ray that is given in the plane of the light. The value is per du dv
/// for a point light, per dx dy for a beam, and per share of flux for rays of a file. The value
/// follows from two relations: dω = du dv / (1 + u² + v²)^(3/2), and a ray of flux Φ contributes Φ
/// (1 + u² + v²)² to radiance space.
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
        // The value is divided by the ray's share of the total flux, because this share is the
        // probability with which the ray is drawn.
        Light::Rays { rays } => rays.flux() * ray.secant_squared() * ray.secant_squared(),
    }
}
