//! Slices by a midpoint rule over the coordinates of a plane.

use super::System;
use super::chain::Chain;
use super::field::{Exact, Field};
use super::incoming::Rule as LightRule;
use super::linear::Linear;
use super::parameter::Parameter;
use super::rule::{FEW, Rule, tiles, whole};
use super::table::Table;
use crate::error::distance;
use crate::geometry::Matrix;
use crate::rays::Plane;
use etendue_field::{Complex, Light, Projection, ProjectionGrid, SliceGrid, Slices, Window};

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

/// Fewest nodes along a coordinate, beside those that its frequencies ask for.
const FEWEST: f64 = 8.0;
/// Relative change at which a rule is good enough.
const ENOUGH: f64 = 3e-4;
/// What is left of an error over what a finer rule takes off.
const LEFT: f64 = 2.0;
/// Most nodes over the plane times parts of the light that they see.
const MOST: f64 = 6e7;
/// Nodes along each coordinate of the rule by which the one over the light is judged.
const TRIAL: usize = 12;

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
        light: FEW,
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
        light: if has_extent { FEW } else { 1 },
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
        light: rule.light.min(FEW),
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
