//! Estimates the work to predict the light that leaves a receiver. Computing steps are counted at a
//! few points of the receiver.

use super::density::ReceiverDensity;
use super::kernel::KernelAxis;
use super::region::ReceiverRegion;
use super::{Receiver, SlopeProjection, exitant};
use crate::barrier::Barrier;
use crate::work::PredictionWork;
use etendue_field::{ProjectionGrid, SliceGrid, Window};

/// Number of points along each axis at which steps are counted.
const SOME: usize = 4;
/// Maximum number of computing steps that are counted at a point; counting stops at this number. If
/// each point takes so many steps, even the smallest table takes longer than all limits on the work
/// of a prediction allow, so the exact number does not matter.
const MAX_STEPS: f64 = 1e8;
/// Estimated number of computing steps to test a shape, and to clip a region to a shape that
/// blocks light.
const SHAPE: f64 = 100.0;
/// Estimated number of computing steps to add one node to the sum at one frequency.
const SUM: f64 = 0.6;

impl Receiver<'_> {
    /// Estimates the work of slices, their error estimate, their derivatives and a picture;
    /// `derivatives` is the number of derivatives.
    pub(crate) fn work(
        &self,
        window: &Window,
        grid: &SliceGrid,
        picture: &ProjectionGrid,
        derivatives: f64,
    ) -> PredictionWork {
        let nodes = self.nodes(window, grid.rho.max());
        let axes = exitant::axes(window, self.after);
        let place = self.mean_steps(&axes, nodes);
        let places = (nodes * nodes) as f64;
        // The error estimate uses a table with half as many nodes along each axis.
        let tables = 2.25 + derivatives;
        let irradiance = PredictionWork {
            steps: tables * places * place,
            bytes: 3.0 * 8.0 * places,
            bytes_each: 0.0,
            drivers: format!(
                "{tables} tables of {nodes} x {nodes} places, {place:.0} steps for each place; places are as dense as the fringes of the spectrum require"
            ),
        };
        let cells = (picture.bins * picture.bins) as f64;
        let in_cell = 4.0_f64.max(nodes as f64 / picture.bins as f64 + 1.0);
        let picture = PredictionWork {
            steps: 20.0 * cells * in_cell * in_cell,
            ..PredictionWork::none()
        };
        irradiance
            .then(sums(&axes, nodes as f64, grid).times(1.25 + derivatives))
            .then(picture)
    }

    /// The mean number of computing steps for the irradiance in a cell, over [`SOME`] ×
    /// [`SOME`] points.
    fn mean_steps(&self, axes: &[KernelAxis; 2], nodes: usize) -> f64 {
        let size = axes.map(|axis| 2.0 * axis.reach() / nodes as f64);
        let at = |k: usize, i: usize| {
            let share = (2 * i + 1) as f64 / SOME as f64 - 1.0;
            share * axes[k].reach()
        };
        let places = (0..SOME).flat_map(|i| (0..SOME).map(move |j| [i, j]));
        let steps = places.map(|[i, j]| self.steps([-at(0, i), at(1, j)], size));
        steps.sum::<f64>() / (SOME * SOME) as f64
    }

    /// Estimates the number of computing steps of [`Self::cell`].
    fn steps(&self, center: [f64; 2], size: [f64; 2]) -> f64 {
        let (bundle, region) = self.lit(center, size);
        let density = self.density(&bundle, &self.barriers);
        let mut steps = SHAPE;
        self.count(&bundle, &region, &self.barriers, &density, &mut steps);
        steps
    }

    /// Adds the number of computing steps of [`Self::passed`] to `steps`, up to [`MAX_STEPS`].
    fn count(
        &self,
        bundle: &SlopeProjection,
        region: &ReceiverRegion,
        barriers: &[Barrier<'_>],
        density: &ReceiverDensity<'_>,
        steps: &mut f64,
    ) {
        let Some((barrier, rest)) = barriers.split_first() else {
            *steps += region.steps(density);
            return;
        };
        let before = barrier.distance;
        let Some(open) = region.open(bundle, barrier) else {
            return;
        };
        let place = bundle.positions(open.bounds(), before);
        barrier.shapes.meeting(place, |shape| {
            *steps += SHAPE;
            if *steps < MAX_STEPS
                && let Some(part) = open.cut(&bundle.seen(shape, before))
            {
                self.count(bundle, &part, rest, density, steps);
            }
        });
        if *steps < MAX_STEPS {
            self.count(bundle, &open, rest, density, steps);
        }
    }
}

/// Estimates the work to compute slices from a table of radiance.
fn sums(axes: &[KernelAxis; 2], nodes: f64, grid: &SliceGrid) -> PredictionWork {
    let [azimuths, rows, count] = grid.half_shape().map(|n| n as f64);
    let highest = [grid.rho.max(), grid.nu.max()];
    let (rule, row, bytes_each) = if axes[0].after > 0.0 {
        let rule = axes.each_ref().map(|axis| axis.nodes(highest));
        // The Gauss rule of n nodes is computed again for each row. For each of its nodes, a
        // recurrence of n steps is computed.
        let kernels = rule.map(|n| nodes * n * (2.0 * count + 40.0) + 10.0 * n * n);
        let sums = 2.0 * SUM * nodes * nodes * count;
        (rule, kernels[0] + kernels[1] + sums, 48.0 * nodes * count)
    } else {
        ([0.0; 2], 5.0 * nodes * nodes + 50.0 * count, 32.0 * nodes)
    };
    PredictionWork {
        steps: azimuths * rows * row,
        bytes: 32.0 * azimuths * rows * count,
        bytes_each,
        drivers: format!(
            "{azimuths} x {rows} x {count} frequencies x {nodes} x {nodes} places, with {:.0} nodes over slopes",
            rule[0].max(rule[1])
        ),
    }
}
