//! The light that leaves a receiver, as slices and projections.

use super::Receiver;
use super::kernel::{Axis, Kernels};
use crate::chain::no_closed_form;
use crate::row::Row;
use etendue_field::{Complex, Light, Projection, ProjectionGrid, Shape, SliceGrid, Slices, Window};
use ndarray::{Array1, Array2};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Fewest and most nodes along an axis of the receiver.
const NODES: [usize; 2] = [384, 1024];
/// Nodes across the narrowest penumbra or period on the receiver.
const ACROSS: f64 = 8.0;
/// How the error falls with the spacing of the nodes: irradiance has kinks where penumbras begin and end.
const ORDER: i32 = 2;
/// Places in a cell of a projection along each axis, at least.
const PLACES: usize = 4;

/// Radiance that leaves the receiver, times the area of a node. Reflection turns the frame round: x' = −x,
/// y' = y, as D' = −D and X' = −X.
pub(super) struct Table {
    axes: [Axis; 2],
    /// x' and y' of the nodes: the middles of equal cells.
    coordinates: [Vec<f64>; 2],
    /// [x', y'].
    values: Array2<f64>,
}

impl Receiver<'_> {
    /// The slices of the spectrum of the reflected light, after its travel, under a window.
    ///
    /// Midpoint rule of second order over the receiver, [`quadrature_error`](Self::quadrature_error) says how
    /// good; exact in slopes. Rows are computed in parallel, each by one thread: the same for any number of
    /// threads. Unit: W m⁻² sr⁻¹ · m².
    pub(crate) fn slices(&self, window: &Window, grid: &SliceGrid) -> Slices {
        self.table(window, self.nodes(window)).slices(grid)
    }

    /// The spectrum at one frequency (Ωx, Ωy, Ωu, Ωv): a plain sum over the same nodes.
    pub(crate) fn at(&self, window: &Window, frequency: [f64; 4]) -> Complex {
        self.table(window, self.nodes(window)).at(frequency)
    }

    /// ∫∫ ℓ' W dy dv as means over cells of (x, u), by the midpoint rule. Unit: W m⁻² sr⁻¹ · m.
    pub(crate) fn projection(&self, window: &Window, grid: &ProjectionGrid) -> Projection {
        self.table(window, self.nodes(window)).projection(grid)
    }

    /// Relative L2 error of slices: what half as many nodes along each axis change, over 2² − 1 since the error
    /// is of second order in their spacing. `None` if the slices are zero.
    pub(crate) fn quadrature_error(
        &self,
        window: &Window,
        grid: &SliceGrid,
        slices: &Slices,
    ) -> Option<f64> {
        let coarse = self.table(window, self.nodes(window) / 2).slices(grid);
        let change = (&coarse.half - &slices.half).map(Complex::norm_sqr).sum();
        let all = slices.half.map(Complex::norm_sqr).sum();
        let error = (change / all).sqrt() / (2.0_f64.powi(ORDER) - 1.0);
        error.is_finite().then_some(error)
    }

    /// Nodes along each axis: enough for the narrowest penumbra or period. Even, so that they can be halved.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped first"
    )]
    pub(super) fn nodes(&self, window: &Window) -> usize {
        let side = axes(window, self.after).map(|axis| 2.0 * axis.reach());
        let [fewest, most] = NODES.map(|n| n as f64);
        let nodes = ACROSS * side[0].max(side[1]) / self.finest();
        2 * (0.5 * nodes.clamp(fewest, most)).ceil() as usize
    }

    /// The shortest length over which the irradiance changes: a penumbra, or the period of a grating.
    fn finest(&self) -> f64 {
        let width = match self.light {
            Light::Area { shape, .. } => match shape {
                Shape::Rectangle(r) => r.size[0].min(r.size[1]),
                Shape::Disc(d) => d.radius,
            },
            Light::Point { .. } => 0.0,
            Light::Projector { .. } | Light::Beam { .. } | Light::Environment { .. } => {
                no_closed_form()
            }
        };
        let lengths = self.barriers.iter().map(|barrier| {
            let beyond = self.distance - barrier.distance;
            match barrier.grating {
                Some(grating) => self.distance / (beyond * grating.frequency.abs()),
                None => width * barrier.distance / beyond,
            }
        });
        lengths.fold(self.distance, f64::min)
    }

    /// Radiance on `nodes` × `nodes` nodes over what is seen through a window.
    pub(super) fn table(&self, window: &Window, nodes: usize) -> Table {
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
        Table {
            axes,
            coordinates,
            values,
        }
    }
}

pub(super) fn axes(window: &Window, after: f64) -> [Axis; 2] {
    [(window.x, window.u), (window.y, window.v)].map(|(position, slope)| Axis {
        position,
        slope,
        after,
    })
}

impl Table {
    pub(super) fn slices(&self, grid: &SliceGrid) -> Slices {
        let [azimuths, rows, _] = grid.half_shape();
        let values: Vec<Vec<Complex>> = (0..azimuths * rows)
            .into_par_iter()
            .map(|i| {
                let (sin, cos) = grid.azimuth(i / rows).sin_cos();
                let rho = (i % rows) as f64 * grid.rho.spacing;
                let frequencies = [cos, sin].map(|along| Row {
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
            .collect();
        let mut slices = Slices::zeros(*grid);
        for (to, from) in slices.half.rows_mut().into_iter().zip(values) {
            to.into_iter().zip(from).for_each(|(to, from)| *to = from);
        }
        slices
    }

    /// One frequency (Ωx, Ωy, Ωu, Ωv), node by node.
    pub(super) fn at(&self, [x, y, u, v]: [f64; 4]) -> Complex {
        let kernel = |k: usize, frequency| {
            let (axis, coordinates) = (&self.axes[k], &self.coordinates[k]);
            axis.at(coordinates, frequency)
        };
        let [along_x, along_y] = [kernel(0, [x, u]), kernel(1, [y, v])];
        let values = self.values.indexed_iter();
        values.map(|((i, j), e)| along_x[i] * along_y[j] * e).sum()
    }

    /// A row where nothing travels: radiance does not know the slope, and the spectrum is a product.
    fn at_receiver(&self, frequencies: &[Row; 2]) -> Vec<Complex> {
        let wave = |k: usize| -> Vec<Complex> {
            let (window, frequency) = (self.axes[k].position, frequencies[k].position);
            let coordinates = self.coordinates[k].iter();
            coordinates
                .map(|&t| Complex::from_polar(window.value(t), -TAU * frequency * t))
                .collect()
        };
        let [x, y] = [wave(0), wave(1)];
        let rows = self.values.outer_iter().zip(x);
        let position: Complex = rows
            .map(|(row, x)| x * row.iter().zip(&y).map(|(e, y)| y * e).sum::<Complex>())
            .sum();
        let slope = |k: usize, n| self.axes[k].slope_spectrum(frequencies[k].frequency(n)[1]);
        (0..frequencies[0].count())
            .map(|n| position * slope(0, n) * slope(1, n))
            .collect()
    }

    /// A row after travel: Σ K(x') E(x', y') K(y').
    fn travelled(&self, frequencies: &[Row; 2]) -> Vec<Complex> {
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
        let places = PLACES.max(places(2.0 * grid.half_x / bins as f64 / spacing));
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

    /// Radiance integrated over y and v, for each x'.
    fn across(&self) -> Vec<f64> {
        let axis = &self.axes[1];
        let kernel = axis.at(&self.coordinates[1], [0.0; 2]).into_iter();
        let kernel: Array1<f64> = kernel.map(|k| k.re).collect();
        // The table holds the area of a node; along x it is a value.
        let spacing = 2.0 * self.axes[0].reach() / self.coordinates[0].len() as f64;
        (self.values.dot(&kernel) / spacing).to_vec()
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a positive number, rounded up"
)]
fn places(nodes: f64) -> usize {
    nodes.ceil() as usize
}

/// The straight line between the two values next to a place, in units of their spacing from the middle.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped first"
)]
fn interpolated(values: &[f64], place: f64) -> f64 {
    let last = values.len() - 1;
    let place = (place + 0.5 * last as f64).clamp(0.0, last as f64);
    let below = (place as usize).min(last - 1);
    let share = place - below as f64;
    values[below] * (1.0 - share) + values[below + 1] * share
}
