//! Checks whether the maps of a first-order chain match the real geometry.

use crate::geometry::SpectrumMap;
use crate::path::Observed;
use etendue_field::Window;

/// The error of a chain of affine maps in the limit of a small neighbourhood of the central
/// ray. [`chain`](super::chain()) returns such a chain.
///
/// The maps of a chain must be the derivatives of rays through the real geometry. If the maps are
/// these derivatives, the chain's error falls linearly or quadratically with the size of the
/// neighbourhood, and the limit is zero except for 10⁻⁹ from finite differences and rounding
/// errors. If any map has a wrong sign, cosine or factor, the limit is not zero. It is then the
/// error of rays, in units of the window's half-width, or the relative error of radiance.
///
/// Returns `None` if the central ray does not arrive.
#[must_use]
pub fn defect(view: &Observed, map: &SpectrumMap<4>, window: &Window) -> Option<f64> {
    let Observed { system, plane } = view;
    let half = [window.x, window.y, window.u, window.v].map(|profile| profile.half_width());
    let lands = |ray| Some(plane.coordinates(&system.follow(ray)?)?.0);
    let off = map.rays().off_touching(lands, &half)?;
    Some(off.max(radiance_defect(view, map)?.abs()))
}

/// The contribution of the chain's factor to [`defect`]. It is the radiance that the chain
/// predicts for the central ray, divided by the actual radiance, minus 1.
#[must_use]
pub fn radiance_defect(view: &Observed, map: &SpectrumMap<4>) -> Option<f64> {
    let Observed { system, plane } = view;
    // Per unit of ray space at the light, the central ray carries a flux equal to its radiance, so
    // `per_flux` is the ratio of radiance at the plane to radiance at the light.
    let (center, per_flux) = plane.coordinates(&system.follow([0.0; 4])?)?;
    Some(map.factor * plane.factor(center) / per_flux - 1.0)
}
