//! Tail probabilities for tests of two samples.

use std::f64::consts::SQRT_2;

/// The largest number of terms of a series or a continued fraction. About 200 terms are enough for
/// a thousand degrees of freedom.
const MAX_TERMS: u32 = 1_000_000;
/// A series or a continued fraction ends when its relative change is below this limit, which is the
/// rounding error of f64.
const ROUNDING: f64 = 1e-16;

/// The probability that a χ² variable with `dof` degrees of freedom exceeds `x`. `dof` is
/// any positive number.
///
/// The probability is Q(dof/2, x/2), the upper regularised incomplete gamma function. Q is computed
/// from its series below x = dof + 2 and from its continued fraction above (Abramowitz and Stegun
/// 1964, 6.5.29 and 6.5.31).
#[must_use]
pub fn chi_squared_above(x: f64, dof: f64) -> f64 {
    let (a, x) = (0.5 * dof, 0.5 * x);
    if x <= 0.0 {
        return 1.0;
    }
    if !x.is_finite() {
        return 0.0;
    }
    let factor = libm::exp(a * libm::log(x) - x - libm::lgamma(a));
    let above = if x < a + 1.0 {
        1.0 - factor * lower_series(a, x)
    } else {
        factor * upper_fraction(a, x)
    };
    above.clamp(0.0, 1.0)
}

/// Σ xⁿ/(a (a + 1) … (a + n)).
fn lower_series(a: f64, x: f64) -> f64 {
    let mut term = 1.0 / a;
    let mut sum = term;
    for n in 1..MAX_TERMS {
        term *= x / (a + f64::from(n));
        sum += term;
        if term < ROUNDING * sum {
            break;
        }
    }
    sum
}

/// Computes 1/(x + 1 − a − 1(1 − a)/(x + 3 − a − …)) by Lentz's method.
fn upper_fraction(a: f64, x: f64) -> f64 {
    let mut b = x + 1.0 - a;
    let mut c = f64::INFINITY;
    let mut d = 1.0 / b;
    let mut fraction = d;
    for n in 1..MAX_TERMS {
        let n = f64::from(n);
        let numerator = n * (a - n);
        b += 2.0;
        d = 1.0 / (b + numerator * d);
        c = b + numerator / c;
        fraction *= c * d;
        if (c * d - 1.0).abs() < 2.0 * ROUNDING {
            break;
        }
    }
    fraction
}

/// The probability that the absolute value of Student's t with `dof` degrees of freedom is
/// at least |`t`|.
///
/// The function uses the normal deviate that has about the same tail (Wallace 1959). With at least
/// 30 degrees of freedom, the relative error of the probability is below 1 %. This limit was
/// checked for probabilities down to 10⁻⁶.
pub(crate) fn student_beyond(t: f64, dof: f64) -> f64 {
    let shrink = (8.0 * dof + 1.0) / (8.0 * dof + 3.0);
    let normal = shrink * (dof * libm::log1p(t * t / dof)).sqrt();
    libm::erfc(normal / SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chi_squared_has_its_tabulated_quantiles() {
        // These values are from Abramowitz and Stegun 1964, table 26.8: Q(χ²|ν).
        for (x, dof, p) in [
            (3.84146, 1.0, 0.05),
            (18.3070, 10.0, 0.05),
            (63.6907, 40.0, 0.01),
            (149.449, 100.0, 0.001),
            (77.9295, 100.0, 0.95),
        ] {
            let found = chi_squared_above(x, dof);
            // The table gives x to six digits, so the error of x is at most 5e-4. The tail falls by
            // a fifth per unit of x.
            assert!((found / p - 1.0).abs() < 1e-4, "{x} {dof}: {found}");
        }
        // With two degrees of freedom the tail is exponential.
        assert!((chi_squared_above(9.0, 2.0) / (-4.5f64).exp() - 1.0).abs() < 1e-13); // rounding
        assert!(chi_squared_above(0.0, 5.0) > 1.0 - 1e-15 && chi_squared_above(1e9, 5.0) < 1e-300);
    }

    #[test]
    fn many_degrees_of_freedom_are_normal() {
        // Wilson and Hilferty 1931: (χ²/ν)^(1/3) is normal around 1 − 2/(9ν).
        for dof in [5e3, 1e5] {
            for z in [-3.0, -0.5, 0.0, 1.0, 3.0] {
                let k = 2.0 / (9.0 * dof);
                let x = dof * (1.0 - k + z * f64::sqrt(k)).powi(3);
                let normal = 0.5 * libm::erfc(z / SQRT_2);
                let found = chi_squared_above(x, dof);
                assert!((found / normal - 1.0).abs() < 1e-3, "{dof} {z}: {found}"); // their error at 5000
            }
        }
    }

    #[test]
    fn student_has_its_tabulated_quantiles() {
        // These two-sided values are from Abramowitz and Stegun 1964, table 26.10.
        for (t, dof, p) in [
            (2.042, 30.0, 0.05),
            (3.646, 30.0, 0.001),
            (2.617, 120.0, 0.01),
            (3.373, 120.0, 0.001),
        ] {
            let found = student_beyond(t, dof);
            assert!((found / p - 1.0).abs() < 0.01, "{t} {dof}: {found}"); // the stated error of the formula
        }
        assert!((student_beyond(0.0, 62.0) - 1.0).abs() < 1e-15);
    }
}
