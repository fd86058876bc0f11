//! Slices and projections of the light that leaves a receiver.

use super::Receiver;
use super::kernel::{KernelAxis, Kernels};
use crate::parallel::row::{FrequencyRow, slices_by_rows};
use etendue_field::{
    Complex, Projection, ProjectionGrid, Shape, SliceGrid, Slices, Window, cis, whole,
};
use ndarray::{Array1, Array2};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Minimum and maximum number of nodes along an axis of the receiver.
const NODES: [f64; 2] = [96.0, 1024.0];
/// Minimum number of nodes along an axis for a plain sum at one frequency, which is the reference
/// for faster sums.
const OF_PLAIN_SUMS: usize = 384;
/// Number of nodes for each cycle across the receiver. Two nodes are for the frequency of the
/// spectrum, and two nodes are for the frequencies of the incident light.
const PER_CYCLE: f64 = 4.0;
/// Number of nodes across the narrowest penumbra or period on the receiver.
const ACROSS: f64 = 8.0;
/// Minimum number of nodes across a feature that is considered resolved.
const MIN_NODES: f64 = 4.0;
/// The order of the quadrature error in the spacing of the nodes; it is two, because irradiance
/// has kinks where penumbras begin and end.
const ORDER: i32 = 2;
/// Minimum number of sample positions in a cell of a projection along each axis.
const PLACES: usize = 4;

/// A table of the radiance that leaves the receiver at its nodes, times the area of a node. The
/// reflected light has the frame D' = −D and X' = −X, so x' = −x and y' = y.
pub(super) struct ExitantTable {
    axes: [KernelAxis; 2],
    /// The coordinates x' and y' of the nodes, which are the centres of equal cells.
    coordinates: [Vec<f64>; 2],
    /// Radiance times the area of a node, as [x', y'].
    values: Array2<f64>,
}

impl Receiver<'_> {
    /// The slices of the spectrum of the reflected light under a window, after the light
    /// has travelled to the plane of the window.
    ///
    /// The sum over the receiver is a midpoint rule of second order, and
    /// [`quadrature_error`](Self::quadrature_error) returns its error. The integral over slopes is
    /// exact. The result is the same for any number of threads. Unit: W m⁻² sr⁻¹ · m².
    pub(crate) fn slices(&self, window: &Window, grid: &SliceGrid) -> Slices {
        self.slices_with(self.nodes(window, grid.rho.max()), window, grid)
    }

    /// The slices with a given number of nodes along each axis.
    pub(crate) fn slices_with(&self, nodes: usize, window: &Window, grid: &SliceGrid) -> Slices {
        self.table(window, nodes).slices(grid)
    }

    /// The spectrum at one frequency (Ωx, Ωy, Ωu, Ωv). It is a plain sum over at least as
    /// many nodes as slices use.
    pub(crate) fn at(&self, window: &Window, frequency: [f64; 4]) -> Complex {
        let highest = libm::hypot(frequency[0], frequency[1]);
        let nodes = self.nodes(window, highest).max(OF_PLAIN_SUMS);
        self.table(window, nodes).at(frequency)
    }

    /// ∫∫ ℓ' W dy dv as means over cells of (x, u), by the midpoint rule. Unit: W m⁻² sr⁻¹
    /// · m.
    pub(crate) fn projection(&self, window: &Window, grid: &ProjectionGrid) -> Projection {
        self.table(window, self.nodes(window, 0.0)).projection(grid)
    }

    /// The relative L2 error of slices. The error is the difference between the slices and
    /// slices from half as many nodes along each axis, divided by 2² − 1, because the error is of
    /// second order in the spacing. Returns `None` if the slices are zero.
    pub(crate) fn quadrature_error(
        &self,
        window: &Window,
        grid: &SliceGrid,
        slices: &Slices,
    ) -> Option<f64> {
        let half = self.nodes(window, grid.rho.max()) / 2;
        let coarse = self.slices_with(half, window, grid);
        let change = (&coarse.half - &slices.half).map(Complex::norm_sqr).sum();
        let all = slices.half.map(Complex::norm_sqr).sum();
        let error = (change / all).sqrt() / (2.0_f64.powi(ORDER) - 1.0);
        error.is_finite().then_some(error)
    }

    /// The number of nodes along each axis that resolves the narrowest penumbra or period
    /// and the highest frequency. The number is even, so that the error can be estimated with half
    /// as many nodes.
    pub(crate) fn nodes(&self, window: &Window, highest: f64) -> usize {
        let [fewest, most] = NODES;
        let side = self.side(window);
        let nodes = (ACROSS * side / self.finest()).max(fewest + PER_CYCLE * highest * side);
        2 * whole((0.5 * nodes.min(most)).ceil())
    }

    /// The width of the receiver that is seen through a window, in metres.
    fn side(&self, window: &Window) -> f64 {
        let [x, y] = axes(window, self.after).map(|axis| 2.0 * axis.reach());
        x.max(y)
    }

    /// Checks whether the maximum number of nodes resolves the pattern of light on the receiver.
    /// If it does not, the pattern is aliased, and the error estimate from coarser nodes is
    /// unreliable.
    pub(crate) fn is_resolved(&self, window: &Window) -> bool {
        let cell = self.side(window) / NODES[1];
        self.barriers.iter().all(|barrier| {
            let beyond = self.distance - barrier.distance;
            // For light from a single point, a mask's shadow on the receiver is larger than the
            // mask by this factor.
            let grown = self.distance / beyond;
            let is_told = |length: f64| length * grown > MIN_NODES * cell;
            let penumbra = self.width() * barrier.distance / beyond;
            match barrier.mask.grating() {
                Some(grating) => is_told(1.0 / grating.frequency.abs()),
                None => penumbra > MIN_NODES * cell || barrier.narrowest().is_none_or(is_told),
            }
        })
    }

    /// The smallest width of the light.
    fn width(&self) -> f64 {
        match self.light.shape {
            Some(Shape::Rectangle(r)) => r.size[0].min(r.size[1]),
            Some(Shape::Disc(d)) => d.radius,
            None => 0.0,
        }
    }

    /// The shortest length over which the irradiance changes: the narrowest penumbra, or
    /// the shortest period of a grating's shadow.
    fn finest(&self) -> f64 {
        let width = self.width();
        let lengths = self.barriers.iter().map(|barrier| {
            let beyond = self.distance - barrier.distance;
            match barrier.mask.grating() {
                Some(grating) => self.distance / (beyond * grating.frequency.abs()),
                None => width * barrier.distance / beyond,
            }
        });
        lengths.fold(self.distance, f64::min)
    }

    /// The radiance at `nodes` × `nodes` nodes over the part of the receiver that is seen
    /// through a window.
    pub(super) fn table(&self, window: &Window, nodes: usize) -> ExitantTable {
        let axes = axes(window, self.after);
        let size = axes.map(|axis| 2.0 * axis.reach() / nodes as f64);
        let middle = |k: usize, i: usize| (i as f64 + 0.5) * size[k] - axes[k].reach();
        let coordinates = [0, 1].map(|k| (0..nodes).map(|i| middle(k, i)).collect::<Vec<_>>());
        let weight = self.exitance() * size[0] * size[1];
        let [x, y] = &coordinates;
        let rows: Vec<Vec<f64>> = x
            .par_iter()
            .map(|&x| {
                let row = y.iter();
                row.map(|&y| weight * self.cell([-x, y], size)).collect()
            })
            .collect();
        let values = Array2::from_shape_fn((nodes, nodes), |(i, j)| rows[i][j]);
        ExitantTable {
            axes,
            coordinates,
            values,
        }
    }
}

pub(super) fn axes(window: &Window, after: f64) -> [KernelAxis; 2] {
    [(window.x, window.u), (window.y, window.v)].map(|(position, slope)| KernelAxis {
        position,
        slope,
        after,
    })
}

impl ExitantTable {
    pub(super) fn slices(&self, grid: &SliceGrid) -> Slices {
        slices_by_rows(grid, |along, rho| {
            let frequencies = along.map(|along| FrequencyRow {
                position: rho * along,
                step: grid.nu.spacing * along,
                half: grid.nu.half,
            });
            if self.axes[0].after > 0.0 {
                self.travelled(&frequencies)
            } else {
                self.at_receiver(&frequencies)
            }
        })
    }

    /// The spectrum at one frequency (Ωx, Ωy, Ωu, Ωv), as a plain sum over nodes.
    pub(super) fn at(&self, [x, y, u, v]: [f64; 4]) -> Complex {
        let kernel = |k: usize, frequency| {
            let (axis, coordinates) = (&self.axes[k], &self.coordinates[k]);
            axis.at(coordinates, frequency)
        };
        let [along_x, along_y] = [kernel(0, [x, u]), kernel(1, [y, v])];
        let values = self.values.indexed_iter();
        values.map(|((i, j), e)| along_x[i] * along_y[j] * e).sum()
    }

    /// A row of the spectrum if light does not travel after the reflection: radiance does
    /// not depend on the slope, so the spectrum is a product.
    fn at_receiver(&self, frequencies: &[FrequencyRow; 2]) -> Vec<Complex> {
        let wave = |k: usize| -> Vec<Complex> {
            let (window, frequency) = (self.axes[k].position, frequencies[k].position);
            let coordinates = self.coordinates[k].iter();
            coordinates
                .map(|&t| cis(-TAU * frequency * t) * window.value(t))
                .collect()
        };
        let [x, y] = [wave(0), wave(1)];
        let rows = self.values.outer_iter().zip(x);
        let position: Complex = rows
            .map(|(row, x)| x * row.iter().zip(&y).map(|(e, y)| y * e).sum::<Complex>())
            .sum();
        let slope = |k: usize, n| {
            let [_, nu] = frequencies[k].frequency(n);
            self.axes[k].slope.transform(nu)
        };
        (0..frequencies[0].count())
            .map(|n| position * slope(0, n) * slope(1, n))
            .collect()
    }

    /// A row of the spectrum after travel, as the sum Σ K(x') E(x', y') K(y') over nodes.
    fn travelled(&self, frequencies: &[FrequencyRow; 2]) -> Vec<Complex> {
        let kernels = |k: usize| self.axes[k].along(&self.coordinates[k], &frequencies[k]);
        let [x, y]: [Kernels; 2] = [kernels(0), kernels(1)];
        let (re, im) = (x.re.dot(&self.values), x.im.dot(&self.values));
        let dot = |a: &Array2<f64>, b: &Array2<f64>, n| a.row(n).dot(&b.row(n));
        (0..frequencies[0].count())
            .map(|n| {
                Complex::new(
                    dot(&re, &y.re, n) - dot(&im, &y.im, n),
                    dot(&re, &y.im, n) + dot(&im, &y.re, n),
                )
            })
            .collect()
    }

    fn projection(&self, grid: &ProjectionGrid) -> Projection {
        let across = self.across();
        let bins = grid.bins;
        let axis = &self.axes[0];
        let spacing = 2.0 * axis.reach() / across.len() as f64;
        let places = PLACES.max(whole((2.0 * grid.half_x / bins as f64 / spacing).ceil()));
        let inside = move |cell: usize, half: f64| {
            let fine = (bins * places) as f64;
            (0..places).map(move |k| ((cell * places + k) as f64 + 0.5) / fine * 2.0 * half - half)
        };
        let mean = |(i, j): (usize, usize)| {
            let rays =
                inside(i, grid.half_x).flat_map(|x| inside(j, grid.half_u).map(move |u| (x, u)));
            let sum: f64 = rays
                .map(|(x, u)| {
                    let window = axis.position.value(x) * axis.slope.value(u);
                    window * interpolated(&across, (x - axis.after * u) / spacing)
                })
                .sum();
            sum / (places * places) as f64
        };
        Projection {
            grid: *grid,
            values: Array2::from_shape_fn((bins, bins), mean),
        }
    }

    /// The windowed radiance integrated over y and v, for each x' of the nodes.
    fn across(&self) -> Vec<f64> {
        let axis = &self.axes[1];
        let kernel = axis.at(&self.coordinates[1], [0.0; 2]).into_iter();
        let kernel: Array1<f64> = kernel.map(|k| k.re).collect();
        // The values of the table include the area of a node; they are divided by the spacing
        // along x to obtain values per length along x.
        let spacing = 2.0 * self.axes[0].reach() / self.coordinates[0].len() as f64;
        (self.values.dot(&kernel) / spacing).to_vec()
    }
}

/// Interpolates linearly between the two values next to a position; the position is relative to
/// the middle of the values, in units of their spacing.
fn interpolated(values: &[f64], place: f64) -> f64 {
    let last = values.len() - 1;
    let place = (place + 0.5 * last as f64).clamp(0.0, last as f64);
    let below = whole(place).min(last - 1);
    let share = place - below as f64;
    values[below] * (1.0 - share) + values[below + 1] * share
}
