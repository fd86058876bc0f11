//! Weighted sums of BRDFs: the value is the sum, and one of them is drawn by its share of albedo.

use super::{density, sample, value};
use etendue_field::Mixture;
use glam::DVec3;

/// The sum, sr⁻¹.
#[inline]
#[must_use]
pub fn sum(mixture: &Mixture<'_>, wi: DVec3, wo: DVec3) -> f64 {
    let values = mixture.weighted();
    values.map(|(weight, of)| weight * value(of, wi, wo)).sum()
}

/// A direction by one of them, as [`sample`] has it; the first number chooses.
#[inline]
pub(crate) fn towards(mixture: &Mixture<'_>, wi: DVec3, [a, b]: [f64; 2]) -> DVec3 {
    let total = mixture.albedo();
    let mut left = a;
    let mut chosen = None;
    for (weight, of) in mixture.weighted() {
        let share = weight * of.albedo / total;
        if share > 0.0 {
            // Rounding may leave the last of them a number beyond 1.
            chosen = Some((of, (left / share).min(BELOW_ONE)));
        }
        if left < share {
            break;
        }
        left -= share;
    }
    chosen.map_or(DVec3::Z, |(of, a)| sample(of, wi, [a, b]))
}

/// The largest number that is drawn from.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON;

/// The density of [`towards`] per solid angle.
#[inline]
pub(crate) fn densities(mixture: &Mixture<'_>, wi: DVec3, wo: DVec3) -> f64 {
    let each = mixture.weighted();
    let sum: f64 = each
        .map(|(weight, of)| weight * of.albedo * density(of, wi, wo))
        .sum();
    sum / mixture.albedo()
}
