//! The full radial spectrum from products of independent groups.

use super::bins::RadialBins;
use super::spectrum::FieldSpectrum;
use crate::jackknife::Jackknife;
use ndarray::Array2;

/// The full radial spectrum of a plane: the mean of |ℓ̂|² over the azimuth of (Ωx, Ωy) and,
/// independently, over the azimuth of (Ωu, Ωv).
///
/// Arrays are [|Ωxy|, |Ωuv|]; the bins are those of [`RadialBins`]. Unit: that of ℓ̂, squared. The sign of a shear
/// is lost; the slices keep it.
#[derive(Clone, Debug, PartialEq)]
pub struct FullRadial {
    /// Edges of the bins in |Ωxy|, cycles per metre.
    pub rho_edges: Vec<f64>,
    /// Edges of the bins in |Ωuv|, cycles per unit slope.
    pub nu_edges: Vec<f64>,
    /// Number of frequencies in each bin, including conjugates.
    pub counts: Array2<u64>,
    /// The power without the noise of the photons: unbiased except for aliasing, and possibly
    /// negative due to noise.
    pub power: Array2<f64>,
    /// The contribution of the photons' noise to the power of the mean spectrum; `power` does not
    /// include it.
    pub shot_noise: Array2<f64>,
    /// The standard error of `power` by the delete-one jackknife over groups of batches. It is
    /// about √2 times too large for frequencies with noise alone.
    pub sigma: Array2<f64>,
}

/// The power of a spectrum from products of the independent groups that add up to it
/// (docs/theory.md (13)), bin by bin.
///
/// Group r contains the share a_r of the batches, and its part of the spectrum is G_r, G = Σ G_r. E
/// G_r = a_r F, so
///
/// U = Σ_(r≠s) Re(G_r conj G_s)/(1 − Σ a²)
///
/// is an unbiased estimate of |F|². Each group is processed once, with G known: the result is row_r
/// = Re(G_r conj(G − G_r)), and the sum of these is the numerator T. Without group r the estimate
/// is (T − 2 row_r)/((1 − a_r)² − Σ_(s≠r) a_s²).
pub(crate) struct GroupPower {
    /// The share a_r.
    pub(crate) share: f64,
    row: Array2<f64>,
    own: Array2<f64>,
}

impl GroupPower {
    /// Computes the contribution of a group.
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

/// Returns the full radial spectrum of all groups.
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
