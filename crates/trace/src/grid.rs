//! Finds which of many flat shapes contains a point.

use crate::lanes::lanes;
use etendue_field::Shape;
use std::ops::Range;

/// Flat shapes that lie side by side in a plane across the leg. A grid finds the shapes that may
/// contain a point.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    /// Distance along the leg at which the plane of the shapes lies.
    pub(crate) distance: f64,
    /// The lowest and highest x, and the lowest and highest y, of all shapes.
    pub(crate) bounds: [[f64; 2]; 2],
    counts: [u32; 2],
    /// Number of cells per metre along x and along y.
    density: [f64; 2],
    /// For each cell [y, x], the index in `members` of its first shape. An empty cell follows the
    /// last cell, and the last entry is its end.
    starts: Vec<u32>,
    /// The indices of the shapes that overlap each cell, cell by cell, and then [`TESTED`] zeros.
    members: Vec<u32>,
    shapes: Vec<Shape>,
}

/// The number of shapes of a cell that are tested without branches.
const TESTED: usize = 2;

/// The number of cells per shape, chosen so that most cells hold at most one shape.
const FINENESS: f64 = 4.0;

/// The largest allowed average number of cells per shape. The average exceeds this limit only if
/// shapes overlap.
const COPIES: usize = 16;

/// The whole part of a number, between 0 and `u32::MAX`.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the function returns the whole part"
)]
fn whole_u32(x: f64) -> u32 {
    x as u32
}

/// The extent of a shape along an axis. The extent includes a small margin, because
/// rounding errors may make a point just beyond the edge count as inside.
fn reach(shape: &Shape, axis: usize) -> [f64; 2] {
    const ROUNDING: f64 = 1e-12;
    let [low, high] = shape.bounds().extent(axis);
    let more = ROUNDING * low.abs().max(high.abs());
    [low - more, high + more]
}

impl Grid {
    /// Returns `None` if a grid would not save time, because there are few shapes or many shapes
    /// overlap.
    pub(crate) fn new(distance: f64, shapes: &[Shape]) -> Option<Self> {
        const MIN_SHAPES: usize = 8;
        if shapes.len() < MIN_SHAPES {
            return None;
        }
        let bounds = [0, 1].map(|axis| {
            let extents = shapes.iter().map(|shape| reach(shape, axis));
            extents.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [a, b]| {
                [low.min(a), high.max(b)]
            })
        });
        let sides = bounds.map(|[low, high]| high - low);
        if sides.iter().any(|side| *side <= 0.0) {
            return None;
        }
        let cells = FINENESS * shapes.len() as f64;
        let bars = are_bars(shapes, &bounds);
        let along = |axis: usize| match bars {
            [false, false] => (cells * sides[axis] / sides[1 - axis]).sqrt(),
            _ if bars[axis] => 1.0,
            _ => cells,
        };
        let mut grid = Self {
            distance,
            bounds,
            counts: [0, 1].map(|axis| whole_u32(along(axis).clamp(1.0, cells))),
            density: [0.0; 2],
            starts: vec![0],
            members: Vec::new(),
            shapes: shapes.to_vec(),
        };
        grid.density = [0, 1].map(|axis| f64::from(grid.counts[axis]) / sides[axis]);
        let mut cells = vec![Vec::new(); (grid.counts[0] * grid.counts[1]) as usize];
        let mut copies = 0;
        for (index, shape) in (0..).zip(shapes) {
            let [columns, rows] = [0, 1].map(|axis| {
                let [first, last] = reach(shape, axis).map(|end| grid.cell(axis, end));
                first..last + 1
            });
            copies += columns.len() * rows.len();
            if copies > COPIES * shapes.len() {
                return None;
            }
            for row in rows {
                for column in columns.clone() {
                    cells[(row * grid.counts[0] + column) as usize].push(index);
                }
            }
        }
        for cell in cells.into_iter().chain([Vec::new()]) {
            grid.members.extend(cell);
            grid.starts.push(u32::try_from(grid.members.len()).ok()?);
        }
        grid.members.extend([0; TESTED]);
        Some(grid)
    }

    /// The cell along an axis that contains a coordinate within the bounds.
    #[inline(always)]
    fn cell(&self, axis: usize, at: f64) -> u32 {
        let cell = (at - self.bounds[axis][0]) * self.density[axis];
        whole_u32(cell).min(self.counts[axis] - 1)
    }

    /// Checks whether any shape of the grid contains a point.
    #[inline]
    pub(crate) fn contains(&self, x: f64, y: f64) -> bool {
        let [inside] = self.contains_each([&[x], &[y]]);
        inside
    }

    /// Checks which of several points lie in a shape of the grid.
    #[inline(always)]
    pub(crate) fn contains_each<const N: usize>(&self, [x, y]: [&[f64; N]; 2]) -> [bool; N] {
        let [[left, right], [low, high]] = self.bounds;
        let [columns, rows] = self.counts;
        let cells: [u32; N] = lanes(|i| {
            let is_within = (x[i] >= left) & (x[i] <= right) & (y[i] >= low) & (y[i] <= high);
            let cell = self.cell(1, y[i]) * columns + self.cell(0, x[i]);
            if is_within { cell } else { rows * columns }
        });
        // Most cells hold few shapes, but the processor could not predict how many.
        let mut inside = [false; N];
        for (i, is_inside) in inside.iter_mut().enumerate() {
            let cell = cells[i] as usize;
            let [start, end] = [self.starts[cell], self.starts[cell + 1]].map(|n| n as usize);
            for member in start..start + TESTED {
                let shape = &self.shapes[self.members[member] as usize];
                *is_inside |= shape.contains(x[i], y[i]) & (member < end);
            }
            if start + TESTED < end {
                *is_inside |= self.crowd_contains(start + TESTED..end, x[i], y[i]);
            }
        }
        inside
    }

    /// Checks whether any of several members contains a point.
    #[inline(never)]
    fn crowd_contains(&self, mut members: Range<usize>, x: f64, y: f64) -> bool {
        members.any(|member| self.shapes[self.members[member] as usize].contains(x, y))
    }
}

/// Checks whether the shapes are bars along an axis: each reaches as far along it as all together.
/// Cells then divide only the other axis.
fn are_bars(shapes: &[Shape], bounds: &[[f64; 2]; 2]) -> [bool; 2] {
    [0, 1].map(|axis| {
        let whole = bounds[axis].map(f64::to_bits);
        let mut reaches = shapes.iter().map(|shape| reach(shape, axis));
        reaches.all(|ends| ends.map(f64::to_bits) == whole)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::{Disc, Rectangle};
    use etendue_transform::random::{Stream, unit, words};

    /// Returns shapes of all sizes up to `size`, scattered over the unit square.
    fn strewn(count: u64, size: f64) -> Vec<Shape> {
        let shape = |i: u64| {
            let [x, y, a, b] = words(5, Stream::Photon, i, 0).map(unit);
            let center = [x, y];
            if i.is_multiple_of(2) {
                let size = [size * a, size * b];
                Shape::Rectangle(Rectangle { center, size })
            } else {
                let radius = 0.5 * size * a;
                Shape::Disc(Disc { center, radius })
            }
        };
        (0..count).map(shape).collect()
    }

    #[test]
    fn it_finds_what_holds_a_point() {
        for (count, size) in [(8, 0.5), (100, 0.1), (3000, 0.02)] {
            let shapes = strewn(count, size);
            let grid = Grid::new(1.0, &shapes).unwrap();
            let mut held = 0;
            for i in 0..20_000 {
                let [x, y, ..] = words(6, Stream::Photon, i, 0).map(|w| 1.4 * unit(w) - 0.2);
                let expected = shapes.iter().any(|shape| shape.contains(x, y));
                assert_eq!(grid.contains(x, y), expected, "({x}, {y}) of {count}");
                held += usize::from(expected);
            }
            assert!(held > 500, "{held}");
            // Points on corners and edges of a shape count as inside.
            for shape in &shapes {
                let [[left, right], [low, high]] = [0, 1].map(|axis| shape.bounds().extent(axis));
                let [x, y] = [0.5 * (left + right), 0.5 * (low + high)];
                for (x, y) in [(left, y), (right, y), (x, low), (x, high), (right, high)] {
                    assert_eq!(grid.contains(x, y), shapes.iter().any(|s| s.contains(x, y)));
                }
            }
            assert!(!grid.contains(f64::NAN, 0.5) && !grid.contains(f64::INFINITY, 0.5));
        }
    }

    #[test]
    fn bars_share_few_cells() {
        for axis in 0..2 {
            let bar = |i: u32| {
                let (mut center, mut size) = ([0.0; 2], [2e9; 2]);
                (center[axis], size[axis]) = (0.1 * f64::from(i), 0.07);
                Shape::Rectangle(Rectangle { center, size })
            };
            let bars: Vec<Shape> = (0..1000).map(bar).collect();
            let grid = Grid::new(1.0, &bars).unwrap();
            assert_eq!(grid.counts[axis], 4000);
            for i in 0..4000 {
                let mut at = [1e6; 2];
                at[axis] = 0.03 * f64::from(i) - 5.0;
                let expected = bars.iter().any(|bar| bar.contains(at[0], at[1]));
                assert_eq!(grid.contains(at[0], at[1]), expected, "{at:?}");
            }
        }
    }

    #[test]
    fn shapes_on_top_of_each_other_have_none() {
        assert!(Grid::new(1.0, &strewn(2000, 1.0)).is_none());
        assert!(Grid::new(1.0, &strewn(7, 0.1)).is_none());
    }
}
