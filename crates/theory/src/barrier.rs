//! Masks that are prepared for many queries. A query asks what fraction of a ray's radiance passes,
//! or which shapes are near a ray.

use etendue_field::{HalfPlane, Hole, Mask, Shape, whole};

/// The lowest and highest coordinate of a rectangle along each of two axes.
pub(crate) type Bounds = [[f64; 2]; 2];

/// A mask that is prepared for many queries.
#[derive(Debug)]
pub(crate) struct Barrier<'a> {
    /// The distance of the mask in metres. The caller chooses whether it is the distance from the
    /// light or the distance before a receiver.
    pub(crate) distance: f64,
    /// The region that the mask's half-planes do not block. For an aperture, the bounds of its hole.
    pub(crate) open: Bounds,
    pub(crate) shapes: Bins<'a>,
    pub(crate) mask: &'a Mask,
}

impl<'a> Barrier<'a> {
    pub(crate) fn new(distance: f64, mask: &'a Mask) -> Self {
        let (shapes, half_planes): (&[Shape], &[HalfPlane]) = match mask {
            Mask::Opaque {
                shapes,
                half_planes,
            } => (shapes, half_planes),
            _ => (&[], &[]),
        };
        let mut open = match mask {
            Mask::Aperture(hole) => [0, 1].map(|axis| hole.bounds().extent(axis)),
            _ => [[f64::NEG_INFINITY, f64::INFINITY]; 2],
        };
        for half in half_planes {
            let [low, high] = &mut open[half.axis];
            if half.above {
                *high = high.min(half.edge);
            } else {
                *low = low.max(half.edge);
            }
        }
        Self {
            distance,
            open,
            shapes: Bins::new(shapes),
            mask,
        }
    }

    /// The disc outside which the mask is opaque, if the mask is an aperture with a disc as
    /// its hole.
    pub(crate) fn disc_hole(&self) -> Option<&Shape> {
        match self.mask {
            Mask::Aperture(Hole::Shape(disc @ Shape::Disc(_))) => Some(disc),
            _ => None,
        }
    }

    /// The smallest width among the shapes or of the hole, or `None` if there is neither.
    pub(crate) fn narrowest(&self) -> Option<f64> {
        match self.mask {
            Mask::Aperture(hole) => {
                let [w, h] = hole.bounds().size;
                Some(w.min(h))
            }
            _ => self.shapes.narrowest(),
        }
    }

    /// The fraction of radiance that passes the mask at (x, y).
    pub(crate) fn transmittance(&self, x: f64, y: f64) -> f64 {
        if !matches!(self.mask, Mask::Opaque { .. }) {
            return self.mask.transmittance(x, y);
        }
        let [ox, oy] = self.open;
        let between = |[low, high]: [f64; 2], t: f64| low < t && t < high;
        let mut blocked = !(between(ox, x) && between(oy, y));
        self.shapes
            .meeting([[x, x], [y, y]], |shape| blocked |= shape.contains(x, y));
        if blocked { 0.0 } else { 1.0 }
    }
}

/// Shapes that are indexed by a grid with about as many cells as shapes.
#[derive(Debug)]
pub(crate) struct Bins<'a> {
    shapes: &'a [Shape],
    low: [f64; 2],
    /// Number of cells per metre along each axis.
    per_length: [f64; 2],
    /// Number of cells along each axis.
    sides: [usize; 2],
    /// Indices of the shapes that touch each cell.
    cells: Vec<Vec<usize>>,
}

impl<'a> Bins<'a> {
    fn new(shapes: &'a [Shape]) -> Self {
        let extents = |axis| shapes.iter().map(move |s| s.bounds().extent(axis));
        let low = [0, 1].map(|axis| extents(axis).fold(f64::INFINITY, |m, e| m.min(e[0])));
        let high = [0, 1].map(|axis| extents(axis).fold(f64::NEG_INFINITY, |m, e| m.max(e[1])));
        // Shapes as wide as the grid would touch all of its cells along this axis.
        let abreast = [0, 1].map(|axis| {
            let widths = extents(axis).map(|[low, high]| high - low);
            shapes.len() as f64 * (high[axis] - low[axis]) / widths.sum::<f64>()
        });
        let sides = sides(shapes.len(), abreast);
        let mut bins = Self {
            shapes,
            low,
            per_length: [0, 1].map(|axis| sides[axis] as f64 / (high[axis] - low[axis])),
            sides,
            cells: vec![vec![]; sides[0] * sides[1]],
        };
        for (number, shape) in shapes.iter().enumerate() {
            let [x, y] = [0, 1].map(|axis| bins.touched(axis, shape.bounds().extent(axis)));
            for i in x {
                for j in y.clone() {
                    bins.cells[i * sides[1] + j].push(number);
                }
            }
        }
        bins
    }

    /// The smallest width among all shapes, or `None` if there are no shapes.
    fn narrowest(&self) -> Option<f64> {
        let widths = self.shapes.iter().map(|shape| {
            let [w, h] = shape.bounds().size;
            w.min(h)
        });
        widths.min_by(f64::total_cmp)
    }

    /// The range of cells that an interval along an axis overlaps; the outermost cells
    /// extend to infinity.
    fn touched(&self, axis: usize, [low, high]: [f64; 2]) -> std::ops::RangeInclusive<usize> {
        self.cell(axis, low)..=self.cell(axis, high)
    }

    fn cell(&self, axis: usize, coordinate: f64) -> usize {
        let cell = (coordinate - self.low[axis]) * self.per_length[axis];
        // NaN becomes zero.
        whole(cell.clamp(0.0, (self.sides[axis] - 1) as f64))
    }

    /// Calls `each` once for every shape whose bounds overlap the rectangle `sides`; the order of
    /// calls depends only on the rectangle.
    pub(crate) fn meeting(&self, sides: Bounds, mut each: impl FnMut(&'a Shape)) {
        if self.shapes.is_empty() {
            return;
        }
        let [x, y] = [0, 1].map(|axis| self.touched(axis, sides[axis]));
        for i in x.clone() {
            for j in y.clone() {
                for &number in &self.cells[i * self.sides[1] + j] {
                    let shape = &self.shapes[number];
                    let extents = [0, 1].map(|axis| shape.bounds().extent(axis));
                    // A shape that overlaps several cells is visited only in the first of its
                    // cells.
                    let first = [(0, *x.start()), (1, *y.start())]
                        .map(|(axis, start)| self.cell(axis, extents[axis][0]).max(start));
                    let meets = |axis: usize| {
                        extents[axis][0] <= sides[axis][1] && sides[axis][0] <= extents[axis][1]
                    };
                    if first == [i, j] && meets(0) && meets(1) {
                        each(shape);
                    }
                }
            }
        }
    }
}

/// The numbers of cells along two axes, with about `count` cells in all. There are at most
/// about as many along an axis as shapes fit side by side, which `abreast` gives.
fn sides(count: usize, abreast: [f64; 2]) -> [usize; 2] {
    let count = count.max(1) as f64;
    let most = abreast.map(|fit| {
        if fit > 1.0 {
            fit.ceil().min(count)
        } else {
            1.0
        }
    });
    let narrow = count.sqrt().ceil();
    // What one axis does not take is left for the other.
    let other = |axis: usize| (count / most[1 - axis].min(narrow)).ceil();
    [0, 1].map(|axis| whole(most[axis].min(narrow.max(other(axis)))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{blockers, square};
    use etendue_field::Rectangle;

    #[test]
    fn finds_each_shape_once() {
        let mut shapes: Vec<_> = blockers(12, 0.1, 0.06)
            .into_iter()
            .map(Shape::Rectangle)
            .collect();
        shapes.push(Shape::Rectangle(square([3.0, 0.2], 4.5)));
        let bins = Bins::new(&shapes);
        for k in 0..200 {
            let k = f64::from(k);
            let at = [libm::sin(1.7 * k), libm::cos(2.3 * k)];
            let half = 0.2 * libm::sin(0.9 * k).abs();
            let sides = at.map(|c| [c - half, c + half]);
            let mut found = Vec::new();
            bins.meeting(sides, |shape| found.push(shape.bounds().center));
            let mut expected: Vec<_> = shapes.iter().map(Shape::bounds).collect();
            expected.retain(|r| {
                [0, 1].iter().all(|&axis| {
                    let [low, high] = r.extent(axis);
                    low <= sides[axis][1] && sides[axis][0] <= high
                })
            });
            let mut expected: Vec<_> = expected.iter().map(|r| r.center).collect();
            let order = |a: &[f64; 2], b: &[f64; 2]| a.partial_cmp(b).unwrap();
            found.sort_by(order);
            expected.sort_by(order);
            assert_eq!(found, expected);
        }
    }

    /// A bar that is as long as the mask must not be listed in each of many cells along it.
    #[test]
    fn long_bars_touch_few_cells() {
        let bar = |i: u32| Rectangle {
            center: [f64::from(i), 0.0],
            size: [0.5, 1e9],
        };
        let shapes: Vec<_> = (0..1000).map(|i| Shape::Rectangle(bar(i))).collect();
        let bins = Bins::new(&shapes);
        assert_eq!(bins.sides, [1000, 1]);
        let listed = bins.cells.iter().map(Vec::len);
        assert!(listed.sum::<usize>() <= 2 * shapes.len());
        assert_eq!(sides(400, [28.0, 28.0]), [20, 20]);
    }
}
