//! The kernel K(t). Light that leaves the receiver at coordinate t contributes K(t) to the spectrum
//! under a window beyond the receiver.

use crate::parallel::row::{ComplexRow, FrequencyRow, add_scaled};
use crate::quadrature::gauss_legendre;
use etendue_field::{Complex, Profile, cis, whole};
use ndarray::{Array2, aview1};
use std::f64::consts::TAU;

/// The profiles of a window along one axis, in position and slope. The window is `after` metres
/// past the receiver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KernelAxis {
    pub(crate) position: Profile,
    pub(crate) slope: Profile,
    pub(crate) after: f64,
}

/// Real and imaginary parts of kernels, as [frequency, node].
#[derive(Debug)]
pub(crate) struct Kernels {
    pub(crate) re: Array2<f64>,
    pub(crate) im: Array2<f64>,
}

impl KernelAxis {
    /// The largest absolute coordinate among the points of the receiver that are seen
    /// through the window.
    pub(crate) fn reach(&self) -> f64 {
        self.position.half_width() + self.after * self.slope.half_width()
    }

    /// K(t) = ∫ W(t + a u) W(u) e^(−2πi(ω (t + a u) + ν u)) du at some coordinates t and
    /// one frequency (docs/theory.md (19)).
    pub(crate) fn at(&self, coordinates: &[f64], [omega, nu]: [f64; 2]) -> Vec<Complex> {
        let rule = self.rule([omega, nu]);
        let wave = |x: f64, u: f64| cis(-TAU * (omega * x + nu * u));
        let kernel = |&t: &f64| self.rays(t, &rule).map(|(w, x, u)| wave(x, u) * w).sum();
        coordinates.iter().map(kernel).collect()
    }

    /// K at some coordinates for all slope frequencies ν of a row.
    pub(crate) fn along(&self, coordinates: &[f64], row: &FrequencyRow) -> Kernels {
        let rule = self.rule([row.position, row.step * row.half as f64]);
        let mut re = Array2::zeros((row.count(), coordinates.len()));
        let mut im = re.clone();
        for (i, &t) in coordinates.iter().enumerate() {
            let column = self.column(t, row, &rule);
            re.column_mut(i).assign(&aview1(&column.re));
            im.column_mut(i).assign(&aview1(&column.im));
        }
        Kernels { re, im }
    }

    fn column(&self, t: f64, row: &FrequencyRow, rule: &[(f64, f64)]) -> ComplexRow {
        let mut sum = ComplexRow::zeros(row.count());
        let mut wave = ComplexRow::zeros(row.count());
        for (weight, x, u) in self.rays(t, rule) {
            row.exponentials([x, u], weight, &mut wave);
            add_scaled(&mut sum.re, &wave.re, 1.0);
            add_scaled(&mut sum.im, &wave.im, 1.0);
        }
        sum
    }

    /// The range of slopes for which light from the coordinate t of the receiver is inside
    /// the window; the range is empty if no light from this coordinate is inside.
    fn slopes(&self, t: f64) -> [f64; 2] {
        let (h, k) = (self.position.half_width(), self.slope.half_width());
        if self.after <= 0.0 {
            return [-k, k];
        }
        let [low, high] = [-h, h].map(|edge| (edge - t) / self.after);
        let low = low.max(-k);
        [low, high.min(k).max(low)]
    }

    /// Rays from coordinate t of the receiver through the window, one for each node of the
    /// rule. Each ray is returned as weight, position and slope.
    fn rays(&self, t: f64, rule: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64, f64)> {
        let [low, high] = self.slopes(t);
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        rule.iter().map(move |&(node, weight)| {
            let u = middle + half * node;
            let x = t + self.after * u;
            let window = self.position.value(x) * self.slope.value(u);
            (weight * half * window, x, u)
        })
    }

    /// A Gauss rule on (−1, 1) with enough nodes for a frequency.
    fn rule(&self, frequency: [f64; 2]) -> Vec<(f64, f64)> {
        gauss_legendre(whole(self.nodes(frequency)))
    }

    /// The number of nodes of the rule for a frequency. It is the number that the
    /// oscillations of the integrand require, plus a constant for an accuracy of 10⁻¹⁴.
    pub(super) fn nodes(&self, frequency: [f64; 2]) -> f64 {
        let waves = 2.0 * self.slope.half_width() * self.fastest(frequency);
        // Gauss rules begin to converge at π/2 nodes per oscillation of the integrand.
        (16.0 + 1.7 * waves).ceil()
    }

    /// The highest frequency along u of the product of the exponential and the window.
    fn fastest(&self, [omega, nu]: [f64; 2]) -> f64 {
        let fastest = |profile: &Profile| {
            let terms = profile.cosine_terms();
            terms.iter().fold(0.0, |m: f64, c| m.max(c.frequency))
        };
        let window = self.after * fastest(&self.position) + fastest(&self.slope);
        self.after * omega.abs() + nu.abs() + window
    }
}
