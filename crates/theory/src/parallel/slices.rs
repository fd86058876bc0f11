//! Slices of the spectrum of a chain.

use super::expansion::{Expansion, SectionColumns, Sum};
use crate::Chain;
use crate::parallel::chain::ChainSegment;
use crate::parallel::corners::Corners;
use crate::parallel::disc_resolution::DiscResolution;
use crate::parallel::row::{FrequencyRow, several_by_rows};
use crate::parallel::slope::Slope;
use crate::parallel::wave::SectionWave;
use etendue_field::{Complex, SliceGrid, Slices, Window};
use std::borrow::Cow;

/// If the absolute value of the cosine or sine of an azimuth is below this threshold, it is treated
/// as exactly zero. Up to rounding errors, such azimuths are π/2 and 0.
const ORTHOGONAL: f64 = 1e-15;

/// The slices of the spectrum on a grid.
///
/// The result is the same for any number of threads. The slices differ from [`at`](crate::at) by
/// less than 1e-10 of the largest value or, if the chain has discs, by the quadrature error of discs.
/// Unit: W m⁻² sr⁻¹ · m².
#[must_use]
pub fn slices(chain: &Chain, window: &Window, grid: &SliceGrid) -> Slices {
    let path = chain.path();
    slices_at_fineness(&path, window, grid, &fineness(&path, window, grid))
}

/// The resolution to which discs are split for spectra on a grid.
pub(crate) fn fineness(
    path: &ChainSegment<'_>,
    window: &Window,
    grid: &SliceGrid,
) -> DiscResolution {
    DiscResolution::for_spectrum(path, window, [grid.rho.max(), grid.nu.max()])
}

/// The slices of a chain whose discs are split at the given resolution.
pub(crate) fn slices_at_fineness(
    path: &ChainSegment<'_>,
    window: &Window,
    grid: &SliceGrid,
    fineness: &DiscResolution,
) -> Slices {
    match path.receiver() {
        Some(receiver) => receiver.slices(window, grid),
        None => several(std::slice::from_ref(path), window, grid, fineness).remove(0),
    }
}

/// The slices of several chains without a receiver, whose discs are split at the given resolution.
/// The chains differ little from the first one: where a chain has the same section along x or y, its
/// factors are those of the first.
pub(crate) fn several(
    paths: &[ChainSegment<'_>],
    window: &Window,
    grid: &SliceGrid,
    fineness: &DiscResolution,
) -> Vec<Slices> {
    let expansions = paths.iter().map(|path| {
        let slope = Slope::new([&window.u, &window.v], path.slope_power());
        Expansion::new(path, window, &slope, &fineness.0)
    });
    let expansions: Vec<Expansion> = expansions.collect();
    let summed = |(path, expansion)| Summed::new(path, expansion, &expansions[0]);
    let all: Vec<Summed<'_>> = paths.iter().zip(&expansions).map(summed).collect();
    several_by_rows(grid, all.len(), |along, rho| {
        let factors =
            |product: &Product<'_>, axis: usize| product.factors(axis, rho, along[axis], grid);
        let of_first = all[0].products.iter();
        let first: Vec<_> = of_first
            .map(|product| [0, 1].map(|axis| factors(product, axis)))
            .collect();
        let row = |one: &Summed<'_>| one.row(&first, factors, grid.nu.count());
        all.iter().map(row).collect()
    })
}

/// An expansion, prepared for sums over its terms.
struct Summed<'a> {
    expansion: &'a Expansion,
    products: Vec<Product<'a>>,
    columns: Option<SectionColumns>,
    /// Whether the factors of the sections along x and y are those of the first chain.
    is_shared: [bool; 2],
}

impl<'a> Summed<'a> {
    fn new(path: &ChainSegment<'_>, expansion: &'a Expansion, first: &Expansion) -> Self {
        let products = expansion.products.iter();
        let has_same_waves = |axis: usize| {
            let waves = |of: &'a Expansion| of.products.iter().map(move |waves| &waves[axis]);
            waves(expansion).eq(first.products.iter().map(|waves| &waves[axis]))
        };
        Self {
            expansion,
            products: products
                .map(|waves| Product::new(expansion, waves))
                .collect(),
            columns: path.has_discs().then(|| expansion.columns()),
            is_shared: [0, 1].map(|axis| {
                let [own, others] = [expansion, first].map(|of| &of.sections[axis]);
                own.has_same_factors(others) && has_same_waves(axis)
            }),
        }
    }

    /// A row of the spectrum. `first` holds the factors of the first chain, for each product and axis;
    /// `factors` computes those of this chain.
    fn row(
        &self,
        first: &[[Vec<Complex>; 2]],
        factors: impl Fn(&Product<'_>, usize) -> Vec<Complex>,
        count: usize,
    ) -> Vec<Complex> {
        let mut row = vec![Complex::ZERO; count];
        for (i, product) in self.products.iter().enumerate() {
            let [x, y] = [0, 1].map(|axis| match self.is_shared[axis] {
                true => Cow::Borrowed(&first[i][axis]),
                false => Cow::Owned(factors(product, axis)),
            });
            match &self.columns {
                Some(columns) => columns.add(self.expansion.brightness, &x, &y, &mut row),
                None => self.expansion.add_terms(&x, &y, &mut row),
            }
        }
        row
    }
}

/// The polygons of both sections, with one product of waves that multiplies the terms.
struct Product<'a> {
    expansion: &'a Expansion,
    waves: &'a [Vec<SectionWave>; 2],
    corners: [Corners<'a>; 2],
}

impl<'a> Product<'a> {
    fn new(expansion: &'a Expansion, waves: &'a [Vec<SectionWave>; 2]) -> Self {
        Self {
            expansion,
            waves,
            corners: [0, 1].map(|axis| Corners::new(&expansion.sections[axis], &waves[axis])),
        }
    }

    /// The factors of all polygons of section `axis` in the row at ρ, as [polygon, ν].
    /// `along` is the cosine of the angle between the azimuth and the axis.
    fn factors(&self, axis: usize, rho: f64, along: f64, grid: &SliceGrid) -> Vec<Complex> {
        let section = &self.expansion.sections[axis];
        if along.abs() < ORTHOGONAL {
            // The frequencies in this section are zero along the complete row.
            let value = |p| section.value(&self.waves[axis], p, [0.0, 0.0]);
            let polygons = section.polygons.iter();
            return polygons
                .flat_map(|p| std::iter::repeat_n(value(p), grid.nu.count()))
                .collect();
        }
        let [position, step] = section.reduced([rho * along, grid.nu.spacing * along]);
        self.corners[axis].row(&FrequencyRow {
            position,
            step,
            half: grid.nu.half,
        })
    }
}

impl Expansion {
    /// Adds brightness · Σ terms to a row of the spectrum; `x` and `y` are the factors [polygon,
    /// n] of the two sections.
    fn add_terms(&self, x: &[Complex], y: &[Complex], row: &mut [Complex]) {
        let count = row.len();
        for term in &self.terms {
            let [p, q] = term.polygons.map(|i| i * count..(i + 1) * count);
            let scale = term.weight * self.brightness;
            for ((sum, x), y) in row.iter_mut().zip(&x[p]).zip(&y[q]) {
                *sum += x * y * scale;
            }
        }
    }
}

impl SectionColumns {
    /// Adds brightness · Σ terms to a row of the spectrum, for terms that are summed along y
    /// first.
    fn add(&self, brightness: f64, x: &[Complex], y: &[Complex], row: &mut [Complex]) {
        let along_y = added(&self.sums, y, row.len());
        let beside = added(&self.beside, &along_y, row.len());
        let polygons = x.chunks_exact(row.len());
        for (x, y) in polygons.zip(beside.chunks_exact(row.len())) {
            for ((sum, x), y) in row.iter_mut().zip(x).zip(y) {
                *sum += x * y * brightness;
            }
        }
    }
}

/// Returns weighted sums of factors as [sum, n], from the factors [index, n] at `count`
/// frequencies.
fn added(sums: &[Sum], factors: &[Complex], count: usize) -> Vec<Complex> {
    let mut added = vec![Complex::ZERO; sums.len() * count];
    for (to, sum) in added.chunks_exact_mut(count).zip(sums) {
        for &(weight, index) in sum {
            let factors = &factors[index * count..][..count];
            to.iter_mut()
                .zip(factors)
                .for_each(|(to, factor)| *to += factor * weight);
        }
    }
    added
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::*;
    use etendue_field::{FrequencyAxis, Light, Profile, Rectangle};

    /// A grid that contains the frequency shifts of Hann profiles of half-width 1/2, and
    /// the lines k·d = 0 for distances 1 and 2, on which the contributions of corners cancel.
    fn singular_grid(azimuths: usize, half: usize) -> SliceGrid {
        let axis = FrequencyAxis { half, spacing: 0.5 };
        SliceGrid {
            azimuths,
            rho: axis,
            nu: axis,
        }
    }

    /// Builds chains with several kinds of lights, paths and blockers.
    fn chains() -> Vec<Chain> {
        let mut off_center = chain(0.3, &[(1.0, blockers(3, 0.2, 0.1)), (1.0, vec![])]);
        off_center.source.light = lambertian(Rectangle {
            center: [0.13, -0.21],
            size: [0.4, 0.1],
        });
        let round = spot(disc([0.05, 0.1], 0.05), 0.0);
        let steps = [
            (1.0, Some(grating(0, 3.0, 0.4))),
            (0.5, Some(opaque(vec![disc([0.1, 0.0], 0.05)]))),
            (0.5, Some(half_plane(1, 0.1, false))),
            (0.5, Some(grating(0, 2.0, 0.0))),
        ];
        let point = Light::Point { intensity: 2.0 };
        let mut shaded = chain(0.3, &[(1.0, blockers(2, 0.2, 0.1)), (1.0, vec![])]);
        shaded.operators.push(cosine());
        vec![
            chain_of(round, steps.clone()),
            chain_of(point.clone(), steps),
            chain_of(point.clone(), []),
            chain_of(point, [(2.0, Some(half_plane(0, 0.25, true)))]),
            chain_of(spot(disc([0.0; 2], 0.05), 20.0), [(1.0, None)]),
            shaded,
            chain(0.2, &[]),
            chain(0.2, &[(2.0, vec![])]),
            chain(0.2, &[(1.0, blockers(4, 0.2, 0.1)), (1.0, vec![])]),
            chain(0.2, &[(1.0, blockers(2, 0.2, 0.1))]),
            chain(0.2, &[(0.0, blockers(2, 0.1, 0.04)), (1.0, vec![])]),
            chain(
                0.2,
                &[
                    (1.0, blockers(2, 0.2, 0.1)),
                    (1e-3, blockers(2, 0.2, 0.1)),
                    (1.0, vec![square([0.3, 0.0], 0.4)]),
                ],
            ),
            off_center,
        ]
    }

    /// The largest difference between `slices` and `at`, divided by the largest value.
    fn difference(chain: &Chain, window: &Window, grid: &SliceGrid) -> f64 {
        let path = chain.path();
        let fast = slices(chain, window, grid);
        let slope = Slope::new([&window.u, &window.v], path.slope_power());
        let expansion = Expansion::new(&path, window, &slope, &fineness(&path, window, grid).0);
        let (mut worst, mut largest) = (0.0, 0.0);
        for ((k, m, n), value) in fast.half.indexed_iter() {
            let (rho, nu) = (m as f64 * grid.rho.spacing, grid.nu.value(n));
            let plain = expansion.at(grid.frequency(k, rho, nu));
            worst = f64::max(worst, (value - plain).norm());
            largest = f64::max(largest, plain.norm());
        }
        worst / largest
    }

    #[test]
    fn agrees_with_the_plain_path() {
        let half = 0.5;
        let hann = Profile::Hann(half);
        let mixed = Window {
            y: Profile::Box(0.7),
            v: Profile::Hann(0.3),
            ..window(hann, Profile::Box(half))
        };
        for chain in chains() {
            for window in [window(hann, hann), window(Profile::Box(half), hann), mixed] {
                let worst = difference(&chain, &window, &singular_grid(4, 6));
                // If corners nearly cancel in two directions, the error is a thousand rounding
                // errors. The tolerance is this error divided by 1/20, which is the fraction of the
                // window that is lit.
                assert!(worst < 1e-12, "{worst:e} {:?}", chain.describe());
            }
        }
    }

    #[test]
    fn agrees_under_a_gaussian_window() {
        let profile = |width| Profile::Gaussian { width, cut: 0.5 };
        let chain = chain(0.2, &[(1.0, blockers(2, 0.2, 0.1)), (1.0, vec![])]);
        let window = window(profile(0.5), profile(0.3));
        let worst = difference(&chain, &window, &singular_grid(2, 2));
        assert!(worst < 1e-12, "{worst:e}"); // as above
    }

    #[test]
    fn agrees_far_from_unit_scales() {
        // A window of a millimetre, 1 km from a light of 10 m, causes shears of 10⁶ half-widths.
        let chain = chain(10.0, &[(999.0, blockers(2, 2e-3, 1e-3)), (1.0, vec![])]);
        let window = window(Profile::Hann(1e-3), Profile::Hann(0.02));
        let grid = SliceGrid {
            azimuths: 3,
            rho: FrequencyAxis {
                half: 4,
                spacing: 250.0,
            },
            nu: FrequencyAxis {
                half: 4,
                spacing: 12.5,
            },
        };
        let worst = difference(&chain, &window, &grid);
        // Positions of 20 m in a window of 1 mm have large rounding errors in both `slices` and
        // `at`.
        assert!(worst < 1e-11, "{worst:e}");
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits() {
        let chain = chain(0.2, &[(1.0, blockers(4, 0.2, 0.1)), (1.0, vec![])]);
        let window = window(Profile::Hann(0.5), Profile::Hann(0.3));
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let run = || slices(&chain, &window, &singular_grid(3, 8));
            pool.build().unwrap().install(run)
        };
        let one = on(1);
        assert!(one.half.iter().all(|s| s.is_finite()));
        assert_eq!(one, on(2));
        assert_eq!(one, on(7));
    }

    #[test]
    fn slices_meet_at_zero_and_are_real_there() {
        let chain = chain(0.2, &[(1.0, blockers(4, 0.2, 0.1)), (1.0, vec![])]);
        let window = window(Profile::Hann(0.5), Profile::Hann(0.3));
        let slices = slices(&chain, &window, &singular_grid(5, 3));
        for slice in slices.half.outer_iter() {
            let difference = slice[[0, 3]] - slices.at_zero();
            // The tolerance is the rounding error of a sum that is computed in two different
            // orders.
            assert!(difference.norm() < 1e-13 * slices.at_zero());
        }
    }
}
