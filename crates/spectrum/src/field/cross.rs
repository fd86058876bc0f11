//! Computes the full radial spectrum from products of independent groups of batches.

use super::bins::RadialBins;
use super::spectrum::FieldSpectrum;
use crate::jackknife::Jackknife;
use ndarray::Array2;

/// The full radial spectrum of a plane. It is the mean of |ℓ̂|² over two independent azimuths: the
/// azimuth of (Ωx, Ωy) and the azimuth of (Ωu, Ωv).
///
/// Arrays are indexed [|Ωxy|, |Ωuv|], and [`RadialBins`] defines the bins. The unit of the power is
/// the square of the unit of ℓ̂. A full radial spectrum does not show the sign of a shear, but the
/// slices show it.
#[derive(Clone, Debug, PartialEq)]
pub struct FullRadial {
    /// Edges of the bins in |Ωxy|, cycles per metre.
    pub rho_edges: Vec<f64>,
    /// Edges of the bins in |Ωuv|, cycles per unit slope.
    pub nu_edges: Vec<f64>,
    /// Number of frequencies in each bin, including conjugates.
    pub counts: Array2<u64>,
    /// The power without the noise of the photons. The estimate of the power is unbiased except for
    /// aliasing, and noise can make the estimate negative.
    pub power: Array2<f64>,
    /// The power that the photons' noise adds to the mean spectrum; `power` does not include it.
    pub shot_noise: Array2<f64>,
    /// The standard error of `power` by the delete-one jackknife over groups of batches. At
    /// frequencies that contain only noise, this error is about √2 times too large.
    pub sigma: Array2<f64>,
}

/// The power of a spectrum in each bin. The power is computed from products of independent groups
/// that add up to the spectrum (docs/theory.md (13)).
///
/// Group r contains the share a_r of the batches and contributes G_r to the spectrum G = Σ G_r. The
/// expectation of G_r is a_r F, and an unbiased estimate of |F|² is
///
/// U = Σ_(r≠s) Re(G_r conj G_s)/(1 − Σ a²)
///
/// Each group is processed once, after G is known. The result is row_r = Re(G_r conj(G − G_r)), and
/// the sum of row_r over all groups is T, the numerator of U. If group r is left out, the estimate
/// is (T − 2 row_r)/((1 − a_r)² − Σ_(s≠r) a_s²).
pub(crate) struct GroupPower {
    /// The share a_r.
    pub(crate) share: f64,
    row: Array2<f64>,
    own: Array2<f64>,
}

impl GroupPower {
    /// Computes the contribution of a group of batches.
    pub(crate) fn new(
        bins: &RadialBins,
        share: f64,
        group: &FieldSpectrum,
        all: &FieldSpectrum,
    ) -> Self {
        let [with_all, own] = bins.means(|index| {
            let g = group.values[index];
            [(g.conj() * all.values[index]).re, g.norm_sqr()]
        });
        Self {
            share,
            row: with_all - &own,
            own,
        }
    }
}

/// The full radial spectrum from the contributions of all groups.
pub(crate) fn full_radial(bins: &RadialBins, groups: &[&GroupPower]) -> FullRadial {
    let shape = bins.counts.raw_dim();
    let sum = |of: fn(&GroupPower) -> &Array2<f64>| {
        let mut sum = Array2::zeros(shape);
        groups.iter().for_each(|group| sum += of(group));
        sum
    };
    let pairs: Array2<f64> = sum(|group| &group.row);
    let of_sum = sum(|group| &group.own) + &pairs;
    let squares: f64 = groups.iter().map(|group| group.share.powi(2)).sum();
    let power = &pairs / (1.0 - squares);

    let mut jackknife = Jackknife::new(shape);
    for &&GroupPower { share, ref row, .. } in groups {
        let norm = (1.0 - share).powi(2) - (squares - share * share);
        jackknife.add(&((&pairs - &(row * 2.0)) / norm));
    }
    FullRadial {
        rho_edges: bins.edges[0].clone(),
        nu_edges: bins.edges[1].clone(),
        counts: bins.counts.clone(),
        shot_noise: of_sum - &power,
        sigma: jackknife.variance().mapv(f64::sqrt),
        power,
    }
}
