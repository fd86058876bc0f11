//! Statistical functions that the calibration uses.

/// The probability that the maximum deviation of the empirical distribution of `count`
/// uniform numbers is at least `distance` (Kolmogorov's series, with Stephens' 1970 correction for
/// finite counts).
pub(crate) fn kolmogorov(distance: f64, count: usize) -> f64 {
    let root = (count as f64).sqrt();
    let t = (root + 0.12 + 0.11 / root) * distance;
    let term = |k: i32| {
        let k = f64::from(k);
        let sign = if k % 2.0 == 0.0 { -1.0 } else { 1.0 };
        sign * (-2.0 * (k * t).powi(2)).exp()
    };
    (2.0 * (1..=100).map(term).sum::<f64>()).clamp(0.0, 1.0)
}

/// The Kolmogorov–Smirnov p-value of the hypothesis that `values` are uniform on (0, 1).
pub(crate) fn uniformity(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let distance = sorted
        .iter()
        .enumerate()
        .map(|(i, p)| (p - i as f64 / n).max((i + 1) as f64 / n - p))
        .fold(0.0, f64::max);
    kolmogorov(distance, sorted.len())
}

/// The mean of values and the standard error of this mean.
pub(crate) fn mean(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let spread: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    [mean, (spread / (n * (n - 1.0))).sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kolmogorov_has_its_tabulated_quantiles() {
        // The asymptotic 5 % and 1 % points of the distribution are 1.3581 and 1.6276 (Smirnov
        // 1948).
        for (t, p) in [(1.3581, 0.05), (1.6276, 0.01)] {
            let n = 1_000_000;
            assert!((kolmogorov(t / 1e3, n) - p).abs() < 1e-4); // four digits of the table, and 0.12/√n
        }
    }

    #[test]
    fn uniform_passes_and_skewed_fails() {
        let uniform: Vec<f64> = (0..1000).map(|i| (f64::from(i) + 0.5) / 1000.0).collect();
        let skewed: Vec<f64> = uniform.iter().map(|p| p.powf(1.2)).collect();
        assert!(uniformity(&uniform) > 0.99);
        assert!(uniformity(&skewed) < 0.01);
    }
}
