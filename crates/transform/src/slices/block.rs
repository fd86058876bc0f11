//! Blocks of rays that are spread on the fine grid together.

use etendue_field::TwoPlane;

/// Number of rays in a group. The positions and weights of all rays of a group are computed first,
/// and then the rays are added to the grid.
pub(crate) const GROUP: usize = 32;

/// Number of rays of a full block. The block is read once for each azimuth, while the fine grid of
/// this azimuth stays in the cache. With four planes in turn, blocks of 16384 rays were 8 % faster
/// than blocks of 4096 rays.
const CAPACITY: usize = 16384;

/// Rays waiting to be spread, one array for each coordinate, in order of arrival.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
    pub(crate) u: Vec<f64>,
    pub(crate) v: Vec<f64>,
    pub(crate) weight: Vec<f64>,
}

impl Block {
    /// An empty block with its full capacity allocated.
    pub(crate) fn new() -> Self {
        let column = || Vec::with_capacity(CAPACITY);
        Self {
            x: column(),
            y: column(),
            u: column(),
            v: column(),
            weight: column(),
        }
    }

    /// Adds a ray.
    #[inline]
    pub(crate) fn push(&mut self, ray: &TwoPlane, weight: f64) {
        self.x.push(ray.x);
        self.y.push(ray.y);
        self.u.push(ray.u);
        self.v.push(ray.v);
        self.weight.push(weight);
    }

    /// Adds rays given as columns of x, y, u, v and weight, up to the capacity. Returns the number
    /// of rays added.
    pub(crate) fn extend(&mut self, more: [&[f64]; 5]) -> usize {
        let count = more[0].len().min(CAPACITY - self.weight.len());
        for (column, more) in self.columns().into_iter().zip(more) {
            column.extend_from_slice(&more[..count]);
        }
        count
    }

    /// Checks whether the block must be spread before another ray is added.
    #[inline]
    pub(crate) fn is_full(&self) -> bool {
        self.weight.len() == CAPACITY
    }

    /// Pads the last group with rays of zero weight.
    pub(crate) fn pad(&mut self) {
        let length = self.weight.len().next_multiple_of(GROUP);
        for column in self.columns() {
            column.resize(length, 0.0);
        }
    }

    /// Empties the block.
    pub(crate) fn clear(&mut self) {
        for column in self.columns() {
            column.clear();
        }
    }

    fn columns(&mut self) -> [&mut Vec<f64>; 5] {
        [
            &mut self.x,
            &mut self.y,
            &mut self.u,
            &mut self.v,
            &mut self.weight,
        ]
    }
}
