//! Computes the covariance of a power spectrum over all four frequencies together.

use super::spectrum::FieldSpectrum;
use crate::jackknife::Jackknife;
use etendue_field::{FieldGrid, SliceGrid};
use ndarray::Array2;
use rayon::prelude::*;

/// A matrix over (ρx, ρy, νu, νv).
type FrequencyMatrix = [[f64; 4]; 4];

/// Number of distinct entries of a symmetric 4 × 4 matrix, plus one for the power.
const COUNT: usize = 11;

/// The moments ∫ P and ∫ P Ωᵢ Ωⱼ over a band of frequencies, for a power P = |ℓ̂|².
///
/// If the band contains the entire spectrum, the covariance of the spectrum, ∫ P Ω Ωᵀ/∫ P, equals
/// the ratio ∫ ∇ℓ ∇ℓᵀ/(4π² ∫ ℓ²) of the windowed light field. If the field has an edge, neither of
/// these two ratios exists: P falls only as Ω⁻² along the normal of the edge, so the second moments
/// grow with the band. Each result therefore belongs to a band, and only results over the same band
/// can be compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerMoments {
    /// ∫ P, up to a factor that all moments share.
    pub power: f64,
    /// ∫ P Ωᵢ Ωⱼ, cycles² per unit of the coordinates, squared.
    pub second: FrequencyMatrix,
}

impl PowerMoments {
    fn new([power, upper @ ..]: [f64; COUNT]) -> Self {
        let mut second = [[0.0; 4]; 4];
        for ((i, j), sum) in pairs().zip(upper) {
            second[i][j] = sum;
            second[j][i] = sum;
        }
        Self { power, second }
    }

    /// ∫ P Ω Ωᵀ/∫ P. Returns `None` if ∫ P is zero, or if noise makes ∫ P negative.
    #[must_use]
    pub fn covariance(&self) -> Option<FrequencyMatrix> {
        let of = |row: [f64; 4]| row.map(|sum| sum / self.power);
        (self.power > 0.0).then(|| self.second.map(of))
    }
}

/// The index pairs (i, j) with i ≤ j, in ascending order.
fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..4).flat_map(|i| (i..4).map(move |j| (i, j)))
}

/// The band of frequencies over which moments are computed. The band contains those frequencies of
/// a 4D grid for which |Ωx| and |Ωy| are at most ρ_max, and |Ωu| and |Ωv| are at most ν_max. Here
/// ρ_max and ν_max are the largest frequencies of the slices of a plane. Frequencies at Nyquist are
/// excluded.
#[derive(Clone, Debug)]
pub struct Moments {
    grid: FieldGrid,
    /// The largest frequency along each axis, cycles per unit.
    pub band: [f64; 4],
}

impl Moments {
    /// The band of the frequencies of `slices`.
    #[must_use]
    pub fn new(grid: FieldGrid, slices: &SliceGrid) -> Self {
        let [rho, nu] = [slices.rho.max(), slices.nu.max()];
        Self {
            grid,
            band: [rho, rho, nu, nu],
        }
    }

    /// The band whose largest frequencies are half of the largest frequencies of this band.
    fn halved(&self) -> Self {
        Self {
            grid: self.grid,
            band: self.band.map(|most| 0.5 * most),
        }
    }

    /// The moments of a power that is even in Ω. `power` is called with the indices of a
    /// frequency in a transform, and only for Ωv ≥ 0.
    ///
    /// The power is summed for each Ωx, and these sums are added in order, so the result is
    /// bitwise identical on any number of threads.
    #[must_use]
    pub fn of(&self, power: impl Fn([usize; 4]) -> f64 + Sync) -> PowerMoments {
        let [xs, ys, us, vs] = [0, 1, 2, 3].map(|axis| self.along(axis));
        let slab = |x: &(usize, f64)| {
            let mut sums = [0.0; COUNT];
            for y in &ys {
                for u in &us {
                    for v in vs.iter().filter(|(_, omega)| *omega >= 0.0) {
                        // If Ωv > 0, the conjugate frequency counts too.
                        let weight = if v.0 == 0 { 1.0 } else { 2.0 };
                        let p = weight * power([x.0, y.0, u.0, v.0]);
                        add(&mut sums, p, [x.1, y.1, u.1, v.1]);
                    }
                }
            }
            sums
        };
        let slabs: Vec<_> = xs.par_iter().map(slab).collect();
        let mut all = [0.0; COUNT];
        for slab in slabs {
            all.iter_mut().zip(slab).for_each(|(sum, s)| *sum += s);
        }
        PowerMoments::new(all)
    }

    /// The moments of a power that is a function of frequencies.
    #[must_use]
    pub fn at_frequencies(&self, power: impl Fn([f64; 4]) -> f64 + Sync) -> PowerMoments {
        self.of(|index| power(self.grid.frequency(index)))
    }

    /// The indices and the frequencies of the band along an axis.
    fn along(&self, axis: usize) -> Vec<(usize, f64)> {
        let (n, spacing) = (self.grid.cells[axis], self.grid.spacing(axis));
        // The tolerance covers rounding errors if the largest frequency is a multiple of the
        // spacing.
        let most = self.band[axis] * (1.0 + 1e-9);
        let all = (0..n).map(|i| (i, self.grid.harmonic(axis, i)));
        let inside = all.filter(|(_, harmonic)| 2 * harmonic.unsigned_abs() < n);
        let inside = inside.map(|(i, harmonic)| (i, harmonic as f64 * spacing));
        inside.filter(|(_, omega)| omega.abs() <= most).collect()
    }
}

fn add(sums: &mut [f64; COUNT], p: f64, omega: [f64; 4]) {
    sums[0] += p;
    for ((i, j), sum) in pairs().zip(&mut sums[1..]) {
        *sum += p * omega[i] * omega[j];
    }
}

/// The contribution of a group of batches to the moments of the spectrum. It is computed from
/// Re(G_r conj(G − G_r)), as in [`GroupPower`](super::cross::GroupPower).
#[derive(Clone, Debug)]
pub(crate) struct GroupMoments {
    share: f64,
    row: PowerMoments,
    /// The moments over half of the band of frequencies.
    half: PowerMoments,
}

impl GroupMoments {
    pub(crate) fn new(
        moments: &Moments,
        share: f64,
        group: &FieldSpectrum,
        all: &FieldSpectrum,
    ) -> Self {
        let crossed = |index: [usize; 4]| {
            let g = group.values[index];
            (g.conj() * (all.values[index] - g)).re
        };
        Self {
            share,
            row: moments.of(crossed),
            half: moments.halved().of(crossed),
        }
    }
}

/// The covariance of a spectrum, measured without bias due to noise.
///
/// Photon noise adds a constant power at all frequencies, and this power would dominate second
/// moments. Therefore, |G|² is replaced by the products Re(G_r conj G_s) of different groups of
/// batches, over all pairs r ≠ s. With these products, ∫ P and ∫ P Ω Ωᵀ are unbiased for any number
/// of photons (docs/theory.md (13)). The error of the ratio of ∫ P Ω Ωᵀ to ∫ P is of second order
/// in the noise.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldCovariance {
    /// The largest frequency along each axis, cycles per unit.
    pub band: [f64; 4],
    /// The moments.
    pub moments: PowerMoments,
    /// The moments over half of the band of frequencies.
    half: PowerMoments,
    /// For each group, the moments of all other groups, up to a common factor.
    without: Vec<PowerMoments>,
}

/// A matrix with the standard error of each entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatrixEstimate {
    /// The matrix over (ρx, ρy, νu, νv), cycles² per unit of the coordinates, squared.
    pub value: FrequencyMatrix,
    /// The standard errors, by the delete-one jackknife over groups of batches.
    pub error: FrequencyMatrix,
}

impl FieldCovariance {
    pub(crate) fn new<'a>(
        moments: &Moments,
        groups: impl Iterator<Item = &'a GroupMoments> + Clone,
    ) -> Self {
        let sum = |of: fn(&GroupMoments) -> &PowerMoments| {
            let mut all = [0.0; COUNT];
            for group in groups.clone() {
                let row = entries(of(group));
                all.iter_mut().zip(row).for_each(|(sum, r)| *sum += r);
            }
            all
        };
        let all = sum(|group| &group.row);
        let half = PowerMoments::new(sum(|group| &group.half));
        let squares: f64 = groups.clone().map(|group| group.share.powi(2)).sum();
        let without = groups.map(|group| {
            let mut left = all;
            let row = entries(&group.row);
            left.iter_mut()
                .zip(row)
                .for_each(|(sum, r)| *sum -= 2.0 * r);
            PowerMoments::new(left)
        });
        Self {
            band: moments.band,
            half,
            without: without.collect(),
            moments: PowerMoments::new(all.map(|sum| sum / (1.0 - squares))),
        }
    }

    /// The covariance; `None` if the power is not above the noise.
    #[must_use]
    pub fn estimate(&self) -> Option<MatrixEstimate> {
        self.estimate_of(|matrix| Some(*matrix))
    }

    /// The growth of each variance, which is its value over the entire band divided by its
    /// value over half of the band. The growth is 1 if half of the band contains the spectrum, and
    /// about 2 if the field has an edge. The growth is larger if replicas lie beyond half of the
    /// band. The spectrum of a field with an edge has no second moment. Returns `None` if the power
    /// is not above the noise.
    #[must_use]
    pub fn growth(&self) -> Option<[f64; 4]> {
        let [all, half] = [self.moments.covariance()?, self.half.covariance()?];
        Some([0, 1, 2, 3].map(|i: usize| all[i][i] / half[i][i]))
    }

    /// The estimate of a matrix that is a function of the covariance, such as its image
    /// under a map. Returns `None` if this matrix does not exist, either for all groups together
    /// or if any one group is left out.
    pub fn estimate_of(
        &self,
        of: impl Fn(&FrequencyMatrix) -> Option<FrequencyMatrix>,
    ) -> Option<MatrixEstimate> {
        let value = of(&self.moments.covariance()?)?;
        let mut jackknife = Jackknife::new(ndarray::Ix2(4, 4));
        for without in &self.without {
            let matrix = of(&without.covariance()?)?;
            jackknife.add(&Array2::from_shape_fn((4, 4), |(i, j)| matrix[i][j]));
        }
        let variance = jackknife.variance();
        let error = |i: usize, j: usize| variance[[i, j]].sqrt();
        Some(MatrixEstimate {
            value,
            error: [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| error(i, j))),
        })
    }
}

fn entries(moments: &PowerMoments) -> [f64; COUNT] {
    let mut all = [moments.power; COUNT];
    let upper = pairs().map(|(i, j)| moments.second[i][j]);
    all[1..].iter_mut().zip(upper).for_each(|(a, b)| *a = b);
    all
}
