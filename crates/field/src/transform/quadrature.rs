/// Nodes and weights of the Gauss–Legendre rule of `count` points on (0, 1), by Newton's iteration on
/// the Legendre polynomial (Press et al. 2007, Numerical Recipes, section 4.6). Exact to rounding for
/// polynomials of degree 2 `count` − 1.
pub(crate) fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    (0..count)
        .map(|i| {
            let mut z = (std::f64::consts::PI * (i as f64 + 0.75) / (count as f64 + 0.5)).cos();
            // Convergence is quadratic from this start: six steps reach rounding for any count used here.
            for _ in 0..6 {
                let (value, slope) = legendre(count, z);
                z -= value / slope;
            }
            let (_, slope) = legendre(count, z);
            let weight = 1.0 / ((1.0 - z * z) * slope * slope);
            (0.5 * (1.0 - z), weight)
        })
        .collect()
}

/// The Legendre polynomial of `degree` ≥ 1 at |z| < 1, and its derivative.
fn legendre(degree: usize, z: f64) -> (f64, f64) {
    let (mut before, mut now) = (1.0, z);
    for n in 1..degree {
        let n = n as f64;
        (before, now) = (now, ((2.0 * n + 1.0) * z * now - n * before) / (n + 1.0));
    }
    let slope = degree as f64 * (z * now - before) / (z * z - 1.0);
    (now, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_up_to_the_last_degree_are_exact() {
        for count in [1_u8, 2, 7, 16] {
            let rule = gauss_legendre(count.into());
            let error = |degree: u8| {
                let degree = i32::from(degree);
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(degree)).sum();
                (sum - 1.0 / (f64::from(degree) + 1.0)).abs()
            };
            for degree in 0..2 * count {
                assert!(
                    error(degree) < 1e-15 * f64::from(count),
                    "{count}, {degree}"
                ); // rounding
            }
            // The rule of n points misses ∫ x^2n by about 4^−2n; with 16 points that is below rounding.
            assert_eq!(error(2 * count) > 1e-10, count < 16, "{count}");
        }
    }
}
