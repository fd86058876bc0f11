//! A midpoint rule over the rays of a projector, a point or a beam. The rays of these lights have
//! two coordinates.
//!
//! The rule sums the rays of a region of the emission. The region contains all rays that land in
//! the window. If the border of the region is dark, the only error is aliasing, which vanishes if
//! the rule has more nodes than the integrand has cycles. If an edge of a window or of a surface
//! cuts light, the rule misplaces this edge by up to half the spacing of nodes. If an edge cuts the
//! light, nets are used instead, because two rules may agree by chance.

use super::region::{Finder, RayField};
use super::sums::sums;
use crate::nets::RayNode;
use etendue_field::{SliceGrid, Slices, whole};
use rayon::prelude::*;

/// Maximum number of nodes of an acceptable rule along each coordinate.
const MAX_NODES: usize = 1500;
/// Minimum number of nodes of a rule along each coordinate.
const MIN_NODES: f64 = 16.0;
/// Maximum relative error of an acceptable rule.
const MAX_ERROR: f64 = 1e-4;
/// Estimated number of computing steps to follow a ray and to add its contribution to the sum at a
/// frequency.
const RAY: f64 = 300.0;
const FREQUENCY: f64 = 0.5;
/// A rule is not refined further if its relative error is below this number. The transform of
/// photons has an error of 2·10⁻⁷, so a smaller error of the rule cannot be detected with any
/// number of photons.
const TARGET_ERROR: f64 = 1e-7;
/// The bound on the error of the finer of two rules is this number times the difference between
/// them. Beyond the frequencies of a Hann window, the error falls as n⁻³. The error of the coarser
/// rule is then (5/4)³ times, or about twice, the error of the finer rule.
const FINER_ERROR: f64 = 1.0;

impl<F: RayField> Finder<'_, F> {
    /// The slices and ‖error‖/‖F‖. The error is the sum of two parts: the change of two
    /// slices at right angles by the last refinement, and a bound on the error that edges cause.
    /// The rule is refined until its error is below 10⁻⁷ or the next rule would take more than
    /// `max_steps`. Returns `None` if the error stays above 10⁻⁴.
    pub(super) fn slices(&self, grid: &SliceGrid, max_steps: f64) -> Option<(Slices, f64)> {
        let trial = SliceGrid {
            azimuths: grid.azimuths.min(2),
            ..*grid
        };
        let edges = self.edges();
        if edges > MAX_ERROR * MAX_NODES as f64 {
            return None;
        }
        let cells: usize = grid.half_shape().iter().product();
        let max_rays = max_steps / (RAY + FREQUENCY * cells as f64);
        let is_affordable = |n: usize| n <= MAX_NODES && (n * n) as f64 <= max_rays;
        let finer = |n: usize| (n * 5).div_ceil(4);
        let mut count = self.count(grid);
        if !is_affordable(finer(count)) {
            return None;
        }
        let mut coarse = sums(&self.nodes(count), &trial);
        loop {
            count = finer(count);
            let nodes = self.nodes(count);
            let fine = sums(&nodes, &trial);
            let error = FINER_ERROR * coarse.relative_difference(&fine) + edges / count as f64;
            if error <= TARGET_ERROR || !is_affordable(finer(count)) {
                return (error <= MAX_ERROR).then(|| (sums(&nodes, grid), error));
            }
            coarse = fine;
        }
    }

    /// All rays of the rule that land in the window, in an order that does not depend on
    /// the number of threads.
    pub(super) fn nodes(&self, count: usize) -> Vec<RayNode> {
        let Some([a, b]) = self.region() else {
            return Vec::new();
        };
        let [da, db] = [a, b].map(|[low, high]| (high - low) / count as f64);
        let row = |i: usize| {
            let at = a[0] + (i as f64 + 0.5) * da;
            let ray = move |j: usize| self.ray([at, b[0] + (j as f64 + 0.5) * db]);
            let nodes = (0..count).map(move |j| self.node(ray(j), da * db));
            nodes.filter(|node| node.weight != 0.0)
        };
        (0..count).into_par_iter().flat_map_iter(row).collect()
    }

    /// The number of nodes along each coordinate that should suffice. It exceeds the number
    /// of cycles, because a midpoint rule is exact for functions with fewer cycles than nodes.
    fn count(&self, grid: &SliceGrid) -> usize {
        let [rho, nu] = [grid.rho.max(), grid.nu.max()];
        let window = [self.window.x, self.window.y, self.window.u, self.window.v];
        // Returns the number of cycles per unit of an emission coordinate `k`. The cycles are those
        // that the phases of the spectrum and the window cause.
        let cycles = |k: usize| {
            let column = self.neighbourhood.1.map(|row| row[k]);
            let phase =
                rho * libm::hypot(column[0], column[1]) + nu * libm::hypot(column[2], column[3]);
            let widths = column.iter().zip(window);
            let window = widths.map(|(c, profile)| c.abs() / profile.half_width());
            phase + window.fold(0.0, f64::max)
        };
        let count = self.region().map_or(MIN_NODES, |region| {
            let along = |axis: usize| {
                let [low, high] = region[axis];
                let frequency = cycles(self.emission.inner[axis]) + self.emission.cycles[axis];
                (high - low) * frequency
            };
            MIN_NODES + along(0).max(along(1))
        });
        whole(count.ceil().clamp(1.0, 1e6))
    }
}
