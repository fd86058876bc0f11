//! Slices by a midpoint rule over the coordinates of a plane.

use super::System;
use super::chain::Chain;
use super::incoming::Rule as LightRule;
use super::linear::Linear;
use super::parameter::Parameter;
use crate::error::distance;
use crate::geometry::Matrix;
use crate::rays::Plane;
use etendue_field::{
    Complex, Light, Orientation, Pattern, Projection, ProjectionGrid, SliceGrid, Slices, TwoPlane,
    Window,
};
use ndarray::{Array2, Axis};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// A prediction of a scattered light field.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// The slices of the windowed spectrum.
    pub slices: Slices,
    /// ‖error‖/‖F‖: twice what finer rules change. Infinite if no light arrives.
    pub quadrature_error: f64,
    /// Second central moments of the windowed light field, in the plane's coordinates; `None` if no light arrives.
    pub covariance: Option<Matrix<4>>,
    rule: Rule,
}

/// How many nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rule {
    /// Along x, y, u and v: a midpoint rule over the window.
    plane: [usize; 4],
    /// Along each side of a part of the light: a Gauss rule; 1 where there is no light with an extent.
    light: usize,
    /// Along x and y: their number is a multiple of these, so that tiles of a checkerboard end between them.
    tiles: [usize; 2],
}

/// Fewest nodes along a coordinate, beside those that its frequencies ask for.
const FEWEST: f64 = 8.0;
/// Nodes of the first rule over the light.
const LIGHT: usize = 4;
/// Relative change at which a rule is good enough.
const ENOUGH: f64 = 3e-4;
/// What is left of an error over what a finer rule takes off.
const LEFT: f64 = 2.0;
/// Most nodes over the plane times parts of the light that they see.
const MOST: f64 = 6e7;
/// Nodes along each coordinate of the rule by which the one over the light is judged.
const TRIAL: usize = 12;

/// A light field over the coordinates of a plane.
trait Field: Sync {
    /// Where a ray of the plane leaves the surface.
    type Leaving;
    type Shining;
    fn leaving(&self, z: [f64; 4]) -> Option<Self::Leaving>;
    /// What shines there.
    fn shines(&self, leaving: &Self::Leaving, rule: &LightRule) -> Vec<Self::Shining>;
    fn radiance(&self, leaving: &Self::Leaving, shines: &[Self::Shining]) -> f64;
    fn system(&self) -> &System;
}

struct Exact<'a>(&'a System, &'a Plane);

impl Field for Exact<'_> {
    type Leaving = super::exact::Leaving;
    type Shining = super::exact::Shining;
    fn leaving(&self, z: [f64; 4]) -> Option<Self::Leaving> {
        self.0.leaving(self.1, z)
    }
    fn shines(&self, leaving: &Self::Leaving, rule: &LightRule) -> Vec<Self::Shining> {
        self.0.shines(leaving, rule)
    }
    fn radiance(&self, leaving: &Self::Leaving, shines: &[Self::Shining]) -> f64 {
        let Self(system, plane) = self;
        let radiance = system.radiance(leaving, shines);
        if plane.orientation.is_local() {
            // On the surface itself the integral is over its area, which exceeds that of the tangent plane.
            radiance / leaving.normal.dot(plane.frame.d).abs()
        } else {
            radiance
        }
    }
    fn system(&self) -> &System {
        self.0
    }
}

impl Field for Linear<'_> {
    type Leaving = [f64; 4];
    type Shining = super::linear::Shining;
    fn leaving(&self, z: [f64; 4]) -> Option<[f64; 4]> {
        Some(self.local(z))
    }
    fn shines(&self, leaving: &[f64; 4], rule: &LightRule) -> Vec<Self::Shining> {
        Linear::shines(self, *leaving, rule)
    }
    fn radiance(&self, leaving: &[f64; 4], shines: &[Self::Shining]) -> f64 {
        Linear::radiance(self, *leaving, shines)
    }
    fn system(&self) -> &System {
        self.system
    }
}

/// The slices of the windowed spectrum of what a surface scatters, as it is.
///
/// A midpoint rule over the plane's four coordinates, and a Gauss rule over each part of the light; nodes are added until they change the
/// slices by less than 3 · 10⁻⁴, or there are sixty million. Unit: W m⁻² sr⁻¹ · m², on a surface W m⁻² sr⁻¹ · m² rad². The same bytes on any number
/// of threads.
#[must_use]
pub fn exact(system: &System, plane: &Plane, window: &Window, grid: &SliceGrid) -> Prediction {
    predict(&Exact(system, plane), system, plane, window, grid)
}

/// The slices that the first-order [`chain`](super::chain) predicts, by the same rule; `None` where it cannot be inverted.
#[must_use]
pub fn linear(
    system: &System,
    plane: &Plane,
    window: &Window,
    grid: &SliceGrid,
    chain: &Chain,
) -> Option<Prediction> {
    let field = Linear::new(system, chain)?;
    Some(predict(&field, system, plane, window, grid))
}

/// The derivative of the exact slices by a parameter, per unit of it: a central difference of the rule of the prediction.
#[must_use]
pub fn derivative(
    system: &System,
    plane: &Plane,
    parameter: Parameter,
    window: &Window,
    grid: &SliceGrid,
    prediction: &Prediction,
) -> Option<Slices> {
    const STEP: f64 = 1e-3;
    let value = system.value(parameter)?;
    let step = STEP * value.abs().max(0.1);
    // Good to a per cent is good enough.
    let rule = prediction.rule.coarser();
    let at = |value: f64| {
        let system = system.with(parameter, value)?;
        let table = Table::new(&Exact(&system, plane), plane, window, rule);
        Some(table.slices(grid))
    };
    let (mut above, below) = (at(value + step)?, at(value - step)?);
    above.half -= &below.half;
    above.half /= Complex::from(2.0 * step);
    Some(above)
}

/// The windowed light field integrated over y and v, as means over cells of (x, u), by the midpoint rule: for pictures.
#[must_use]
pub fn projection(
    system: &System,
    plane: &Plane,
    window: &Window,
    grid: &ProjectionGrid,
) -> Projection {
    let rule = Rule {
        plane: [grid.bins, TRIAL, grid.bins, TRIAL],
        light: LIGHT,
        tiles: [1; 2],
    };
    let table = Table::new(&Exact(system, plane), plane, window, rule);
    Projection {
        grid: *grid,
        values: table.projected() / grid.cell_area(),
    }
}

fn predict(
    field: &impl Field,
    system: &System,
    plane: &Plane,
    window: &Window,
    grid: &SliceGrid,
) -> Prediction {
    let widths = [window.x, window.y, window.u, window.v].map(|p| p.half_width());
    let cycles = [grid.rho.max(), grid.rho.max(), grid.nu.max(), grid.nu.max()];
    let along: [f64; 4] = std::array::from_fn(|i| FEWEST + 4.0 * widths[i] * cycles[i]);
    let tiles = [0, 1].map(|axis| tiles(system, plane, window, axis));
    let has_extent = !matches!(
        system.light,
        Light::Point { .. } | Light::Projector { .. } | Light::Beam { .. }
    );
    let mut rule = Rule {
        plane: along.map(whole),
        light: if has_extent { LIGHT } else { 1 },
        tiles,
    }
    .aligned();
    let table = |rule: Rule| Table::new(field, plane, window, rule);
    let of = |rule: Rule| table(rule).slices(grid);
    // How many parts of the light a place sees.
    let parts = |rule: Rule| {
        let light = LightRule::new(rule.light, &system.light);
        let seen = field.leaving([0.0; 4]);
        seen.map_or(1, |leaving| field.shines(&leaving, &light).len()) as f64
    };
    let light_error = |rule: Rule| {
        let coarse = Rule {
            plane: rule.plane.map(|n| n.min(TRIAL)),
            ..rule
        }
        .aligned();
        LEFT * distance(&of(coarse), &of(coarse.finer_light()))
    };
    let mut light = if has_extent { light_error(rule) } else { 0.0 };
    while light > 0.5 * ENOUGH && rule.places() * parts(rule.finer_light()) < MOST {
        rule = rule.finer_light();
        light = light_error(rule);
    }
    let few = |rule: Rule| Rule {
        light: rule.light.min(LIGHT),
        ..rule
    };
    let (first, each) = (rule, parts(rule));
    loop {
        // Along one axis after the other, with fewer nodes along the rest.
        let errors: [f64; 4] = std::array::from_fn(|axis| {
            let mut thin = few(first.coarser());
            thin.plane[axis] = rule.plane[axis];
            LEFT * distance(&of(thin), &of(thin.finer_along(axis)))
        });
        let mut next = rule;
        for (axis, error) in errors.iter().enumerate() {
            if *error > 0.25 * ENOUGH {
                next = next.finer_along(axis);
            }
        }
        if next == rule || next.places() * each > MOST {
            let table = table(rule);
            let inside: f64 = errors.iter().sum();
            return Prediction {
                slices: table.slices(grid),
                // Of a dark field nothing can be said.
                quadrature_error: if inside.is_finite() {
                    inside + light
                } else {
                    f64::INFINITY
                },
                covariance: table.covariance(),
                rule,
            };
        }
        rule = next;
    }
}

/// How many tiles of a checkerboard the window of a plane on the surface holds along an axis, if they fit; else 1.
fn tiles(system: &System, plane: &Plane, window: &Window, axis: usize) -> usize {
    let reflectance = &system.reflectance;
    let patterns = reflectance.blend.iter().map(|(_, pattern)| pattern);
    let mut periods = patterns
        .chain(&reflectance.texture)
        .filter_map(|p| match p {
            Pattern::Checkerboard { period } => Some(*period),
            _ => None,
        });
    let axes = [plane.frame.x, plane.frame.y];
    let own = [system.patch.frame.x, system.patch.frame.y];
    let along = axes[axis].dot(own[axis]).abs() > 1.0 - 1e-9;
    let centered = (plane.frame.origin - system.patch.frame.origin).length() < 1e-9;
    let is_flat = system.patch.curvature.iter().all(|k| k.abs() <= 0.0);
    let on_it =
        plane.orientation.is_local() || plane.orientation == Orientation::Tangent && is_flat;
    let Some(period) = periods.next_back().filter(|_| along && centered && on_it) else {
        return 1;
    };
    let half = [window.x, window.y][axis].half_width();
    let tiles = 4.0 * half / period;
    let fit = (tiles - tiles.round()).abs() < 1e-9 && (1.0..1e3).contains(&tiles);
    // The middle of the window is the end of a tile too.
    let pairs = 2 * whole(0.5 * tiles.round());
    let count = whole(tiles.round());
    match (fit, count == pairs) {
        (false, _) => 1,
        (true, true) => count,
        (true, false) => 2 * count,
    }
}

impl Rule {
    /// Nodes over the plane.
    fn places(&self) -> f64 {
        self.plane.iter().map(|n| *n as f64).product()
    }

    fn coarser(self) -> Self {
        Self {
            plane: self.plane.map(|n| (n * 3).div_ceil(5)),
            light: self.light.min(LIGHT),
            ..self
        }
        .aligned()
    }

    fn finer_along(mut self, axis: usize) -> Self {
        self.plane[axis] = (self.plane[axis] * 4).div_ceil(3);
        self.aligned()
    }

    fn aligned(mut self) -> Self {
        for (nodes, tiles) in self.plane.iter_mut().zip(self.tiles) {
            *nodes = nodes.next_multiple_of(tiles);
        }
        self
    }

    fn finer_light(self) -> Self {
        Self {
            light: (self.light * 3).div_ceil(2),
            ..self
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "not negative; beyond a thousand it is cut down"
)]
fn whole(x: f64) -> usize {
    x.ceil().min(1e3) as usize
}

/// The windowed light field at the nodes of a rule, times their volume.
struct Table {
    coordinates: [Vec<f64>; 4],
    /// [(x, y), (u, v)].
    values: Array2<f64>,
}

impl Table {
    fn new<F: Field>(field: &F, plane: &Plane, window: &Window, rule: Rule) -> Self {
        let profiles = [window.x, window.y, window.u, window.v];
        let coordinates: [Vec<f64>; 4] = std::array::from_fn(|axis| {
            let (n, half) = (rule.plane[axis], profiles[axis].half_width());
            (0..n)
                .map(|i| half * ((2.0 * i as f64 + 1.0) / n as f64 - 1.0))
                .collect()
        });
        let volume: f64 = (0..4)
            .map(|axis| 2.0 * profiles[axis].half_width() / rule.plane[axis] as f64)
            .product();
        let light = LightRule::new(rule.light, &field.system().light);
        let [xs, ys, us, vs] = &coordinates;
        let rows: Vec<Vec<f64>> = (0..xs.len() * ys.len())
            .into_par_iter()
            .map(|row| {
                let (x, y) = (xs[row / ys.len()], ys[row % ys.len()]);
                // On the surface itself one place is seen in all directions.
                let one_place = plane.orientation.is_local();
                let mut shared = None;
                let mut values = Vec::with_capacity(us.len() * vs.len());
                for &u in us {
                    for &v in vs {
                        let z = [x, y, u, v];
                        let weight = window.value(&TwoPlane { x, y, u, v });
                        let Some(leaving) = field.leaving(z).filter(|_| weight > 0.0) else {
                            values.push(0.0);
                            continue;
                        };
                        let shines = match shared.take() {
                            Some(shines) => shines,
                            None => field.shines(&leaving, &light),
                        };
                        let radiance = field.radiance(&leaving, &shines);
                        if one_place {
                            shared = Some(shines);
                        }
                        values.push(volume * weight * plane.factor(z) * radiance);
                    }
                }
                values
            })
            .collect();
        let values = Array2::from_shape_fn((rows.len(), us.len() * vs.len()), |(i, j)| rows[i][j]);
        Self {
            coordinates,
            values,
        }
    }

    fn slices(&self, grid: &SliceGrid) -> Slices {
        let mut slices = Slices::zeros(*grid);
        let [xs, ys, us, vs] = &self.coordinates;
        let each: Vec<Array2<Complex>> = (0..grid.azimuths)
            .into_par_iter()
            .map(|k| {
                let (sin, cos) = grid.azimuth(k).sin_cos();
                // Along one azimuth a place is one number, and so are slopes.
                let waves = |a: &[f64], b: &[f64], frequencies: &[f64]| {
                    let places: Vec<f64> = a
                        .iter()
                        .flat_map(|p| b.iter().map(move |q| p * cos + q * sin))
                        .collect();
                    let phase = |i: usize, j: usize| -TAU * frequencies[i] * places[j];
                    let shape = (frequencies.len(), places.len());
                    [
                        Array2::from_shape_fn(shape, |(i, j)| phase(i, j).cos()),
                        Array2::from_shape_fn(shape, |(i, j)| phase(i, j).sin()),
                    ]
                };
                let rho: Vec<f64> = (0..=grid.rho.half)
                    .map(|m| m as f64 * grid.rho.spacing)
                    .collect();
                let [re, im] = waves(xs, ys, &rho).map(|wave| wave.dot(&self.values));
                let [cos, sin] = waves(us, vs, &grid.nu.values());
                let real = re.dot(&cos.t()) - im.dot(&sin.t());
                let imaginary = re.dot(&sin.t()) + im.dot(&cos.t());
                Array2::from_shape_fn(real.dim(), |at| Complex::new(real[at], imaginary[at]))
            })
            .collect();
        for (mut slice, values) in slices.half.axis_iter_mut(Axis(0)).zip(each) {
            slice.assign(&values);
        }
        slices
    }

    /// Each value with its coordinates.
    fn nodes(&self) -> impl Iterator<Item = ([f64; 4], f64)> + '_ {
        let [xs, ys, us, vs] = &self.coordinates;
        self.values.indexed_iter().map(move |((i, j), value)| {
            let z = [
                xs[i / ys.len()],
                ys[i % ys.len()],
                us[j / vs.len()],
                vs[j % vs.len()],
            ];
            (z, *value)
        })
    }

    /// Sums over y and v, [x, u].
    fn projected(&self) -> Array2<f64> {
        let [xs, ys, us, vs] = &self.coordinates;
        let mut sums = Array2::zeros((xs.len(), us.len()));
        for ((i, j), value) in self.values.indexed_iter() {
            sums[[i / ys.len(), j / vs.len()]] += value;
        }
        sums
    }

    fn covariance(&self) -> Option<Matrix<4>> {
        let total = self.values.sum();
        if total <= 0.0 {
            return None;
        }
        let mut mean = [0.0; 4];
        for (z, value) in self.nodes() {
            for (mean, z) in mean.iter_mut().zip(z) {
                *mean += value / total * z;
            }
        }
        let mut moments = [[0.0; 4]; 4];
        for (z, value) in self.nodes() {
            for i in 0..4 {
                for j in 0..4 {
                    moments[i][j] += value / total * (z[i] - mean[i]) * (z[j] - mean[j]);
                }
            }
        }
        Some(moments)
    }
}
