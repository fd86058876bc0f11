//! Functions whose results do not depend on the machine's C library, not even in the last bit. The
//! functions replace functions that `libm` does not have or computes slowly.

/// A complex number of a spectrum.
pub type Complex = num_complex::Complex<f64>;

/// Returns e^(iφ), φ in radians.
#[must_use]
pub fn cis(angle: f64) -> Complex {
    let (sin, cos) = libm::sincos(angle);
    Complex::new(cos, sin)
}

/// Returns x to the power of y for x ≥ 0, in fewer steps than `libm::pow`. The relative error is y
/// ln x times the error of one rounding, and at worst about 10⁻¹³.
#[inline]
#[must_use]
pub fn power(x: f64, y: f64) -> f64 {
    if y == 0.0 {
        1.0
    } else {
        libm::exp(y * libm::log(x))
    }
}

/// Returns |z|. No intermediate result overflows or underflows.
#[must_use]
pub fn modulus(z: Complex) -> f64 {
    libm::hypot(z.re, z.im)
}

/// Returns the square root with Re √z ≥ 0. If z is negative, which is the branch cut, the imaginary
/// part of the root has the sign of Im z.
#[must_use]
pub fn square_root(z: Complex) -> Complex {
    if z == Complex::ZERO {
        return z;
    }
    // The larger part of the root is a sum without cancellation. The smaller part follows from 2 Re
    // √z Im √z = Im z.
    let larger = (0.5 * (modulus(z) + z.re.abs())).sqrt();
    let other = 0.5 * z.im / larger;
    if z.re >= 0.0 {
        Complex::new(larger, other)
    } else {
        Complex::new(other.abs(), larger.copysign(z.im))
    }
}

#[cfg(test)]
mod tests {
    use super::{Complex, cis, modulus, power, square_root};

    #[test]
    fn powers_are_those_of_the_library() {
        for x in [1e-3, 0.02, 0.7, 0.9999, 1.0, 3.1, 1e3] {
            for y in [-2.0, -0.5, 0.0, 0.03, 1.0, 90.0] {
                let off = (power(x, y) / libm::pow(x, y) - 1.0).abs();
                let bound = 3e-16 * (2.0 + (y * libm::log(x)).abs());
                assert!(off < bound, "{x}^{y}: {off}");
            }
        }
        let of_zero = [power(0.0, 0.0), power(0.0, 0.5)];
        assert_eq!(of_zero.map(f64::to_bits), [1.0, 0.0].map(f64::to_bits));
    }

    #[test]
    fn roots_square_to_their_argument() {
        for k in 0..48 {
            for size in [1e-200, 1e-3, 1.0, 7.0, 1e200] {
                let z = cis(0.13 * f64::from(k)) * size;
                let root = square_root(z);
                assert!(modulus(root * root - z) < 1e-15 * size, "{z}"); // rounding
                assert!(root.re >= 0.0);
            }
        }
        assert_eq!(square_root(Complex::ZERO), Complex::ZERO);
        assert_eq!(square_root((-4.0).into()), Complex::new(0.0, 2.0));
        assert_eq!(
            square_root(Complex::new(-4.0, -0.0)),
            Complex::new(0.0, -2.0)
        );
    }
}
