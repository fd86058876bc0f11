//! Compares a 4D spectrum with alias-free slices of the same photons.

use super::spectrum::FieldSpectrum;
use super::spline::mean_square_alias;
use etendue_field::{Complex, FrequencyAxis, Slices};
use serde::Serialize;

/// A comparison of a 4D spectrum with the alias-free slices of the same photons, at the frequencies
/// that both have.
///
/// All values are norms over the shared frequencies, divided by the norm of the slices.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Aliasing {
    /// Number of frequencies compared; only one frequency of each conjugate pair counts.
    #[serde(rename = "frequencies")]
    pub compared: usize,
    /// The difference between the spectrum and the slices. It includes the error of the slices,
    /// which is below 2·10⁻⁷ Σw at each frequency.
    pub difference: f64,
    /// The expected difference due to aliasing. It assumes that the spectrum beyond Nyquist is as
    /// strong as in the outermost quarter below Nyquist. The expected difference is not a bound. It
    /// is correct for white noise, too large if the spectrum falls off, and too small if the
    /// spectrum rises beyond Nyquist.
    pub expected: f64,
    /// The bound from [`FieldSpectrum::alias_bound`]. The bound holds for any photons, but it is
    /// usually far above the difference.
    pub bound: f64,
}

/// A frequency that the slices and the 4D spectrum share.
struct SharedFrequency {
    harmonics: [isize; 4],
    /// The frequency along each of the two axes of the line, in cycles per cell, from 0 to ½.
    f: [f64; 2],
    slice: Complex,
}

impl FieldSpectrum {
    /// Compares the 4D spectrum with the slices of the same photons, at all shared frequencies
    /// below `share` of Nyquist.
    ///
    /// Shared frequencies with Ωy = Ωv = 0 are in the slice at azimuth 0. Shared frequencies with
    /// Ωx = Ωu = 0 are in the slice at azimuth π/2, which exists if the number of azimuths is even.
    /// If the spacing of the slices is finer than the natural spacing, only every n-th frequency is
    /// shared. Returns `None` if no frequency is shared or if there is no light.
    ///
    /// At the shared frequencies, only the two axes of the line have aliasing. At other
    /// frequencies, all four axes have aliasing.
    #[must_use]
    pub fn aliasing(&self, slices: &Slices, share: f64) -> Option<Aliasing> {
        let all = self.shared(slices);
        let (mut compared, mut norm) = (0, 0.0);
        let [mut difference, mut expected, mut bound] = [0.0; 3];
        for line in &all {
            let beyond = edge_powers(line);
            let inside = |s: &&SharedFrequency| s.f.iter().all(|f| *f < 0.5 * share);
            for SharedFrequency {
                harmonics,
                f,
                slice,
            } in line.iter().filter(inside)
            {
                compared += 1;
                norm += slice.norm_sqr();
                difference += (self.at(*harmonics) - slice).norm_sqr();
                bound += self.alias_bound(*harmonics).powi(2);
                let [a, b] = f.map(|f| mean_square_alias(self.assignment, f));
                let both = a * b * beyond[0].max(beyond[1]);
                expected += a * beyond[0] + b * beyond[1] + both;
            }
        }
        let relative = |square: f64| (square / norm).sqrt();
        (norm > 0.0).then(|| Aliasing {
            compared,
            difference: relative(difference),
            expected: relative(expected),
            bound: relative(bound),
        })
    }

    /// The shared frequencies of each line, up to and including Nyquist.
    fn shared(&self, slices: &Slices) -> Vec<Vec<SharedFrequency>> {
        let grid = &slices.grid;
        let mut lines = vec![(0, [0, 2])];
        if grid.azimuths.is_multiple_of(2) {
            lines.push((grid.azimuths / 2, [1, 3]));
        }
        let line = |(k, [a, b]): (usize, [usize; 2])| {
            let mut shared = Vec::new();
            for m in 0..=grid.rho.half {
                for n in 0..grid.nu.count() {
                    let along = [
                        self.harmonic_at(a, &grid.rho, grid.rho.half + m),
                        self.harmonic_at(b, &grid.nu, n),
                    ];
                    // The grid has no value between its harmonics.
                    let [Some(i), Some(j)] = along else { continue };
                    // Of two conjugate values, only one is compared.
                    if !grid.is_independent(m, n) {
                        continue;
                    }
                    let mut harmonics = [0; 4];
                    (harmonics[a], harmonics[b]) = (i, j);
                    let cycles =
                        |axis: usize, i: isize| i.abs() as f64 / self.grid.cells[axis] as f64;
                    shared.push(SharedFrequency {
                        harmonics,
                        f: [cycles(a, i), cycles(b, j)],
                        slice: slices.half[[k, m, n]],
                    });
                }
            }
            shared
        };
        lines.into_iter().map(line).collect()
    }

    /// Divides the frequency at `index` of `frequencies` by the spacing along `axis`. Returns the
    /// result if it is a whole number and the frequency does not exceed Nyquist.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the multiple of the frequency is below the number of cells"
    )]
    fn harmonic_at(&self, axis: usize, frequencies: &FrequencyAxis, index: usize) -> Option<isize> {
        let exact = frequencies.value(index) / self.grid.spacing(axis);
        let whole = exact.round();
        let found =
            (exact - whole).abs() < 1e-9 && 2.0 * whole.abs() <= self.grid.cells[axis] as f64;
        found.then_some(whole as isize)
    }
}

/// Estimates the power beyond Nyquist along each axis of a line. Returns the mean power of the line
/// in the outermost quarter along this axis.
fn edge_powers(line: &[SharedFrequency]) -> [f64; 2] {
    [0, 1].map(|axis| {
        let outer = line.iter().filter(|s| s.f[axis] >= 0.375);
        let (count, sum) = outer.fold((0, 0.0), |(count, sum), s| {
            (count + 1, sum + s.slice.norm_sqr())
        });
        sum / f64::from(count.max(1))
    })
}
