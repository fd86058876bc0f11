//! The numbers that a scene may hold, whatever its format.

use glam::DAffine3;

/// The largest number of a scene, as in Étendue's own: sums of products of several stay far inside what f64 holds.
pub(crate) const MAX_NUMBER: f64 = 1e9;

/// The largest share of light that a surface may scatter: weights of colour channels add up to 1 but for rounding.
pub(crate) const MAX_SHARE: f64 = 1.0 + 1e-9;

/// A number in range; `Err` is what is wrong with it.
pub(crate) fn in_range(value: f64) -> Result<f64, String> {
    match value.abs() <= MAX_NUMBER {
        true => Ok(value),
        false => Err(format!(
            "{value:e} is out of range; allowed: {:e} to {MAX_NUMBER:e}",
            -MAX_NUMBER
        )),
    }
}

/// Whether all numbers of a map are in range.
pub(crate) fn holds(map: DAffine3) -> bool {
    map.to_cols_array().iter().all(|v| v.abs() <= MAX_NUMBER)
}
