//! Layers of numbers over a picture: the check that they are finite, and their files for programs.

use etendue_store::exr::{Part, exr};
use etendue_store::npz::Npz;
use etendue_store::{Failure, Results};
use ndarray::Array2;
use serde_json::Value;

/// Writes layers with a number for each pixel, rows from the top, as an EXR file. Returns the same
/// layers as arrays.
pub(crate) fn write_exr<'a>(
    results: &mut Results,
    name: &str,
    [w, h]: [usize; 2],
    layers: impl IntoIterator<Item = (&'static str, &'a [f64])>,
    made_from: &Value,
) -> Result<Npz, Failure> {
    let mut parts = Vec::new();
    let mut npz = Npz::default();
    for (name, values) in layers {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "EXR viewers expect 32-bit numbers"
        )]
        let samples = values.iter().map(|x| *x as f32).collect();
        parts.push(Part { name, samples });
        let rows = Array2::from_shape_vec((h, w), values.to_vec());
        npz = npz.add(name, &rows.map_err(Failure::cannot_run)?)?;
    }
    results.write(name, &exr([w, h], parts, made_from)?)?;
    Ok(npz)
}

/// Refuses a picture with a pixel that is not finite in 32 bits. If a pixel is not finite, nothing
/// is written.
pub(crate) fn require_finite([w, _]: [usize; 2], radiance: &[f64]) -> Result<(), Failure> {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "EXR files hold 32-bit numbers"
    )]
    let is_lost = |value: &f64| !(*value as f32).is_finite();
    let Some(first) = radiance.iter().position(is_lost) else {
        return Ok(());
    };
    let count = radiance.iter().filter(|value| is_lost(value)).count();
    Err(Failure::bad_input(format!(
        "{count} pixels are not finite, the first at {},{}: numbers of the scene are too large or too small; nothing is written",
        first % w,
        first / w
    )))
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_store::FailureKind;

    #[test]
    fn pixels_that_are_not_finite_are_refused() {
        assert!(require_finite([2, 2], &[0.0, 1.0, 1e30, 1e-300]).is_ok());
        // The first value of the test exceeds the range of 32 bits.
        for lost in [1e39, f64::INFINITY, f64::NAN] {
            let refused = require_finite([2, 2], &[0.0, 1.0, 2.0, lost]).unwrap_err();
            assert_eq!(refused.kind, FailureKind::BadInput);
            assert!(
                refused
                    .message
                    .starts_with("1 pixels are not finite, the first at 1,1")
            );
        }
    }
}
