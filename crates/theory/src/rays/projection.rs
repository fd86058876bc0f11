use super::emission::{passed, point_of};
use super::predict::exact_field;
use super::region::{Field, Finder};
use super::sums::Node;
use super::{Plane, System};
use etendue_field::{Projection, ProjectionGrid, Window};
use rayon::prelude::*;

/// Rays in a picture.
const RAYS: usize = 1 << 21;
/// Points of an area light along each side.
const POINTS: usize = 32;

/// The windowed light field integrated over y and v, as means over cells of (x, u), by rays as in [`exact`](super::exact).
///
/// Two million rays on a lattice without repeating distances (Roberts 2018, the R₂ sequence), each in the cell it falls into: for pictures, good to
/// about a hundredth in a cell. Unit: W m⁻² sr⁻¹ · m.
#[must_use]
pub fn projection(
    system: &System,
    plane: &Plane,
    window: &Window,
    grid: &ProjectionGrid,
) -> Projection {
    let (open, opaque) = system.apart();
    let field = exact_field(&open, plane);
    let bins = grid.bins;
    let mut values = ndarray::Array2::zeros((bins, bins));
    let cells = Finder::new(&field, window, open.emission(), opaque)
        .map_or_else(Vec::new, |finder| finder.binned(grid));
    // Parts in order.
    for part in cells {
        values += &part;
    }
    values /= grid.cell_area();
    Projection {
        grid: *grid,
        values,
    }
}

impl<F: Field> Finder<'_, F> {
    /// Sums over cells, from parts of the light.
    fn binned(&self, grid: &ProjectionGrid) -> Vec<ndarray::Array2<f64>> {
        let Some(shape) = &self.emission.shape else {
            let parts = 16;
            return (0..parts)
                .into_par_iter()
                .map(|part| {
                    self.part(
                        [0.0; 2],
                        1.0,
                        part * RAYS / parts..(part + 1) * RAYS / parts,
                        grid,
                    )
                })
                .collect();
        };
        (0..POINTS)
            .into_par_iter()
            .map(|row| {
                let mut sum = ndarray::Array2::zeros((grid.bins, grid.bins));
                for column in 0..POINTS {
                    let i = row * POINTS + column;
                    let [a, b] = lattice(i);
                    let side = POINTS as f64;
                    let from =
                        point_of(shape, [(row as f64 + a) / side, (column as f64 + b) / side]);
                    let each = RAYS / (POINTS * POINTS);
                    let share = shape.area() / (POINTS * POINTS) as f64;
                    sum += &self.part(
                        from,
                        share * RAYS as f64 / each as f64,
                        i * each..(i + 1) * each,
                        grid,
                    );
                }
                sum
            })
            .collect()
    }

    /// Rays from one point of the light.
    fn part(
        &self,
        from: [f64; 2],
        share: f64,
        rays: std::ops::Range<usize>,
        grid: &ProjectionGrid,
    ) -> ndarray::Array2<f64> {
        let mut sum = ndarray::Array2::zeros((grid.bins, grid.bins));
        let Some(region) = self.region(from) else {
            return sum;
        };
        let area: f64 = region.iter().map(|[low, high]| high - low).product();
        let share = share * area / RAYS as f64;
        for i in rays {
            let at = lattice(i);
            let inner = [0, 1].map(|k| region[k][0] + at[k] * (region[k][1] - region[k][0]));
            let ray = self.ray(from, inner);
            let Node { z, weight } = self.node(ray, share);
            if let Some(cell) = grid.cell(z[0], z[2]) {
                sum[cell] += weight * passed(&self.opaque, ray);
            }
        }
        sum
    }
}

/// Multiples of 1/g and 1/g², g³ = g + 1, without their whole parts.
fn lattice(i: usize) -> [f64; 2] {
    [0.754_877_666_246_692_7, 0.569_840_290_998_053_3].map(|step| (i as f64 * step).fract())
}
