//! Estimates of the power of a field, part by part, from independent groups of photons.

/// The power of the last octave must be larger than this number of standard errors.
const MIN_OCTAVE: f64 = 4.0;

/// The power of a field in each of its parts: at each frequency, or in each dyadic band.
///
/// The power is estimated from products of independent groups of photons. Therefore it contains no
/// power of the photons' noise, and it may be negative. The unit is the square of the unit of
/// radiance.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerEstimate {
    /// The power of each part; 0 for the mean of the field.
    pub(crate) power: Vec<f64>,
    /// The same, with one group of photons left out.
    pub(crate) without_group: Vec<Vec<f64>>,
    /// Whether a part belongs to the last octave, which the tail repeats.
    pub(crate) is_last: Vec<bool>,
}

/// The shares of groups in all photons, which give unbiased products.
///
/// Group r has the share a_r and contributes G_r to the field G. An unbiased estimate of |f|² is
/// Σ_(r≠s) Re(G_r conj G_s)/(1 − Σ a²) (docs/theory.md (13)).
#[derive(Clone, Debug)]
pub(crate) struct GroupShares {
    shares: Vec<f64>,
    squares: f64,
}

impl GroupShares {
    pub(crate) fn new(shares: Vec<f64>) -> Self {
        let squares = shares.iter().map(|a| a * a).sum();
        Self { shares, squares }
    }

    /// The power from the products Re(G_r conj(G − G_r)) of each group.
    pub(crate) fn power(&self, products: &[f64]) -> f64 {
        products.iter().sum::<f64>() / (1.0 - self.squares)
    }

    /// The power without group `r`.
    pub(crate) fn power_without(&self, products: &[f64], r: usize) -> f64 {
        let square = self.shares[r] * self.shares[r];
        let norm = (1.0 - self.shares[r]).powi(2) - (self.squares - square);
        (products.iter().sum::<f64>() - 2.0 * products[r]) / norm
    }
}

impl PowerEstimate {
    /// The sum of all parts.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.power.iter().sum()
    }

    /// Checks whether the last octave has power above its noise. Otherwise the tail has an unknown
    /// shape, and counts as for independent points.
    #[must_use]
    pub fn has_last_octave(&self) -> bool {
        let (octave, without) = self.estimates(|power| self.last_octave(power));
        octave > MIN_OCTAVE * jackknife_error(&without)
    }

    /// The sum of the parts of `power` that belong to the last octave.
    pub(crate) fn last_octave(&self, power: &[f64]) -> f64 {
        let of_last = power.iter().zip(&self.is_last);
        let of_last = of_last.filter(|(_, is_last)| **is_last);
        of_last.map(|(p, _)| p).sum()
    }

    /// A function of the power, and its estimates without one group.
    pub(crate) fn estimates(&self, of: impl Fn(&[f64]) -> f64) -> (f64, Vec<f64>) {
        let without = self.without_group.iter().map(|power| of(power));
        (of(&self.power), without.collect())
    }
}

/// The standard error of an estimate by the delete-one jackknife.
pub(crate) fn jackknife_error(without: &[f64]) -> f64 {
    let n = without.len() as f64;
    let mean = without.iter().sum::<f64>() / n;
    let squares: f64 = without.iter().map(|value| (value - mean).powi(2)).sum();
    (squares * (n - 1.0) / n).sqrt()
}
