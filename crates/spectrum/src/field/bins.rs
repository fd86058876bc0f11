//! Defines the bins of a full radial spectrum.

use super::spectrum::FieldSpectrum;
use etendue_field::{Complex, FieldGrid};
use ndarray::Array2;
use rayon::prelude::*;

/// The bins of a full radial spectrum over the frequencies of a 4D grid. Each bin is the product of
/// a ring in |Ωxy| and a ring in |Ωuv|.
///
/// The width Δ of the rings is the natural spacing 1/(2·half-width). If the spacings of x and y (or
/// u and v) differ, Δ is the larger spacing. The edges are 0, Δ/2, 3Δ/2, …: the first ring contains
/// only zero, and ring j is centred at jΔ. The last edge is the largest edge that does not exceed
/// the lower of the two Nyquist frequencies. Therefore every ring is complete and contains no
/// frequency at Nyquist.
#[derive(Clone, Debug)]
pub struct RadialBins {
    grid: FieldGrid,
    /// Edges of the rings in |Ωxy|, in cycles per metre, and edges of the rings in |Ωuv|, in cycles
    /// per unit slope. The number of edges is the number of rings plus one.
    pub edges: [Vec<f64>; 2],
    /// Number of frequencies in each bin, [|Ωxy|, |Ωuv|], counted in both halves of the spectrum.
    pub counts: Array2<u64>,
    /// The ring of each frequency (Ωx, Ωy), [x, y].
    xy: Vec<Option<usize>>,
    /// The frequencies (Ωu, Ωv) with Ωv ≥ 0 that lie in a ring.
    uv: Vec<Angular>,
}

/// A frequency (Ωu, Ωv).
#[derive(Clone, Copy, Debug)]
struct Angular {
    /// Indices of Ωu and Ωv in the spectrum.
    index: [usize; 2],
    ring: usize,
    /// Weight of the frequency in sums. The weight is 2 if Ωv > 0, because the conjugate frequency
    /// counts too, and 1 otherwise.
    weight: u64,
}

impl RadialBins {
    /// The bins over the frequencies of `grid`.
    #[must_use]
    pub fn new(grid: &FieldGrid) -> Self {
        let [nx, ny, nu, nv] = grid.cells;
        let edges = [edges(grid, [0, 1]), edges(grid, [2, 3])];
        let ring = |[a, b]: [usize; 2], [i, j]: [usize; 2]| {
            let along = |axis, i| grid.harmonic(axis, i) as f64 * grid.spacing(axis);
            let radius = libm::hypot(along(a, i), along(b, j));
            let edges = &edges[a / 2];
            let above = edges.partition_point(|edge| *edge <= radius);
            (above < edges.len()).then(|| above - 1)
        };
        let xy: Vec<_> = (0..nx * ny)
            .map(|i| ring([0, 1], [i / ny, i % ny]))
            .collect();
        let each = (0..nu).flat_map(|i| (0..nv / 2).map(move |j| [i, j]));
        let uv: Vec<_> = each
            .filter_map(|index| {
                ring([2, 3], index).map(|ring| Angular {
                    index,
                    ring,
                    // The field is real: a frequency with v > 0 also stands for its conjugate.
                    weight: if index[1] == 0 { 1 } else { 2 },
                })
            })
            .collect();
        let mut counts = [0, 1].map(|i| vec![0; edges[i].len() - 1]);
        xy.iter().flatten().for_each(|ring| counts[0][*ring] += 1);
        uv.iter()
            .for_each(|angular| counts[1][angular.ring] += angular.weight);
        let shape = (counts[0].len(), counts[1].len());
        Self {
            grid: *grid,
            edges,
            counts: Array2::from_shape_fn(shape, |(i, j)| counts[0][i] * counts[1][j]),
            xy,
            uv,
        }
    }

    /// The indices of the frequencies Ωx and Ωy in a ring.
    pub(super) fn of_ring(&self, ring: usize) -> impl Iterator<Item = [usize; 2]> {
        let ny = self.grid.cells[1];
        let all = self.xy.iter().enumerate();
        let own = all.filter(move |(_, found)| **found == Some(ring));
        own.map(move |(i, _)| [i / ny, i % ny])
    }

    /// The indices of Ωu and Ωv ≥ 0 with their rings, and the number of frequencies that
    /// each pair represents.
    pub(super) fn angular(&self) -> impl Iterator<Item = ([usize; 2], usize, f64)> {
        let all = self.uv.iter();
        all.map(|angular| (angular.index, angular.ring, angular.weight as f64))
    }

    /// The mean over each bin for numbers that are even in Ω, such as powers. `of` returns
    /// these numbers for the indices [x, y, u, v] of a frequency.
    ///
    /// The numbers are summed for each Ωx, and these sums are added in order, so the result is
    /// bitwise identical on any number of threads.
    #[must_use]
    pub fn means<const N: usize>(
        &self,
        of: impl Fn([usize; 4]) -> [f64; N] + Sync,
    ) -> [Array2<f64>; N] {
        let zeros = || [(); N].map(|()| Array2::zeros(self.counts.raw_dim()));
        let [nx, ny, ..] = self.grid.cells;
        let slab = |x: usize| {
            let mut sums: [Array2<f64>; N] = zeros();
            let rings = self.xy[x * ny..(x + 1) * ny].iter().enumerate();
            for (y, ring) in rings.filter_map(|(y, ring)| Some((y, (*ring)?))) {
                for angular in &self.uv {
                    let values = of([x, y, angular.index[0], angular.index[1]]);
                    for (sum, value) in sums.iter_mut().zip(values) {
                        sum[[ring, angular.ring]] += angular.weight as f64 * value;
                    }
                }
            }
            sums
        };
        let slabs: Vec<_> = (0..nx).into_par_iter().map(slab).collect();
        let mut means = zeros();
        for sums in slabs {
            for (mean, sum) in means.iter_mut().zip(sums) {
                *mean += &sum;
            }
        }
        means.map(|sum| sum / self.counts.mapv(|count| count as f64))
    }

    /// The mean of |ℓ̂|² over each bin, including noise.
    #[must_use]
    pub fn power(&self, spectrum: &FieldSpectrum) -> Array2<f64> {
        let [power] = self.means(|index| [spectrum.values[index].norm_sqr()]);
        power
    }
}

/// The edges of the rings over the axes `a` and `b`.
fn edges(grid: &FieldGrid, [a, b]: [usize; 2]) -> Vec<f64> {
    let width = grid.spacing(a).max(grid.spacing(b));
    let last = grid.nyquist(a).min(grid.nyquist(b));
    let outer = (0..)
        .map(|j| (f64::from(j) + 0.5) * width)
        .take_while(|edge| *edge <= last);
    std::iter::once(0.0).chain(outer).collect()
}

/// |F|² of a prediction as a full radial spectrum, [|Ωxy|, |Ωuv|]. The value of each bin of
/// [`RadialBins`] is the mean over those frequencies of `grid` that are in the bin.
///
/// `of` is the spectrum of a real field at (Ωx, Ωy, Ωu, Ωv), and is called only for Ωv ≥ 0.
#[must_use]
pub fn full_radial_of(grid: &FieldGrid, of: impl Fn([f64; 4]) -> Complex + Sync) -> Array2<f64> {
    let [power] = RadialBins::new(grid).means(|index| [of(grid.frequency(index)).norm_sqr()]);
    power
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(cells: [usize; 4], half_widths: [f64; 4]) -> FieldGrid {
        FieldGrid { cells, half_widths }
    }

    #[test]
    fn bins_hold_every_frequency_of_a_ring() {
        for grid in [
            grid([8, 8, 8, 8], [0.5; 4]),
            grid([12, 8, 10, 16], [0.75, 0.5, 0.4, 0.7]),
        ] {
            let bins = RadialBins::new(&grid);
            let mut counts = Array2::<u64>::zeros(bins.counts.raw_dim());
            // Computes the expected mean directly, with far more harmonics than the grid has.
            let around =
                |axis: usize| (-20_i32..=20).map(move |m| f64::from(m) * grid.spacing(axis));
            let rings = |a: usize, b: usize| {
                let edges = bins.edges[a / 2].clone();
                let radii = around(a).flat_map(|x| around(b).map(move |y| libm::hypot(x, y)));
                let mut counts = vec![0; edges.len() - 1];
                for r in radii {
                    let ring = (0..counts.len()).find(|i| (edges[*i]..edges[i + 1]).contains(&r));
                    ring.into_iter().for_each(|i| counts[i] += 1);
                }
                counts
            };
            let (xy, uv) = (rings(0, 1), rings(2, 3));
            for ((i, j), count) in counts.indexed_iter_mut() {
                *count = xy[i] * uv[j];
            }
            assert_eq!(bins.counts, counts);
            assert!(counts.iter().all(|count| *count > 0));
            assert_eq!(counts[[0, 0]], 1);
        }
    }

    #[test]
    fn edges_are_centred_on_the_spacings() {
        let bins = RadialBins::new(&grid([8, 8, 12, 8], [0.5, 0.5, 0.25, 0.25]));
        assert_eq!(bins.edges[0], [0.0, 0.5, 1.5, 2.5, 3.5]);
        assert_eq!(bins.edges[1], [0.0, 1.0, 3.0, 5.0, 7.0]);
        assert_eq!(bins.counts[[1, 0]], 8); // |(m, n)| = 1 and √2
    }

    /// Tests two means that are known: the mean of the number 1, and a mean that would change if
    /// conjugates had a wrong weight.
    #[test]
    fn means_count_conjugates() {
        let grid = grid([8, 8, 8, 8], [0.5; 4]);
        let bins = RadialBins::new(&grid);
        let [one, square] = bins.means(|index| {
            let [_, _, _, v] = grid.frequency(index);
            [1.0, v * v]
        });
        assert!(one.iter().all(|mean| (mean - 1.0).abs() < 1e-14)); // rounding of sums of ones
        // By the symmetry of u and v, the mean of Ωv² is half of the mean of |Ωuv|². In ring 1,
        // |Ωuv|² is 1 at four frequencies and 2 at four other frequencies.
        assert!((square[[2, 1]] - 0.75).abs() < 1e-14); // rounding
        let by_frequency = full_radial_of(&grid, |[_, _, u, _]| Complex::new(0.0, u));
        assert!((by_frequency[[3, 1]] - 0.75).abs() < 1e-14);
    }
}
