//! Gauss–Legendre rules.

use std::f64::consts::PI;
use std::sync::OnceLock;

/// The rules by their number of points; each rule is computed once, when it is first used.
static RULES: [OnceLock<Vec<(f64, f64)>>; 256] = [const { OnceLock::new() }; 256];

/// Nodes and weights of the Gauss–Legendre rule of `n` points on (−1, 1), ascending. The
/// rule is exact for polynomials of degree 2n − 1, apart from rounding errors.
#[must_use]
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let found = || (0..n).map(|i| node(n, i)).collect();
    RULES
        .get(n)
        .map_or_else(found, |rule| rule.get_or_init(found).clone())
}

/// Returns root i of the Legendre polynomial of degree n by Newton's method, and its weight 2/((1 −
/// x²) P'(x)²).
fn node(n: usize, i: usize) -> (f64, f64) {
    let mut x = -libm::cos(PI * (i as f64 + 0.75) / (n as f64 + 0.5));
    // Convergence is quadratic from an error below 0.1/n², so after five steps only rounding errors
    // remain.
    for _ in 0..5 {
        let (value, slope) = legendre(n, x);
        x -= value / slope;
    }
    let (_, slope) = legendre(n, x);
    (x, 2.0 / ((1.0 - x * x) * slope * slope))
}

/// The Legendre polynomial of degree n and its derivative, by recurrence.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    for j in 2..=n {
        let j = j as f64;
        (before, value) = (
            value,
            ((2.0 * j - 1.0) * x * value - (j - 1.0) * before) / j,
        );
    }
    (value, n as f64 * (x * value - before) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_up_to_the_last_degree_are_exact() {
        for count in [1_u8, 2, 7, 16, 64] {
            let rule = gauss_legendre(count.into());
            let error = |degree: u8| {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(degree.into())).sum();
                let exact = if degree.is_multiple_of(2) {
                    2.0 / (f64::from(degree) + 1.0)
                } else {
                    0.0
                };
                (sum - exact).abs()
            };
            for degree in 0..2 * count {
                assert!(error(degree) < 1e-14, "{count}, {degree}"); // rounding of values up to 1
            }
            // For ∫ x^2n, the rule of n points has an error of about 4^−n. With many points, this
            // error is below the rounding error.
            assert_eq!(error(2 * count) > 1e-8, count < 16, "{count}");
        }
    }
}
