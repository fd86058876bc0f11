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

/// Returns sine and cosine of an angle given in turns: sin 2πx and cos 2πx, for |x| below 10¹². This
/// takes less time than `libm::sincos`, because it has no branches. The errors are below
/// 3·10⁻¹⁶.
#[inline]
#[must_use]
pub fn sincos_turns(turns: f64) -> (f64, f64) {
    // Rounds a number to a multiple of 1 when added, and leaves it in the last bits.
    const ROUNDING: f64 = 1.5 * (1_u64 << 52) as f64;
    // Taylor's series, from the highest power down, of (sin a / a − 1) / a² and of
    // (cos a − 1 + a²/2) / a⁴, for |a| up to π/4.
    const SIN: [f64; 7] = [
        -1.0 / 1_307_674_368_000.0,
        1.0 / 6_227_020_800.0,
        -1.0 / 39_916_800.0,
        1.0 / 362_880.0,
        -1.0 / 5_040.0,
        1.0 / 120.0,
        -1.0 / 6.0,
    ];
    const COS: [f64; 7] = [
        1.0 / 20_922_789_888_000.0,
        -1.0 / 87_178_291_200.0,
        1.0 / 479_001_600.0,
        -1.0 / 3_628_800.0,
        1.0 / 40_320.0,
        -1.0 / 720.0,
        1.0 / 24.0,
    ];
    let rounded = 4.0 * turns + ROUNDING;
    let a = std::f64::consts::TAU * (turns - 0.25 * (rounded - ROUNDING));
    let squared = a * a;
    let series = |terms: [f64; 7]| terms.iter().fold(0.0, |sum, term| sum * squared + term);
    let sin = a + a * (squared * series(SIN));
    let cos = 1.0 - 0.5 * squared + squared * (squared * series(COS));
    let quarters = rounded.to_bits();
    let (sin, cos) = if quarters & 1 == 1 {
        (cos, sin)
    } else {
        (sin, cos)
    };
    let signed = |x: f64, bits: u64| f64::from_bits(x.to_bits() ^ ((bits & 2) << 62));
    (signed(sin, quarters), signed(cos, quarters.wrapping_add(1)))
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

/// |z|. No intermediate result overflows or underflows.
#[must_use]
pub fn modulus(z: Complex) -> f64 {
    libm::hypot(z.re, z.im)
}

/// The square root with Re √z ≥ 0. If z is negative, which is the branch cut, the imaginary
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
    use super::{Complex, cis, modulus, power, sincos_turns, square_root};
    use std::f64::consts::TAU;

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
    fn turns_are_those_of_the_library() {
        for k in -20_000..20_000 {
            let turns = f64::from(k) / 8_192.0 + 1e-5 * f64::from(k % 7);
            let (sin, cos) = sincos_turns(turns);
            // The angle itself is rounded by up to 2⁻⁵³ of its size.
            let (s, c) = libm::sincos(TAU * turns.fract());
            assert!((sin - s).abs() < 1.2e-15, "{turns}: {sin} {s}");
            assert!((cos - c).abs() < 1.2e-15, "{turns}: {cos} {c}");
        }
        assert_eq!(sincos_turns(0.25).0.to_bits(), 1.0_f64.to_bits());
        assert_eq!(sincos_turns(0.5).1.to_bits(), (-1.0_f64).to_bits());
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
