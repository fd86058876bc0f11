//! The sum of weighted rays on all slices, by a non-uniform fast Fourier transform.
//!
//! The tracer sums photons by this transform, and theory sums the nodes of its nets by this
//! transform. An error of the transform would therefore not appear in a comparison of the two. For
//! this reason, the tests of the tracer and of theory compare the transform with the plain sum.

mod block;
mod fine_grid;
mod fixed;
mod kernel;
mod spread;

use block::Block;
use etendue_field::{FrequencyAxis, SliceGrid, Slices, TwoPlane};
use fearless_simd::{Level, dispatch};
use fine_grid::{FineTransform, Workspace};
use kernel::{Kernel, UPSAMPLING, WIDTH};
use ndarray::Axis;
use spread::{Placement, spread};
use std::fmt;

/// The plan of the slice transform: all slices of a sum of weighted rays (docs/theory.md (11)),
///
/// S_φ(ρ, ν) = Σ w e^(−2πi (ρ p + ν q)),  p = x cos φ + y sin φ,  q = u cos φ + v sin φ,
///
/// by a 2D non-uniform fast Fourier transform of type 1 for each azimuth (Barnett, Magland and af
/// Klinteberg 2019, *SIAM Journal on Scientific Computing* 41(5)). The plan spreads each ray over 8
/// × 8 cells of a grid (6 × 6 with reduced precision), transforms the grid, and divides by the
/// transform of the spreading kernel. The grid is 2.5 times as fine as the frequencies require.
///
/// The error is below 2·10⁻⁷ Σ|w| at every frequency. A single ray reaches this bound; with many
/// scattered rays, errors average out. A plan with [`reduced`](Self::reduced) precision takes half
/// the time. The weight `w` is used as given, so the caller applies the window and the factor of
/// radiance space.
///
/// The bits of the result depend on the rays, their order, and the kind of processor: the FFTs
/// (`rustfft`, `realfft`) use the best instructions available. Spreading gives the same bits on all
/// processors.
///
/// One plan serves any number of [`Accumulator`]s, on any number of threads.
pub struct SliceTransform {
    grid: SliceGrid,
    spreading: Spreading,
    placements: Vec<Placement>,
    fine: FineTransform,
    level: Level,
}

/// The kernel of a plan.
#[derive(Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "a plan holds one kernel, and is not moved"
)]
enum Spreading {
    Full(Kernel<f64, WIDTH>),
    Reduced(Kernel<f32, { fixed::TAPS }>),
}

/// The largest number of cells of a padded grid at which reduced precision saves time. For larger
/// grids, adding up the cells after each block takes longer than the spreading saves.
const MAX_REDUCED_CELLS: usize = 1 << 18;

impl fmt::Debug for SliceTransform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SliceTransform")
            .field("grid", &self.grid)
            .finish_non_exhaustive()
    }
}

impl SliceTransform {
    /// Plans the transform at the frequencies of `grid`.
    ///
    /// # Panics
    ///
    /// Panics if `grid` has no azimuth, or if a fine grid has 2³² cells or more.
    #[must_use]
    pub fn new(grid: &SliceGrid) -> Self {
        Self::at_level(grid, Level::new(), false)
    }

    /// Plans the transform with an error below 2·10⁻⁵ Σ|w|, in half the time. Weights must not be
    /// negative. For grids of more than 500 × 500 cells, the result is that of [`Self::new`].
    ///
    /// A single ray reaches this bound. The error is that of the spreading kernel, which is
    /// 1.3·10⁻⁵ of the spectrum at frequencies beyond the grid. Light from a source with extent has
    /// little power there, so its error is usually below 10⁻⁶ Σw, and in 40 random scenes at most
    /// 0.004 standard errors of 10⁶ photons (results/performance.md). Positions must be finite.
    ///
    /// # Panics
    ///
    /// Panics if `grid` has no azimuth, or if a fine grid has 2³² cells or more.
    #[must_use]
    pub fn reduced(grid: &SliceGrid) -> Self {
        Self::at_level(grid, Level::new(), true)
    }

    /// Plans the transform for a given SIMD level.
    fn at_level(grid: &SliceGrid, level: Level, reduced: bool) -> Self {
        let placements: Vec<_> = (0..grid.azimuths)
            .map(|k| {
                let (sin, cos) = libm::sincos(grid.azimuth(k));
                let along = |axis: &FrequencyAxis| [cos * axis.spacing, sin * axis.spacing];
                Placement {
                    rho: along(&grid.rho),
                    nu: along(&grid.nu),
                    rows: cells(&grid.rho),
                    columns: cells(&grid.nu),
                }
            })
            .collect();
        let [rows, columns] = placements[0].padded();
        assert!(
            u32::try_from(rows * columns).is_ok(),
            "a grid has fewer than 2³² cells"
        );
        let (spreading, fine) = if reduced && rows * columns <= MAX_REDUCED_CELLS {
            let kernel = Kernel::<f64, { fixed::TAPS }>::new().single();
            let fine = FineTransform::new(&kernel.double(), placements[0], *grid);
            (Spreading::Reduced(kernel), fine)
        } else {
            let kernel = Kernel::new();
            let fine = FineTransform::new(&kernel, placements[0], *grid);
            (Spreading::Full(kernel), fine)
        };
        Self {
            grid: *grid,
            spreading,
            placements,
            fine,
            level,
        }
    }

    /// The number of bytes of an accumulator.
    #[must_use]
    pub fn bytes(&self) -> f64 {
        let [cells, whole] = self.cell_counts();
        let cells = size_of::<f64>() * cells + size_of::<i32>() * whole;
        (cells + self.fine.workspace().bytes()) as f64
    }

    /// The numbers of cells of an accumulator that hold f64, and that hold whole numbers.
    fn cell_counts(&self) -> [usize; 2] {
        let [rows, columns] = self.placements[0].padded();
        let whole = match self.spreading {
            Spreading::Full(_) => 0,
            Spreading::Reduced(_) => rows * columns,
        };
        [self.grid.azimuths * rows * columns, whole]
    }

    /// An empty sum.
    #[must_use]
    pub fn accumulator(&self) -> Accumulator<'_> {
        let [cells, whole] = self.cell_counts();
        Accumulator {
            plan: self,
            block: Block::new(),
            whole: vec![0; whole],
            fine: vec![0.0; cells],
            work: self.fine.workspace(),
        }
    }
}

/// The number of cells of a period. There are 2.5 cells for each frequency and at least two
/// widths of the kernel. The number has no prime factors other than 2, 3 and 5.
fn cells(axis: &FrequencyAxis) -> usize {
    let mut count = usize::max(UPSAMPLING * axis.half, 2 * WIDTH);
    while !is_smooth(count) {
        count += 1;
    }
    count
}

/// Checks whether `n` > 0 has no prime factors other than 2, 3 and 5.
fn is_smooth(mut n: usize) -> bool {
    for prime in [2, 3, 5] {
        while n.is_multiple_of(prime) {
            n /= prime;
        }
    }
    n == 1
}

/// A partial sum of weighted rays, to be turned into slices: see [`SliceTransform`].
///
/// The sum holds a fine grid for each azimuth; [`finish`](Self::finish) empties it for reuse.
#[derive(Clone, Debug)]
pub struct Accumulator<'plan> {
    plan: &'plan SliceTransform,
    block: Block,
    /// A padded grid of whole numbers, for the rays of a block at one azimuth; empty if the plan
    /// has full precision.
    whole: Vec<i32>,
    /// The padded fine grids, [azimuth, row, column].
    fine: Vec<f64>,
    work: Workspace,
}

impl Accumulator<'_> {
    /// Adds a ray.
    #[inline]
    pub fn deposit(&mut self, ray: &TwoPlane, weight: f64) {
        self.block.push(ray, weight);
        if self.block.is_full() {
            self.flush();
        }
    }

    /// Adds rays given as columns of x, y, u, v and weight.
    ///
    /// # Panics
    ///
    /// Panics if the columns have different lengths.
    pub fn deposit_columns(&mut self, columns: [&[f64]; 5]) {
        let count = columns[0].len();
        assert!(columns.iter().all(|column| column.len() == count));
        let mut from = 0;
        while from < count {
            from += self.block.extend(columns.map(|column| &column[from..]));
            if self.block.is_full() {
                self.flush();
            }
        }
    }

    /// Returns the slices of the rays added since the last call, times `scale`, and empties the
    /// sum.
    #[must_use]
    pub fn finish(&mut self, scale: f64) -> Slices {
        self.flush();
        let mut slices = Slices::zeros(self.plan.grid);
        let each = self.fine.len() / self.plan.grid.azimuths;
        let views = slices.half.axis_iter_mut(Axis(0));
        for (fine, slice) in self.fine.chunks_exact(each).zip(views) {
            self.plan.fine.slice(fine, scale, &mut self.work, slice);
        }
        self.fine.fill(0.0);
        slices
    }

    /// Spreads the waiting rays. The outer loop is over azimuths, so that only one fine grid at a
    /// time is in the cache.
    fn flush(&mut self) {
        self.block.pad();
        let Self {
            plan, block, whole, ..
        } = self;
        let each = self.fine.len() / plan.placements.len();
        let grids = plan.placements.iter().zip(self.fine.chunks_exact_mut(each));
        match &plan.spreading {
            Spreading::Full(kernel) => {
                for (placement, fine) in grids {
                    dispatch!(plan.level, simd => spread(simd, kernel, placement, block, fine));
                }
            }
            Spreading::Reduced(kernel) => {
                let block = (&*block, fixed::scale(block));
                for (placement, fine) in grids {
                    dispatch!(plan.level, simd => {
                        fixed::spread(simd, kernel, placement, block, whole, fine);
                    });
                }
            }
        }
        self.block.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::Simd;

    fn slices(level: Level, reduced: bool) -> Slices {
        let axis = |half, spacing| FrequencyAxis { half, spacing };
        let grid = SliceGrid {
            azimuths: 3,
            rho: axis(5, 0.7),
            nu: axis(9, 1.1),
        };
        let plan = SliceTransform::at_level(&grid, level, reduced);
        let mut sum = plan.accumulator();
        for i in 0..500 {
            let t = f64::from(i);
            let ray = TwoPlane {
                x: libm::sin(t * 0.7),
                y: libm::cos(t * 1.3),
                u: libm::sin(t * 2.1),
                v: libm::cos(t * 0.3),
            };
            sum.deposit(&ray, 1.0 + libm::cos(t));
        }
        sum.finish(1.0)
    }

    #[test]
    fn every_simd_level_gives_the_same_bits() {
        for reduced in [false, true] {
            let best = slices(Level::new(), reduced);
            assert_eq!(best, slices(Level::baseline(), reduced));
            #[cfg(target_arch = "x86_64")]
            if let Some(token) = Level::new().as_sse4_2() {
                assert_eq!(best, slices(token.level(), reduced));
            }
            assert!(best.at_zero() > 100.0);
        }
    }

    #[test]
    fn bytes_are_those_of_the_vectors() {
        let axis = |half| FrequencyAxis { half, spacing: 1.0 };
        let grid = SliceGrid {
            azimuths: 3,
            rho: axis(5),
            nu: axis(41),
        };
        for plan in [SliceTransform::new(&grid), SliceTransform::reduced(&grid)] {
            let sum = plan.accumulator();
            let bytes = size_of_val(&*sum.fine) + size_of_val(&*sum.whole) + sum.work.bytes();
            assert_eq!(plan.bytes().to_bits(), (bytes as f64).to_bits());
        }
    }

    #[test]
    fn fine_grids_are_smooth_and_wide_enough() {
        for (half, expected) in [(0, 16), (3, 16), (4, 20), (16, 80), (32, 160), (34, 180)] {
            let spacing = 1.0;
            assert_eq!(cells(&FrequencyAxis { half, spacing }), expected);
        }
    }
}
