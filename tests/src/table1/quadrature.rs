//! Transforms of a Gaussian field in 2D by plain quadrature.

use etendue_field::Complex;
use etendue_theory::geometry::{AffineMap, Matrix};
use std::f64::consts::TAU;

/// Half of the number of nodes along each axis, for traced rays (`NODES`) and for the mapped field
/// (`FINE`).
const NODES: i32 = 60;
const FINE: i32 = 200;
const REACH: f64 = 8.5;

/// Transforms a Gaussian field after its rays have been traced to new coordinates. The transform is
/// computed by the trapezoid rule over the original rays.
pub(super) fn of_rays(
    field: &Matrix<2>,
    to: &dyn Fn([f64; 2]) -> [f64; 2],
    frequencies: &[[f64; 2]],
) -> Vec<Complex> {
    let [[a, b], [_, d]] = *field;
    let det = a * d - b * b;
    let [p, q] = [a, d].map(|s| REACH * s.sqrt() / f64::from(NODES));
    let step = 1e-3 * q;
    let mut sums = vec![Complex::new(0.0, 0.0); frequencies.len()];
    for i in -NODES..=NODES {
        for j in -NODES..=NODES {
            let (x, t) = (f64::from(i) * p, f64::from(j) * q);
            let exponent = 0.5 * (d * x * x - 2.0 * b * x * t + a * t * t) / det;
            if exponent > 40.0 {
                continue;
            }
            let slope = |dx: f64, dt: f64| {
                let (up, down) = (to([x + dx, t + dt]), to([x - dx, t - dt]));
                [0, 1].map(|r: usize| (up[r] - down[r]) / (2.0 * (dx + dt)))
            };
            let ([xx, tx], [xt, tt]) = (slope(1e-3 * p, 0.0), slope(0.0, step));
            let weight = (-exponent).exp() * (xx * tt - xt * tx).abs() * p * q;
            let z = to([x, t]);
            if !weight.is_finite() {
                // If the circle is small, the ray misses the circle.
                continue;
            }
            for (sum, w) in sums.iter_mut().zip(frequencies) {
                *sum += Complex::from_polar(weight, -TAU * (w[0] * z[0] + w[1] * z[1]));
            }
        }
    }
    sums
}

/// Transforms a mapped Gaussian field by the trapezoid rule over its new coordinates.
pub(super) fn of_field(
    field: &Matrix<2>,
    map: &AffineMap<2>,
    frequencies: &[[f64; 2]],
) -> Vec<Complex> {
    let mut sums = vec![Complex::new(0.0, 0.0); frequencies.len()];
    let Some(home) = map.inverse() else {
        return sums;
    };
    let [[a, b], [_, d]] = *field;
    let det = a * d - b * b;
    let after = map.covariance(field);
    let [p, q] = [after[0][0], after[1][1]].map(|s| REACH * s.sqrt() / f64::from(FINE));
    let [x0, t0] = map.offset;
    for i in -FINE..=FINE {
        for j in -FINE..=FINE {
            let z = [x0 + f64::from(i) * p, t0 + f64::from(j) * q];
            let [x, t] = home.apply(z);
            let exponent = 0.5 * (d * x * x - 2.0 * b * x * t + a * t * t) / det;
            if exponent > 40.0 {
                continue;
            }
            for (sum, w) in sums.iter_mut().zip(frequencies) {
                *sum += Complex::from_polar(
                    (-exponent).exp() * p * q,
                    -TAU * (w[0] * z[0] + w[1] * z[1]),
                );
            }
        }
    }
    sums
}

pub(crate) fn apart(a: &[Complex], b: &[Complex]) -> f64 {
    let off: f64 = a.iter().zip(b).map(|(a, b)| (a - b).norm_sqr()).sum();
    (off / b.iter().map(|b| b.norm_sqr()).sum::<f64>()).sqrt()
}

/// A⁻ᵀ Ω, the frequency to which a map moves spectral power at Ω.
pub(crate) fn content(map: &AffineMap<2>, [x, theta]: [f64; 2]) -> Option<[f64; 2]> {
    let [a, b] = map.inverse()?.spectrum_map().matrix;
    Some([a, b].map(|row| row[0] * x + row[1] * theta))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELD: Matrix<2> = [[1.0, 0.3], [0.3, 0.8]];

    #[test]
    fn the_transform_of_a_field_that_stays() {
        let sums = of_rays(&FIELD, &|z| z, &[[0.0, 0.0]]);
        let expected = TAU * (FIELD[0][0] * FIELD[1][1] - FIELD[0][1].powi(2)).sqrt();
        assert!((sums[0].re / expected - 1.0).abs() < 1e-10); // rounding of differences
    }
}
