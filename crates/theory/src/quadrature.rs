//! Integrals by Gauss–Legendre rules.

pub(crate) use etendue_transform::gauss_legendre;

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
    use std::f64::consts::PI;

    #[test]
    fn gaussian_integral() {
        let integral = integrate(40, [-3.5, 3.5], |x| libm::exp(-PI * x * x));
        assert!((integral - 1.0).abs() < 1e-14); // tail 1e-17, the rule converges geometrically
    }
}
