//! The range of numbers that a scene may hold, for any format.

use glam::DAffine3;

/// The largest number in a scene, as in Étendue's own scenes. With this limit, sums of products of
/// several numbers stay far within the range of f64.
pub(crate) const MAX_NUMBER: f64 = 1e9;

/// The largest albedo of a surface. The limit slightly exceeds 1 because the weights of colour
/// channels add up to 1 only up to rounding errors.
pub(crate) const MAX_SHARE: f64 = 1.0 + 1e-9;

/// Checks that a number is in range; `Err` describes the fault.
pub(crate) fn in_range(value: f64) -> Result<f64, String> {
    match value.abs() <= MAX_NUMBER {
        true => Ok(value),
        false => Err(format!(
            "{value:e} is out of range; allowed: {:e} to {MAX_NUMBER:e}",
            -MAX_NUMBER
        )),
    }
}

/// Checks whether all numbers of a map are in range.
pub(crate) fn holds(map: DAffine3) -> bool {
    map.to_cols_array().iter().all(|v| v.abs() <= MAX_NUMBER)
}
