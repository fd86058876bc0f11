//! Records the crossings of a plane: applies the window, and accumulates sums.

use crate::batch::PlaneBatch;
use crate::histogram::ProjectionHistogram;
use crate::ray_moments::{LANES, MomentSums};
use etendue_field::{Crossing, PlaneTally, ProjectionGrid, Quantity, TwoPlane, VirtualPlane};
use etendue_transform::{Accumulator, SliceTransform};
use fearless_simd::{Level, dispatch};

/// Number of cells of a projection along x and along u.
pub const PROJECTION_BINS: usize = 64;

/// Number of crossings that are recorded together.
const GROUP: usize = 256;

/// Receives the crossings of one plane, multiplies their weights by the plane's window and by the
/// factor of the plane's quantity, and accumulates the sums.
pub(crate) struct Recorder<'plan> {
    plane: &'plan VirtualPlane,
    tally: PlaneTally,
    slices: Accumulator<'plan>,
    projection: ProjectionHistogram,
    moments: MomentSums,
    inside: Box<Inside>,
    level: Level,
}

/// Rays inside the window, as columns. The last column has the weights.
struct Inside {
    columns: [[f64; GROUP]; 5],
    count: usize,
}

impl<'plan> Recorder<'plan> {
    pub(crate) fn new(plane: &'plan VirtualPlane, plan: &'plan SliceTransform) -> Self {
        let cells = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
        Self {
            plane,
            tally: PlaneTally::default(),
            slices: plan.accumulator(),
            projection: ProjectionHistogram::new(cells),
            moments: MomentSums::default(),
            inside: Box::new(Inside {
                columns: [[0.0; GROUP]; 5],
                count: 0,
            }),
            level: Level::new(),
        }
    }

    pub(crate) fn record(&mut self, crossings: &[Crossing]) {
        for group in crossings.chunks(GROUP) {
            self.select(group);
            let Inside { columns, count } = &mut *self.inside;
            dispatch!(self.level, _simd => {
                weigh(self.plane, columns, *count);
                self.moments.deposit(columns, *count);
                let [x, _, u, _, weights] = &*columns;
                self.projection.deposit([x, u, weights], *count);
            });
            let columns = columns.each_ref().map(|column| &column[..*count]);
            self.slices.deposit_columns(columns);
        }
    }

    /// Copies the crossings inside the window to columns, and counts them. The loop has no branch,
    /// because the processor would mispredict it for a third of the crossings.
    fn select(&mut self, group: &[Crossing]) {
        let Inside { columns, count } = &mut *self.inside;
        let [x, y, u, v, weights] = columns;
        let mut next = 0;
        for Crossing { ray, weight } in group {
            let is_inside = self.plane.window.contains(ray);
            let at = next.min(GROUP - 1);
            (x[at], y[at], u[at], v[at]) = (ray.x, ray.y, ray.u, ray.v);
            weights[at] = *weight;
            next += usize::from(is_inside);
        }
        *count = next;
        let [crossed, inside] = [group.len(), next].map(|count| count as u64);
        self.tally.crossed += crossed;
        self.tally.inside += inside;
        self.tally.outside += crossed - inside;
    }

    /// The recorded sums divided by the number of emitted photons, and resets them for
    /// the next part.
    pub(crate) fn finish(&mut self, scale: f64) -> PlaneBatch {
        PlaneBatch {
            tally: std::mem::take(&mut self.tally),
            slices: self.slices.finish(scale),
            projection: self.projection.finish(scale),
            moments: self.moments.finish(scale),
        }
    }
}

/// Multiplies the weights of `count` rays by the window and by the factor of the plane's quantity.
/// Fills the columns up to a multiple of [`LANES`] with rays of weight zero.
#[inline(always)]
fn weigh(plane: &VirtualPlane, columns: &mut [[f64; GROUP]; 5], count: usize) {
    let full = count.next_multiple_of(LANES);
    for column in columns.iter_mut() {
        column[count..full].fill(0.0);
    }
    let [x, y, u, v, weights] = columns;
    let [x, y, u, v] = [&*x, y, u, v].map(|column| column.as_chunks::<LANES>().0);
    let weights = weights.as_chunks_mut::<LANES>().0;
    for (i, weights) in weights.iter_mut().enumerate().take(full / LANES) {
        let rays = [x[i], y[i], u[i], v[i]];
        let window = plane.window.values(&rays);
        for (weight, window) in weights.iter_mut().zip(window) {
            *weight *= window;
        }
        if plane.quantity != Quantity::Radiance {
            for (j, weight) in weights.iter_mut().enumerate() {
                let [x, y, u, v] = rays.each_ref().map(|column| column[j]);
                *weight *= plane.factor(&TwoPlane { x, y, u, v });
            }
        }
    }
}
