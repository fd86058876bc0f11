//! Computes the sampling densities of pixels by distributing a number of samples according to the
//! criterion.

use crate::criterion::shaded;
use crate::metric::Metric;
use crate::visible::Visible;

/// Maximum number of samples per pixel, equal to the number of visible points per pixel.
const DENSEST: f64 = 4.0;

/// Maximum distance of samples in pixels.
const MAX_SPACING: f64 = 32.0;

/// Maximum anisotropy of the density. Finite differences are not accurate enough for a larger
/// anisotropy.
const LONGEST: f64 = 3.0;

/// The metrics of evenly distributed samples.
pub(crate) fn even(visible: &Visible) -> Vec<Option<Metric>> {
    visible.pixels(|pixel| {
        let places = visible.of_pixel(pixel);
        let is_shaded = places.iter().any(|place| shaded(place).is_some());
        is_shaded.then_some(Metric::even(1.0))
    })
}

/// Returns metrics proportional to `wanted` within the bounds. The square root of the determinant
/// of a metric is the number of samples in its pixel, and these numbers add up to `samples`.
pub(crate) fn scaled(wanted: &[Option<Metric>], samples: f64) -> Vec<Option<Metric>> {
    let rates: Vec<Option<f64>> = wanted
        .iter()
        .map(|metric| metric.map(|metric| metric.determinant().max(0.0).sqrt()))
        .collect();
    let sparsest = MAX_SPACING.powi(-2);
    let bounded = |rate: f64, scale: f64| (scale * rate).clamp(sparsest, DENSEST);
    let total = |scale: f64| -> f64 {
        let rates = rates.iter().flatten();
        rates.map(|rate| bounded(*rate, scale)).sum()
    };
    // The sum increases with the scale, so bisection finds the scale.
    let [mut low, mut high] = [-100.0, 100.0];
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if total(libm::exp2(middle)) < samples {
            low = middle;
        } else {
            high = middle;
        }
    }
    let scale = libm::exp2(high);
    let of = |(wanted, rate): (&Option<Metric>, &Option<f64>)| {
        let (wanted, rate) = ((*wanted)?, (*rate)?);
        let density = bounded(rate, scale);
        Some(if rate > 0.0 {
            wanted.times(density / rate)
        } else {
            Metric::even(density)
        })
    };
    wanted.iter().zip(&rates).map(of).collect()
}

/// The metric for a squared bandwidth. If `is_even` is set, the metric is isotropic and
/// has the larger eigenvalue, as in the paper; otherwise it is anisotropic.
pub(crate) fn wanted(squared: Metric, is_even: bool) -> Metric {
    // Along each direction, the number of samples is twice the number of cycles (Shannon), plus a
    // minimum for pixels without bandwidth.
    let shannon = squared
        .times(4.0)
        .plus(Metric::even((4.0 * MAX_SPACING).powi(-2)));
    if is_even {
        Metric::even(shannon.largest())
    } else {
        shannon.rounder(LONGEST)
    }
}

/// The metric whose density is a power of the density of another metric.
pub(crate) fn to_power(metric: Metric, power: f64) -> Metric {
    let density = metric.determinant().max(0.0).sqrt();
    if density > 0.0 {
        metric.times(libm::pow(density, power - 1.0))
    } else {
        metric
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn densities_add_up_in_proportion() {
        let wanted: Vec<Option<Metric>> = (0..1000)
            .map(|i| (i % 10 > 0).then(|| Metric::even(f64::from(i % 10))))
            .collect();
        let found = scaled(&wanted, 45.0);
        let density = |i: usize| found[i].map(|metric| metric.determinant().sqrt());
        let total: f64 = (0..1000).filter_map(density).sum();
        assert!((total - 45.0).abs() < 1e-9, "{total}");
        let ratio = density(9).unwrap() / density(3).unwrap();
        assert!((ratio - 3.0).abs() < 1e-9, "{ratio}");
        assert_eq!(found[10], None);
    }

    #[test]
    fn what_is_beyond_all_bounds_ends_there() {
        let wanted = [Some(Metric::even(1e8)), Some(Metric::even(1e-8))];
        let found = scaled(&wanted, 1.0);
        let [dense, sparse] = [0, 1].map(|i| found[i].unwrap().determinant().sqrt());
        assert!(
            dense <= DENSEST && sparse >= 0.999 * MAX_SPACING.powi(-2),
            "{dense} {sparse}"
        );
    }
}
