//! Computes products of several 4D spectra, averaged over the bins of a full radial spectrum.

use super::bins::RadialBins;
use super::spectrum::FieldSpectrum;
use ndarray::{Array2, Array3};
use rayon::prelude::*;

impl RadialBins {
    /// The mean of Re(Fᵢ conj Fⱼ) over the frequencies of each bin, [bin, i, j]. The bins
    /// are in the row-major order of [|Ωxy|, |Ωuv|].
    ///
    /// All pairs of spectra are computed together, so that each spectrum is read only once. Each
    /// ring of frequencies (Ωx, Ωy) is summed separately and in order, so the result is bitwise
    /// identical on any number of threads.
    ///
    /// # Panics
    /// If a spectrum and these bins belong to different grids.
    #[must_use]
    pub fn products(&self, spectra: &[&FieldSpectrum]) -> Array3<f64> {
        let (rings, columns) = self.counts.dim();
        let n = spectra.len();
        let of_ring: Vec<Vec<f64>> = (0..rings)
            .into_par_iter()
            .map(|ring| self.ring_products(ring, spectra))
            .collect();
        let products = Array3::from_shape_vec((rings * columns, n, n), of_ring.concat());
        products.expect("there is a product for each bin and pair")
    }

    /// The products of all frequencies in a ring of (Ωx, Ωy), [|Ωuv|, i, j].
    fn ring_products(&self, ring: usize, spectra: &[&FieldSpectrum]) -> Vec<f64> {
        let n = spectra.len();
        let columns = self.counts.ncols();
        let mut sums = vec![Array2::<f64>::zeros((n, n)); columns];
        let mut parts = vec![[0.0; 2]; n];
        for [x, y] in self.of_ring(ring) {
            for (index, column, weight) in self.angular() {
                let [u, v] = index;
                for (part, spectrum) in parts.iter_mut().zip(spectra) {
                    let value = spectrum.values[[x, y, u, v]];
                    *part = [value.re, value.im];
                }
                add_products(&mut sums[column], &parts, weight);
            }
        }
        let means = sums.iter_mut().zip(self.counts.row(ring));
        for (sum, count) in means {
            *sum /= *count as f64;
            for (i, j) in (0..n).flat_map(|i| (0..i).map(move |j| (i, j))) {
                sum[[j, i]] = sum[[i, j]];
            }
        }
        sums.into_iter().flatten().collect()
    }
}

/// Adds the products of all pairs of spectra i ≥ j.
fn add_products(sum: &mut Array2<f64>, parts: &[[f64; 2]], weight: f64) {
    for (i, (row, [re, im])) in sum.outer_iter_mut().zip(parts).enumerate() {
        let (re, im) = (weight * re, weight * im);
        for (sum, part) in row.into_iter().zip(&parts[..=i]) {
            *sum += re * part[0] + im * part[1];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::{Assignment, Complex, FieldGrid};
    use ndarray::Array4;

    #[test]
    fn products_are_means_over_bins() {
        let grid = FieldGrid {
            cells: [8, 10, 8, 12],
            half_widths: [0.5, 0.6, 0.4, 0.7],
        };
        let bins = RadialBins::new(&grid);
        let spectrum = |seed: f64| FieldSpectrum {
            grid,
            assignment: Assignment::Tsc,
            values: Array4::from_shape_fn((8, 10, 8, 7), |(x, y, u, v)| {
                let at = seed + x as f64 + 3.1 * y as f64 + 0.7 * u as f64 - 1.9 * v as f64;
                Complex::new(at.sin(), (2.0 * at).cos())
            }),
        };
        let spectra = [spectrum(0.0), spectrum(1.0), spectrum(2.5)];
        let products = bins.products(&spectra.each_ref());
        for (i, j) in [(0, 0), (1, 0), (0, 1), (2, 1)] {
            let [mean] = bins.means(|index| {
                let [a, b] = [&spectra[i], &spectra[j]].map(|s| s.values[index]);
                [(a * b.conj()).re]
            });
            for ((r, c), mean) in mean.indexed_iter() {
                // The tolerance is the rounding error of sums of about a hundred numbers around
                // 1.
                assert!((products[[r * bins.counts.ncols() + c, i, j]] - mean).abs() < 1e-13);
            }
        }
    }
}
