//! The slope of a variance against the number of points.

use etendue_spectrum::Uncertain;

/// Fits log Var = c + slope · log N to variances at numbers of points, by least squares. Each
/// variance counts with the inverse square of its relative error; if `is_weighted` is not set, all
/// count the same. The error of the slope comes from the errors of the variances; they are treated
/// as independent. Returns `None` if fewer than two variances are positive.
#[must_use]
pub fn fitted_slope(variances: &[(usize, Uncertain)], is_weighted: bool) -> Option<Uncertain> {
    let usable = variances.iter().filter(|(_, var)| var.value > 0.0);
    let points: Vec<[f64; 3]> = usable
        .map(|(n, var)| {
            let relative = var.error / var.value;
            [
                libm::log(*n as f64),
                libm::log(var.value),
                relative * relative,
            ]
        })
        .collect();
    let weight = |p: &[f64; 3]| {
        if is_weighted && p[2] > 0.0 {
            1.0 / p[2]
        } else {
            1.0
        }
    };
    let all: f64 = points.iter().map(weight).sum();
    let mean = |i: usize| points.iter().map(|p| weight(p) * p[i]).sum::<f64>() / all;
    let [x, y] = [mean(0), mean(1)];
    let spread: f64 = points.iter().map(|p| weight(p) * (p[0] - x).powi(2)).sum();
    if points.len() < 2 || spread <= 0.0 {
        return None;
    }
    let products: f64 = points
        .iter()
        .map(|p| weight(p) * (p[0] - x) * (p[1] - y))
        .sum();
    let of_errors = points
        .iter()
        .map(|p| (weight(p) * (p[0] - x)).powi(2) * p[2]);
    Some(Uncertain {
        value: products / spread,
        error: of_errors.sum::<f64>().sqrt() / spread,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_has_its_slope() {
        let variance = |(n, error): (usize, f64)| {
            let value = 3.0 / (n as f64).powi(2);
            (
                n,
                Uncertain {
                    value,
                    error: error * value,
                },
            )
        };
        let all = [(4, 0.1), (16, 0.2), (64, 0.1)].map(variance);
        for is_weighted in [false, true] {
            let slope = fitted_slope(&all, is_weighted).unwrap();
            assert!((slope.value + 2.0).abs() < 1e-12); // rounding
        }
        // With equal errors e, the error of the slope is e/√(2 ln²4).
        let equal = [(4, 0.1), (16, 0.1), (64, 0.1)].map(variance);
        let slope = fitted_slope(&equal, true).unwrap();
        let expected = 0.1 / (2.0_f64.sqrt() * 4.0_f64.ln());
        assert!((slope.error - expected).abs() < 1e-12); // rounding
        assert_eq!(fitted_slope(&all[..1], true), None);
    }
}
