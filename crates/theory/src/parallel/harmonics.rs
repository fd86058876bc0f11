//! The spectrum of a chain on a 4D grid of frequencies.

use super::wave::SectionWave;
use crate::Chain;
use crate::parallel::chain::ChainSegment;
use crate::parallel::corners::Corners;
use crate::parallel::disc_resolution::DiscResolution;
use crate::parallel::expansion::Expansion;
use crate::parallel::row::FrequencyRow;
use crate::parallel::slope::Slope;
use etendue_field::{Assignment, Complex, FieldGrid, Window, whole};
use rayon::prelude::*;

/// The spectrum of a chain on a grid of frequencies. Along each of the four axes, the frequencies
/// are multiples of a spacing.
///
/// The spectrum is a sum of products of two factors, one over (Ωx, Ωu) and one over (Ωy, Ωv).
/// Therefore only tables of the factors are stored, and the value at a frequency is computed from
/// the tables when it is needed.
#[derive(Debug)]
pub struct Harmonics {
    expansion: Expansion,
    /// For each product of waves, the tables of the sections (x, u) and (y, v).
    tables: Vec<[HarmonicTable; 2]>,
}

/// The factors of all polygons of a section, as [position frequency, slope frequency, polygon].
#[derive(Debug)]
struct HarmonicTable {
    /// Number of harmonics on either side of zero, along position and slope.
    half: [usize; 2],
    polygons: usize,
    values: Vec<Complex>,
}

/// Maximum number of complex numbers that are stored, which occupy 1.6 GB.
const MAX_NUMBERS: usize = 100_000_000;

impl Harmonics {
    /// Builds tables for frequencies (Ωx, Ωy, Ωu, Ωv) that are −`half` to `half` times `spacing`
    /// along each axis.
    ///
    /// Returns `None` if the tables would be larger than 1.6 GB. Also returns `None` if the chain
    /// has a diffuse reflection, because its spectrum is then not a sum of products of two factors.
    #[must_use]
    pub fn new(
        chain: &Chain,
        window: &Window,
        spacing: [f64; 4],
        half: [usize; 4],
    ) -> Option<Self> {
        Self::built(chain, window, (spacing, half), None)
    }

    /// Builds the tables of the spectrum that is expected if rays are assigned to the cells of a
    /// grid and the spectrum is divided by the transform of the assignment spline. The expected
    /// spectrum is the spectrum of the chain plus aliases from beyond the Nyquist frequency.
    ///
    /// The expected spectrum is Σₙ ℓ̂(Ω + n/Δ) Πᵢ ((−1)^nᵢ fᵢ/(fᵢ + nᵢ))^p, where f = ΔΩ is in
    /// cycles per cell and p is the order of the spline (docs/theory.md (44); Hockney and Eastwood
    /// 1981, chapter 5). The sum covers |nᵢ| ≤ `FOLDS`. Returns `None` as for [`new`](Self::new).
    #[must_use]
    pub fn on_grid(
        chain: &Chain,
        window: &Window,
        grid: &FieldGrid,
        assignment: Assignment,
    ) -> Option<Self> {
        let axes = [0, 1, 2, 3];
        let spacing = axes.map(|axis| grid.spacing(axis));
        let half = axes.map(|axis| grid.cells[axis] / 2);
        Self::built(chain, window, (spacing, half), Some(assignment))
    }

    fn built(
        chain: &Chain,
        window: &Window,
        (spacing, half): ([f64; 4], [usize; 4]),
        folded: Option<Assignment>,
    ) -> Option<Self> {
        let path: ChainSegment<'_> = chain.path();
        if path.receiver().is_some() || path.has_polygons() {
            return None;
        }
        // A spline of order 3 multiplies an alias by less than 1/27 if the alias comes from beyond
        // twice the Nyquist frequency.
        let reach = if folded.is_some() { 2.0 } else { 1.0 };
        let max = |axis: usize| reach * spacing[axis] * half[axis] as f64;
        let highest = [max(0).max(max(1)), max(2).max(max(3))];
        let fineness = DiscResolution::for_spectrum(&path, window, highest);
        let slope = Slope::new([&window.u, &window.v], path.slope_power());
        let expansion = Expansion::new(&path, window, &slope, &fineness.0);
        let size = |axis: usize| {
            let cells = (2 * half[axis] + 1) * (2 * half[axis + 2] + 1);
            cells * expansion.sections[axis].polygons.len() * expansion.products.len()
        };
        if size(0) + size(1) > MAX_NUMBERS {
            return None;
        }
        let table = |waves: &[Vec<SectionWave>; 2], axis: usize| {
            let along = [spacing[axis], spacing[axis + 2]];
            HarmonicTable::new(
                &expansion,
                &waves[axis],
                axis,
                along,
                [half[axis], half[axis + 2]],
                folded,
            )
        };
        let products = expansion.products.iter();
        let tables = products.map(|waves| [0, 1].map(|axis| table(waves, axis)));
        let tables = tables.collect();
        Some(Self { expansion, tables })
    }

    /// The number of products that are summed for each frequency.
    #[must_use]
    pub fn terms(&self) -> usize {
        self.expansion.terms.len() * self.tables.len()
    }

    /// Returns ℓ̂ at the harmonics (i, j, k, l) of the spacings, which equals [`at`](crate::at) at
    /// these frequencies. Unit: W m⁻² sr⁻¹ · m².
    ///
    /// # Panics
    /// Panics if a harmonic is beyond the range of the tables.
    #[must_use]
    pub fn at(&self, [x, y, u, v]: [isize; 4]) -> Complex {
        let of = |[first, second]: &[HarmonicTable; 2]| {
            let (first, second) = (first.at([x, u]), second.at([y, v]));
            let terms = self.expansion.terms.iter();
            let sum: Complex = terms
                .map(|t| first[t.polygons[0]] * second[t.polygons[1]] * t.weight)
                .sum();
            sum
        };
        self.tables.iter().map(of).sum::<Complex>() * self.expansion.brightness
    }
}

impl HarmonicTable {
    fn new(
        expansion: &Expansion,
        waves: &[SectionWave],
        axis: usize,
        spacing: [f64; 2],
        half: [usize; 2],
        folded: Option<Assignment>,
    ) -> Self {
        let section = &expansion.sections[axis];
        let corners = Corners::new(section, waves);
        let polygons = section.polygons.len();
        let along = half.map(|half| Folds { half, folded });
        let count = 2 * half[1] + 1;
        let rows: Vec<Vec<Complex>> = (0..=2 * half[0])
            .into_par_iter()
            .map(|i| {
                let mut sum = vec![Complex::ZERO; count * polygons];
                for (harmonic, share) in along[0].of(i) {
                    let [position, step] = section.reduced([harmonic * spacing[0], spacing[1]]);
                    let half = along[1].reach();
                    let row = corners.row(&FrequencyRow {
                        position,
                        step,
                        half,
                    });
                    // Transposes an array [polygon, slope] to [slope, polygon].
                    for (n, sum) in sum.chunks_exact_mut(polygons).enumerate() {
                        for (at, share_of_slope) in along[1].indices(n) {
                            for (p, sum) in sum.iter_mut().enumerate() {
                                *sum += row[p * (2 * half + 1) + at] * (share * share_of_slope);
                            }
                        }
                    }
                }
                sum
            })
            .collect();
        Self {
            half,
            polygons,
            values: rows.concat(),
        }
    }

    /// The factors of all polygons at the given harmonics of position and slope.
    fn at(&self, harmonic: [isize; 2]) -> &[Complex] {
        let [i, n] = [0, 1].map(|axis| {
            let index = self.half[axis].checked_add_signed(harmonic[axis]);
            index.filter(|i| *i <= 2 * self.half[axis])
        });
        let (Some(i), Some(n)) = (i, n) else {
            panic!("harmonic {harmonic:?} is beyond ± {:?}", self.half);
        };
        let start = (i * (2 * self.half[1] + 1) + n) * self.polygons;
        &self.values[start..start + self.polygons]
    }
}

/// Number of aliases from each side that are added to a frequency.
const FOLDS: u32 = 4;

/// The frequencies along an axis of a table, with the aliases that coincide on its grid.
#[derive(Clone, Copy)]
struct Folds {
    /// Number of harmonics on either side of zero, which is half a period of the spectrum of
    /// gridded rays.
    half: usize,
    folded: Option<Assignment>,
}

impl Folds {
    /// The number of harmonics on either side of zero that contribute to the table,
    /// including aliases.
    fn reach(self) -> usize {
        match self.folded {
            Some(_) => self.half * (2 * FOLDS as usize + 1),
            None => self.half,
        }
    }

    /// The harmonics that alias to the harmonic at `index`, each with its factor.
    fn of(self, index: usize) -> impl Iterator<Item = (f64, f64)> {
        let (half, folds) = (self.half as f64, f64::from(FOLDS));
        let own = index as f64 - half;
        let order = self.folded.map(|assignment| assignment.order());
        let each = (0..=2 * FOLDS).map(move |n| f64::from(n) - folds);
        each.filter_map(move |n| {
            let harmonic = own + 2.0 * half * n;
            if n == 0.0 {
                return Some((harmonic, 1.0));
            }
            let sign = if n.abs() % 2.0 == 0.0 { 1.0 } else { -1.0 };
            let one = sign * own / harmonic;
            let share: f64 = (0..order?).map(|_| one).product();
            (share != 0.0).then_some((harmonic, share))
        })
    }

    /// The same harmonics as [`of`](Self::of), as indices among all harmonics within
    /// [`reach`](Self::reach).
    fn indices(self, index: usize) -> impl Iterator<Item = (usize, f64)> {
        let reach = self.reach() as f64;
        let each = self.of(index);
        each.map(move |(harmonic, share)| (whole(harmonic + reach), share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{blockers, chain, window};
    use crate::{Operator, at};
    use etendue_field::Profile;

    #[test]
    fn agrees_with_the_plain_path() {
        let mut chain = chain(0.2, &[(1.0, blockers(3, 0.2, 0.1)), (0.7, vec![])]);
        let window = window(Profile::Hann(0.5), Profile::Hann(0.3));
        for cosine in [false, true] {
            if cosine {
                let name = "end".into();
                chain.operators.push(Operator::Cosine { name });
            }
            let spacing = [1.0, 1.0, 1.0 / 0.6, 1.0 / 0.6];
            let harmonics = Harmonics::new(&chain, &window, spacing, [3, 2, 4, 3]).unwrap();
            let zero = harmonics.at([0; 4]).re;
            for h in [[0, 0, 0, 0], [3, -2, -4, 3], [1, 2, 0, -1], [-2, 0, 3, 0]] {
                let frequency = [0, 1, 2, 3].map(|axis| h[axis] as f64 * spacing[axis]);
                let difference = harmonics.at(h) - at(&chain, &window, frequency);
                assert!(difference.norm() < 1e-10 * zero, "{h:?}"); // the tolerance of slices
            }
        }
    }

    #[test]
    fn a_reflection_has_none() {
        let mut chain = chain(0.2, &[(1.0, vec![])]);
        let name = || "floor".to_owned();
        chain.operators.extend([
            Operator::Cosine { name: name() },
            Operator::Diffuse {
                name: name(),
                albedo: 0.5,
            },
        ]);
        let window = window(Profile::Hann(0.5), Profile::Hann(0.3));
        assert!(Harmonics::new(&chain, &window, [1.0; 4], [2; 4]).is_none());
    }
}
