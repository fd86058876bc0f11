//! Checks whether the maps of a first-order chain match the real geometry.

use super::SpecularSystem;
use crate::geometry::SpectrumMap;
use crate::model::Observed;
use etendue_field::Window;

/// Returns the error of a chain of affine maps, such as that of [`chain`](super::chain()), in the
/// limit of a small neighbourhood of the central ray.
///
/// The maps of a chain must be the derivatives of the paths of rays through the real geometry. Then
/// the chain's error falls with the size of the neighbourhood, or with its square, and this limit
/// is zero up to 10⁻⁹ from differences and rounding errors. With a wrong sign, cosine or factor in
/// any map, the error converges to the number returned instead: the error of rays, in half-widths
/// of the window, or the relative error of radiance.
///
/// Returns `None` if the central ray does not arrive.
#[must_use]
pub fn defect(
    view: &Observed<SpecularSystem>,
    map: &SpectrumMap<4>,
    window: &Window,
) -> Option<f64> {
    let Observed { system, plane } = view;
    let half = [window.x, window.y, window.u, window.v].map(|profile| profile.half_width());
    let lands = |ray| Some(plane.coordinates(&system.follow(ray)?)?.0);
    let off = map.rays().off_touching(lands, &half)?;
    Some(off.max(radiance_defect(view, map)?.abs()))
}

/// Returns the part of [`defect`] due to the factor of the chain: the radiance that the chain gives
/// the central ray, divided by the ray's actual radiance, minus 1.
#[must_use]
pub fn radiance_defect(view: &Observed<SpecularSystem>, map: &SpectrumMap<4>) -> Option<f64> {
    let Observed { system, plane } = view;
    // Per unit of ray space, the central ray carries a flux equal to its radiance at the light, so
    // `per_flux` is the change of radiance.
    let (center, per_flux) = plane.coordinates(&system.follow([0.0; 4])?)?;
    Some(map.factor * plane.factor(center) / per_flux - 1.0)
}
