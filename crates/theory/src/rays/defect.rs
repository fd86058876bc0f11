//! Whether the maps of a first-order chain are those of the real geometry.

use super::SpecularSystem;
use crate::geometry::SpectrumMap;
use crate::model::Observed;
use etendue_field::Window;

/// What stays of the error of a chain of affine maps, such as that of [`chain`](super::chain()), as
/// the neighbourhood of the central ray shrinks.
///
/// The maps of a chain must be the derivatives of where rays go through the real geometry. Then its
/// error falls with the size of the neighbourhood, or with its square, and this is zero but for
/// 10⁻⁹ of differences and rounding. With a wrong sign, cosine or factor in any map the error falls
/// to this number instead: rays that are wrong, in half-widths of the window, or a wrong share of
/// radiance.
///
/// `None` where the central ray does not arrive.
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

/// The part of [`defect`] that is in the factor of the chain: the radiance that it gives the central
/// ray over the radiance that the ray has, less 1.
#[must_use]
pub fn radiance_defect(view: &Observed<SpecularSystem>, map: &SpectrumMap<4>) -> Option<f64> {
    let Observed { system, plane } = view;
    // What becomes of flux along the central ray; at the light it stands for radiance.
    let (center, per_flux) = plane.coordinates(&system.follow([0.0; 4])?)?;
    Some(map.factor * plane.factor(center) / per_flux - 1.0)
}
