use std::f64::consts::PI;
use std::sync::OnceLock;

/// Rules are found once.
static RULES: [OnceLock<Vec<(f64, f64)>>; 256] = [const { OnceLock::new() }; 256];

/// Nodes and weights of Gauss-Legendre quadrature on (−1, 1), exact for polynomials of degree 2n − 1.
pub(crate) fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let found = || (0..n).map(|i| node(n, i)).collect();
    RULES
        .get(n)
        .map_or_else(found, |rule| rule.get_or_init(found).clone())
}

/// Root i of the Legendre polynomial of degree n by Newton's method, and its weight 2/((1 − x²) P'(x)²).
fn node(n: usize, i: usize) -> (f64, f64) {
    let mut x = -(PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
    // Quadratic convergence from an error below 0.1/n²: five steps reach rounding.
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

/// ∫ f over (low, high), with n nodes.
pub(crate) fn integrate<T>(n: usize, [low, high]: [f64; 2], f: impl Fn(f64) -> T) -> T
where
    T: std::iter::Sum + std::ops::Mul<f64, Output = T>,
{
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let nodes = gauss_legendre(n).into_iter();
    nodes
        .map(|(x, weight)| f(middle + half * x) * (weight * half))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_for_polynomials() {
        for (n, degree) in [(2, 2), (3, 4), (5, 8), (16, 30), (64, 126)] {
            let integral = integrate(n, [-1.0, 1.0], |x| x.powi(degree));
            let expected = 2.0 / f64::from(degree + 1);
            assert!((integral - expected).abs() < 1e-14, "{n}"); // rounding of values up to 1
        }
    }

    #[test]
    fn gaussian_integral() {
        let integral = integrate(40, [-3.5, 3.5], |x| (-PI * x * x).exp());
        assert!((integral - 1.0).abs() < 1e-14); // tail 1e-17, the rule converges geometrically
    }
}
