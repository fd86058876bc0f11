//! Frequency grids.

use serde::Serialize;

/// An odd number of evenly spaced frequencies with zero at the centre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrequencyAxis {
    /// Number of frequencies on either side of zero; the axis has 2 `half` + 1 frequencies.
    pub half: usize,
    /// Spacing, in cycles per unit (cycles per metre, or per unit slope).
    pub spacing: f64,
}

impl FrequencyAxis {
    /// The number of frequencies, which is odd.
    #[must_use]
    pub fn count(&self) -> usize {
        2 * self.half + 1
    }

    /// The largest frequency.
    #[must_use]
    pub fn max(&self) -> f64 {
        self.half as f64 * self.spacing
    }

    /// The frequency at `index`, 0 ≤ index < count. Frequencies ascend, and the frequency
    /// at `half` is zero.
    #[must_use]
    pub fn value(&self, index: usize) -> f64 {
        (index as f64 - self.half as f64) * self.spacing
    }

    /// All frequencies, ascending.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        (0..self.count()).map(|i| self.value(i)).collect()
    }
}

/// The frequencies of a set of slices: at azimuth φ, the point (ρ, ν) of a slice is the 4D frequency
/// (Ωx, Ωy, Ωu, Ωv) = (ρ cos φ, ρ sin φ, ν cos φ, ν sin φ).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SliceGrid {
    /// Number K of azimuths φ_k = π k / K.
    pub azimuths: usize,
    /// Signed spatial frequency ρ, cycles per metre.
    pub rho: FrequencyAxis,
    /// Signed angular frequency ν, cycles per unit slope.
    pub nu: FrequencyAxis,
}

impl SliceGrid {
    /// The azimuth φ_k, in radians.
    #[must_use]
    pub fn azimuth(&self, k: usize) -> f64 {
        std::f64::consts::PI * k as f64 / self.azimuths as f64
    }

    /// The 4D frequency (Ωx, Ωy, Ωu, Ωv) of slice `k` at (ρ, ν).
    #[must_use]
    pub fn frequency(&self, k: usize, rho: f64, nu: f64) -> [f64; 4] {
        let (s, c) = libm::sincos(self.azimuth(k));
        [rho * c, rho * s, nu * c, nu * s]
    }

    /// The shape [K, half of ρ: ρ ≥ 0, ν] in which [`Slices`](crate::Slices) are stored.
    #[must_use]
    pub fn half_shape(&self) -> [usize; 3] {
        [self.azimuths, self.rho.half + 1, self.nu.count()]
    }

    /// The shape [K, ρ, ν] of all frequencies.
    #[must_use]
    pub fn full_shape(&self) -> [usize; 3] {
        [self.azimuths, self.rho.count(), self.nu.count()]
    }

    /// Checks whether the cell (m, n) of the half-plane ρ = m·spacing ≥ 0 is one of the independent
    /// cells.
    ///
    /// On the line ρ = 0, the values at −ν are the conjugates of the values at ν, so only half of
    /// them count.
    #[must_use]
    pub fn is_independent(&self, m: usize, n: usize) -> bool {
        m > 0 || n >= self.nu.half
    }
}
