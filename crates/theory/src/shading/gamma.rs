//! The reciprocal of Euler's gamma function.

use libm::lgamma as ln_gamma;
use std::f64::consts::PI;

/// Returns 1/Γ(z) for every real z as a product of two factors: a signed factor, and a factor that
/// is given by its logarithm. The first factor is 0 at z = 0, −1, −2, …
///
/// Below zero the function uses the reflection formula: 1/Γ(z) = sin(πz)/π · Γ(1 − z).
pub(super) fn reciprocal_gamma(z: f64) -> (f64, f64) {
    if z > 0.0 {
        return (1.0, -ln_gamma(z));
    }
    // Subtracts the nearest whole number first, because sin(πz) of a large z would have the
    // rounding error of πz.
    let whole = z.round();
    let sign = if whole.rem_euclid(2.0) < 0.5 {
        1.0
    } else {
        -1.0
    };
    (sign * libm::sin(PI * (z - whole)) / PI, ln_gamma(1.0 - z))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reciprocal(z: f64) -> f64 {
        let (factor, ln) = reciprocal_gamma(z);
        factor * libm::exp(ln)
    }

    #[test]
    fn factorials_and_halves() {
        let mut factorial = 1.0;
        for n in 1..=20 {
            // The limit is the rounding error of ln Γ for arguments up to 40.
            assert!((ln_gamma(f64::from(n)).exp() / factorial - 1.0).abs() < 1e-13);
            factorial *= f64::from(n);
        }
        // The exact values are Γ(1/2) = √π and Γ(−3/2) = 4√π/3.
        assert!((reciprocal(0.5) * PI.sqrt() - 1.0).abs() < 1e-14); // rounding
        assert!((reciprocal(-1.5) * PI.sqrt() * 4.0 / 3.0 - 1.0).abs() < 1e-14); // rounding
    }

    #[test]
    fn poles_are_zeros_of_the_reciprocal() {
        for n in 0..12 {
            let z = -f64::from(n);
            assert!(reciprocal(z).abs() < f64::MIN_POSITIVE, "{z}");
            // Tests 1/Γ(z) = z/Γ(z + 1) on both sides of each pole.
            for z in [z + 0.1, z - 0.1] {
                let step = z * reciprocal(z + 1.0);
                // The limit is the rounding error of ln Γ for arguments up to 20.
                assert!((reciprocal(z) / step - 1.0).abs() < 1e-13, "{z}");
            }
        }
    }
}
