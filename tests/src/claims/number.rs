//! Computes numbers from measured spectra. Each number has a standard error, and a prediction by
//! the same estimator.

use etendue_field::{Complex, Slices, decimals, fixed, uncertain, whole};

/// A measured number.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClaimNumber {
    pub(super) value: f64,
    /// Standard error of the difference between the measured and the predicted number.
    pub(super) error: f64,
    /// The number that the same estimator gives for the predicted spectra.
    pub(super) predicted: f64,
}

impl ClaimNumber {
    /// The measured value minus the prediction, in standard errors.
    pub(super) fn pull(&self) -> f64 {
        (self.value - self.predicted) / self.error
    }

    pub(super) fn text(&self) -> String {
        let predicted = fixed(self.predicted, decimals(self.error));
        format!("{} ({predicted})", uncertain(self.value, self.error))
    }

    /// The number and its error divided by `unit`.
    pub(super) fn per(&self, unit: f64) -> Self {
        Self {
            value: self.value / unit,
            error: self.error / unit,
            predicted: self.predicted / unit,
        }
    }

    /// The ratio of two independent numbers.
    pub(super) fn over(&self, other: &Self) -> Self {
        let value = self.value / other.value;
        let share = (self.error / self.value).hypot(other.error / other.value);
        Self {
            value,
            error: (share * value).abs(),
            predicted: self.predicted / other.predicted,
        }
    }
}

/// The slices of independent batches, as one list for each plane from which a number is computed.
pub(super) type Batches = Vec<Vec<Slices>>;

/// A number computed from the mean slices, and its standard error, by the delete-one
/// jackknife. The jackknife also removes the bias of |S|², which is of the order of the noise
/// power (Quenouille 1956).
pub(super) fn jackknife(batches: &Batches, of: &dyn Fn(&[Slices]) -> f64) -> [f64; 2] {
    let count = batches[0].len();
    let sums: Vec<Slices> = batches.iter().map(|each| sum(each)).collect();
    let scaled = |slices: Slices, by: usize| Slices {
        half: slices.half / Complex::from(by as f64),
        ..slices
    };
    let all: Vec<Slices> = sums.iter().map(|s| scaled(s.clone(), count)).collect();
    let all = of(&all);
    let without = |left_out: usize| {
        let pairs = sums.iter().zip(batches);
        let rest = pairs.map(|(sum, each)| Slices {
            half: &sum.half - &each[left_out].half,
            ..sum.clone()
        });
        let rest: Vec<Slices> = rest.map(|s| scaled(s, count - 1)).collect();
        of(&rest)
    };
    let values: Vec<f64> = (0..count).map(without).collect();
    let n = count as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    [n * all - (n - 1.0) * mean, ((n - 1.0) / n * squares).sqrt()]
}

fn sum(batches: &[Slices]) -> Slices {
    let mut sum = Slices::zeros(batches[0].grid);
    for batch in batches {
        sum.half += &batch.half;
    }
    sum
}

/// The value at a frequency of the grid, ρ ≥ 0 and ν ≥ 0, in slice `k`.
pub(super) fn at(slices: &Slices, k: usize, [rho, nu]: [f64; 2]) -> Complex {
    let grid = &slices.grid;
    let m = whole((rho / grid.rho.spacing).round());
    let n = whole((nu / grid.nu.spacing).round()) + grid.nu.half;
    slices.half[[k, m, n]]
}

/// The frequencies ρ ≥ 0 on the line ν = 0 of slice `k`, each with the value of the
/// slice.
pub(super) fn line(slices: &Slices, k: usize) -> Vec<(f64, Complex)> {
    let middle = slices.grid.nu.half;
    let spacing = slices.grid.rho.spacing;
    let each = 0..=slices.grid.rho.half;
    each.map(|m| (m as f64 * spacing, slices.half[[k, m, middle]]))
        .collect()
}

/// The sum of |S|² on the line ν = 0 of slice 0, over the selected frequencies.
pub(super) fn power(slices: &Slices, wanted: impl Fn(f64) -> bool) -> f64 {
    let along = line(slices, 0).into_iter();
    let inside = along.filter(|(rho, _)| wanted(*rho));
    inside.map(|(_, s)| s.norm_sqr()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::{FrequencyAxis, SliceGrid};

    #[test]
    fn the_noise_of_a_power_is_taken_out() {
        let axis = FrequencyAxis {
            half: 0,
            spacing: 1.0,
        };
        let grid = SliceGrid {
            azimuths: 1,
            rho: axis,
            nu: axis,
        };
        let batch = |value: f64| {
            let mut slices = Slices::zeros(grid);
            slices.half.fill(value.into());
            slices
        };
        let values = [1.0, 3.0, 2.0, 6.0];
        let batches = vec![values.map(batch).to_vec()];
        let [power, _] = jackknife(&batches, &|s| s[0].half[[0, 0, 0]].norm_sqr());
        // The expected power is the mean of the products of two different batches: (Σ² − Σ of
        // squares)/(R(R − 1)).
        assert!((power - (144.0 - 50.0) / 12.0).abs() < 1e-12); // rounding
        let [mean, error] = jackknife(&batches, &|s| s[0].at_zero());
        assert!((mean - 3.0).abs() < 1e-12 && (error - (14.0_f64 / 12.0).sqrt()).abs() < 1e-12); // rounding
    }
}
