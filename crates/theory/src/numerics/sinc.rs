//! The transform of the unit box.

/// Returns sin(πt)/(πt), the transform of the unit box, which is 1 at zero.
pub(crate) fn sinc(t: f64) -> f64 {
    let angle = std::f64::consts::PI * t;
    // The next term of the power series, angle²/6, is below rounding error.
    if angle.abs() < 1e-8 {
        1.0
    } else {
        libm::sin(angle) / angle
    }
}
