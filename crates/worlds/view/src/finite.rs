//! Checks that pictures are finite before they are written.

use etendue_store::Failure;

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
