use super::wave::Wave;
use crate::Chain;
use crate::parallel::chain::Path;
use crate::parallel::corners::Corners;
use crate::parallel::expansion::Expansion;
use crate::parallel::row::FrequencyRow;
use crate::parallel::slope::Slope;
use crate::parallel::weighted_rectangle::DiscResolution;
use etendue_field::{Complex, Window};
use rayon::prelude::*;

/// The spectrum of a chain on a 4D grid of frequencies: multiples of a spacing along each axis.
///
/// It is a sum of products of a factor over (Ωx, Ωu) and one over (Ωy, Ωv), so tables of the
/// factors are all that is kept, and a frequency is read off them as it is asked for.
#[derive(Debug)]
pub struct Harmonics {
    expansion: Expansion,
    /// For each product of waves, the tables of both sections.
    tables: Vec<[HarmonicTable; 2]>,
}

/// The factors of all polygons of a section, [position, slope, polygon].
#[derive(Debug)]
struct HarmonicTable {
    /// Harmonics on either side of zero, along position and slope.
    half: [usize; 2],
    polygons: usize,
    values: Vec<Complex>,
}

/// Most numbers kept: 1.6 GB.
const LARGEST: usize = 100_000_000;

impl Harmonics {
    /// Tables for frequencies (Ωx, Ωy, Ωu, Ωv) of up to `half` multiples of `spacing` along each
    /// axis.
    ///
    /// `None` behind a diffuse reflection, which is no such product, and where the tables would be
    /// larger than 1.6 GB.
    #[must_use]
    pub fn new(
        chain: &Chain,
        window: &Window,
        spacing: [f64; 4],
        half: [usize; 4],
    ) -> Option<Self> {
        let path: Path<'_> = chain.path();
        if path.receiver().is_some() {
            return None;
        }
        let max = |axis: usize| spacing[axis] * half[axis] as f64;
        let highest = [max(0).max(max(1)), max(2).max(max(3))];
        let fineness = DiscResolution::for_spectrum(&path, window, highest);
        let slope = Slope::new([&window.u, &window.v], path.slope_power());
        let expansion = Expansion::new(&path, window, &slope, &fineness);
        let size = |axis: usize| {
            let cells = (2 * half[axis] + 1) * (2 * half[axis + 2] + 1);
            cells * expansion.sections[axis].polygons.len() * expansion.products.len()
        };
        if size(0) + size(1) > LARGEST {
            return None;
        }
        let table = |waves: &[Vec<Wave>; 2], axis: usize| {
            let along = [spacing[axis], spacing[axis + 2]];
            HarmonicTable::new(
                &expansion,
                &waves[axis],
                axis,
                along,
                [half[axis], half[axis + 2]],
            )
        };
        let products = expansion.products.iter();
        let tables = products.map(|waves| [0, 1].map(|axis| table(waves, axis)));
        let tables = tables.collect();
        Some(Self { expansion, tables })
    }

    /// ℓ̂ at the harmonics (i, j, k, l) of the spacings; the same as [`at`](crate::at) there.
    /// Unit: W m⁻² sr⁻¹ · m².
    ///
    /// # Panics
    /// Beyond the harmonics it was made for.
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
        waves: &[Wave],
        axis: usize,
        spacing: [f64; 2],
        half: [usize; 2],
    ) -> Self {
        let section = &expansion.sections[axis];
        let corners = Corners::new(section, waves);
        let polygons = section.polygons.len();
        let count = 2 * half[1] + 1;
        let rows: Vec<Vec<Complex>> = (0..=2 * half[0])
            .into_par_iter()
            .map(|i| {
                let harmonic = i as f64 - half[0] as f64;
                let [position, step] = section.reduced([harmonic * spacing[0], spacing[1]]);
                let half = half[1];
                let row = corners.row(&FrequencyRow {
                    position,
                    step,
                    half,
                });
                // From [polygon, slope] to [slope, polygon].
                let each = (0..count).flat_map(|n| (0..polygons).map(move |p| p * count + n));
                each.map(|index| row[index]).collect()
            })
            .collect();
        Self {
            half,
            polygons,
            values: rows.concat(),
        }
    }

    /// The factors of all polygons at a harmonic.
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
                assert!(difference.norm() < 1e-10 * zero, "{h:?}"); // as of the slices
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
