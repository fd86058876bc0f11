//! The spreading of rays over cells that hold whole numbers.
//!
//! Six taps of f32 and sums of i32 take half the time of eight taps and sums of f64. A sum of whole
//! numbers is exact, so errors do not grow with the number of rays.

use super::block::{Block, GROUP};
use super::kernel::{Kernel, transposed};
use super::spread::Placement;
use fearless_simd::{Simd, f32x8, f32x16, i32x8, prelude::*};

/// Number of taps along each axis.
pub(crate) const TAPS: usize = 6;

/// Number of cells that are added together: the taps of a row, and zeros.
const ROW: usize = 8;

/// Number of rays whose taps are computed side by side.
const LANES: usize = 16;

/// The fraction of the golden ratio. Its multiples modulo 1 are spread evenly over [0, 1), also
/// those of every second or every fourth multiple.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A group of rays on the fine grid, with scaled weights.
struct ScaledRays {
    /// The first padded cell of each ray.
    start: [u32; GROUP],
    /// The position of each ray between two rows, from −1 to 1.
    row: [f32; GROUP],
    /// The position of each ray between two columns, from −1 to 1.
    column: [f32; GROUP],
    /// Scaled weights.
    weight: [f32; GROUP],
    /// A number in [0, 1) for each ray. The shares of the ray are rounded down after it is added,
    /// so the mean of the rounding error is zero. Ordinary rounding would lose most shares below
    /// one half, which makes the sum too small by 3·10⁻⁶.
    offset: [f32; GROUP],
    /// Weight times the taps of the rows, [tap, ray].
    down: [[f32; GROUP]; TAPS],
    /// The taps of the columns, [ray, tap].
    across: [[f32; ROW]; GROUP],
}

/// Adds the rays of a padded block to the padded fine grid of one azimuth. `scale` is the
/// [`scale`] of the block, and `cells` is a grid of the same shape, which holds zeros before and
/// after.
#[inline(always)]
pub(crate) fn spread<S: Simd>(
    simd: S,
    kernel: &Kernel<f32, TAPS>,
    placement: &Placement,
    (block, scale): (&Block, f64),
    cells: &mut [i32],
    fine: &mut [f64],
) {
    let mut group = ScaledRays {
        start: [0; GROUP],
        row: [0.0; GROUP],
        column: [0.0; GROUP],
        weight: [0.0; GROUP],
        offset: [0.0; GROUP],
        down: [[0.0; GROUP]; TAPS],
        across: [[0.0; ROW]; GROUP],
    };
    for from in (0..block.weight.len()).step_by(GROUP) {
        place(&mut group, placement, block, from, scale);
        weigh(simd, &mut group, kernel);
        add(simd, &group, placement.padded()[1], cells);
    }
    let unit = 1.0 / scale;
    for (sum, cell) in fine.iter_mut().zip(cells) {
        *sum += f64::from(*cell) * unit;
        *cell = 0;
    }
}

/// The power of two by which weights are multiplied before they are rounded to whole
/// numbers. No cell can overflow, even if all rays lie in one cell, because the scaled weights sum
/// to at most 2³⁰ and the taps are at most 1. The result is NaN if the sum of the weights is not
/// finite.
pub(crate) fn scale(block: &Block) -> f64 {
    /// The smallest exponent of a sum of weights. Light below it counts as darkness.
    const MIN_EXPONENT: i32 = -900;
    let total: f64 = block.weight.iter().map(|weight| weight.abs()).sum();
    if !total.is_finite() {
        return f64::NAN;
    }
    libm::ldexp(1.0, 29 - libm::ilogb(total).max(MIN_EXPONENT))
}

/// Finds the cells of the rays starting at `from`, and scales their weights.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    reason = "f32 has more digits than six taps"
)]
fn place(group: &mut ScaledRays, placement: &Placement, block: &Block, from: usize, scale: f64) {
    let rays = from..from + GROUP;
    let (x, y) = (&block.x[rays.clone()], &block.y[rays.clone()]);
    let (u, v) = (&block.u[rays.clone()], &block.v[rays.clone()]);
    let weight = &block.weight[rays];
    for i in 0..GROUP {
        let (start, [row, column]) = placement.place([x[i], y[i], u[i], v[i]]);
        group.start[i] = start;
        group.row[i] = row as f32;
        group.column[i] = column as f32;
        group.weight[i] = (weight[i] * scale) as f32;
        let turns = (from + i) as f64 * GOLDEN;
        group.offset[i] = (turns - turns.floor()) as f32;
    }
}

/// Computes the taps.
#[inline(always)]
fn weigh<S: Simd>(simd: S, group: &mut ScaledRays, kernel: &Kernel<f32, TAPS>) {
    for i in (0..GROUP).step_by(LANES) {
        let lanes = i..i + LANES;
        let row = f32x16::from_slice(simd, &group.row[lanes.clone()]);
        let column = f32x16::from_slice(simd, &group.column[lanes.clone()]);
        let weight = f32x16::from_slice(simd, &group.weight[lanes.clone()]);
        for (down, tap) in group.down.iter_mut().zip(kernel.taps(simd, row)) {
            (tap * weight).store_slice(&mut down[lanes.clone()]);
        }
        let mut taps = [f32x16::splat(simd, 0.0); ROW];
        taps[..TAPS].copy_from_slice(&kernel.taps(simd, column));
        let across = group.across[lanes].as_flattened_mut();
        for (across, taps) in across.chunks_exact_mut(LANES).zip(transposed(taps)) {
            taps.store_slice(across);
        }
    }
}

/// Adds each ray to its cells.
#[inline(always)]
fn add<S: Simd>(simd: S, group: &ScaledRays, stride: usize, cells: &mut [i32]) {
    for (i, across) in group.across.iter().enumerate() {
        let across = f32x8::from_slice(simd, across);
        let offset = f32x8::splat(simd, group.offset[i]);
        let start = group.start[i] as usize;
        let cells = &mut cells[start..start + (TAPS - 1) * stride + ROW];
        for (j, down) in group.down.iter().enumerate() {
            let row = &mut cells[j * stride..j * stride + ROW];
            // Weights are not negative, so a conversion to whole numbers rounds down.
            let share: i32x8<S> = (across * down[i] + offset).to_int();
            (i32x8::from_slice(simd, row) + share).store_slice(row);
        }
    }
}
