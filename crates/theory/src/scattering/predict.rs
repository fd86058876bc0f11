//! Slices by a midpoint rule over the coordinates of a plane.

use super::System;
use super::chain::Chain;
use super::field::{Exact, Field};
use super::incoming::Rule as LightRule;
use super::linear::Linear;
use super::parameter::Parameter;
use super::rule::{FEW, Rule, tiles, whole};
use super::table::Table;
use super::work::Cost;
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
pub(super) const MOST: f64 = 6e7;
/// Nodes along each coordinate of the rule by which the one over the light is judged.
const TRIAL: usize = 12;
/// Nodes across a picture: enough for a window and what changes slowly in it.
const ACROSS: usize = 6;

/// The slices of the windowed spectrum of what a surface scatters, as it is.
///
/// A midpoint rule over the plane's four coordinates, and a Gauss rule over each part of the light; nodes are added until they change the
/// slices by less than 3 · 10⁻⁴, or there are sixty million, or they would take minutes. Unit: W m⁻² sr⁻¹ · m², on a surface W m⁻² sr⁻¹ · m² rad². The same bytes on any number
/// of threads.
#[must_use]
pub fn exact(system: &System, plane: &Plane, window: &Window, grid: &SliceGrid) -> Prediction {
    let search = Search::new(system, plane, window, grid);
    let (rule, light) = search.over_light(search.first());
    search.over_plane(rule, light)
}

/// The search for a rule that is good enough.
pub(super) struct Search<'a> {
    field: Exact<'a>,
    window: &'a Window,
    grid: &'a SliceGrid,
    cost: Cost,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        system: &'a System,
        plane: &'a Plane,
        window: &'a Window,
        grid: &'a SliceGrid,
    ) -> Self {
        Self {
            field: Exact(system, plane),
            window,
            grid,
            cost: Cost::new(system, plane),
        }
    }

    /// What frequencies and tiles ask for.
    pub(super) fn first(&self) -> Rule {
        let Exact(system, plane) = self.field;
        let Self { window, grid, .. } = self;
        let widths = [window.x, window.y, window.u, window.v].map(|p| p.half_width());
        let cycles = [grid.rho.max(), grid.rho.max(), grid.nu.max(), grid.nu.max()];
        let along: [f64; 4] = std::array::from_fn(|i| FEWEST + 4.0 * widths[i] * cycles[i]);
        Rule {
            plane: along.map(whole),
            light: if has_extent(&system.light) { FEW } else { 1 },
            tiles: [0, 1].map(|axis| tiles(system, plane, window, axis)),
        }
        .aligned()
    }

    fn table(&self, rule: Rule) -> Table {
        Table::new(&self.field, self.field.1, self.window, rule)
    }

    fn slices(&self, rule: Rule) -> Slices {
        self.table(rule).slices(self.grid)
    }

    /// How many nodes over the light a place sees.
    fn seen(&self, rule: Rule) -> f64 {
        let light = LightRule::new(rule.light, &self.field.0.light);
        let leaving = self.field.leaving([0.0; 4]);
        leaving.map_or(1, |leaving| self.field.shines(&leaving, &light).len()) as f64
    }

    /// Whether a rule may take the place of a coarser one.
    fn affords(&self, rule: Rule, seen: f64) -> bool {
        rule.places() * seen <= MOST && !self.cost.is_beyond(rule, seen)
    }

    /// A rule with as many nodes over the light as are needed, and the error they leave.
    fn over_light(&self, mut rule: Rule) -> (Rule, f64) {
        let error = |rule: Rule| {
            let few = Rule {
                plane: rule.plane.map(|n| n.min(TRIAL)),
                ..rule
            }
            .aligned();
            LEFT * distance(&self.slices(few), &self.slices(few.finer_light()))
        };
        if !has_extent(&self.field.0.light) {
            return (rule, 0.0);
        }
        let mut left = error(rule);
        while left > 0.5 * ENOUGH && self.affords(rule, self.seen(rule.finer_light())) {
            rule = rule.finer_light();
            left = error(rule);
        }
        (rule, left)
    }

    /// With as many nodes over the plane as are needed; `light` is the error that those over the light leave.
    fn over_plane(&self, mut rule: Rule, light: f64) -> Prediction {
        let (few, each) = (rule.coarser(), self.seen(rule));
        // Along one axis, with fewer nodes along the rest.
        let along = |axis: usize, rule: Rule| {
            let mut along = few;
            along.plane[axis] = rule.plane[axis];
            along
        };
        // The slices of a finer rule, and how far they are from these.
        let tried = |axis: usize, rule: Rule, slices: &Slices| {
            let finer = self.slices(along(axis, rule).finer_along(axis));
            let error = LEFT * distance(slices, &finer);
            (finer, error)
        };
        let mut trials: [(Slices, f64); 4] =
            std::array::from_fn(|axis| tried(axis, rule, &self.slices(along(axis, rule))));
        loop {
            let mut next = rule;
            for (axis, (_, error)) in trials.iter().enumerate() {
                if *error > 0.25 * ENOUGH {
                    next = next.finer_along(axis);
                }
            }
            if next == rule || !self.affords(next, each) {
                break;
            }
            for axis in (0..4).filter(|&axis| next.plane[axis] != rule.plane[axis]) {
                trials[axis] = tried(axis, next, &trials[axis].0);
            }
            rule = next;
        }
        let table = self.table(rule);
        let inside: f64 = trials.iter().map(|(_, error)| error).sum();
        Prediction {
            slices: table.slices(self.grid),
            // Of a dark field nothing can be said.
            quadrature_error: if inside.is_finite() {
                inside + light
            } else {
                f64::INFINITY
            },
            covariance: table.covariance(),
            rule,
        }
    }
}

/// Whether light comes to a point from more than one direction.
fn has_extent(light: &Light) -> bool {
    !matches!(
        light,
        Light::Point { .. } | Light::Projector { .. } | Light::Beam { .. }
    )
}

/// The slices that the first-order [`chain`](super::chain) predicts, by the rule of the exact prediction; `None` where it cannot be inverted.
#[must_use]
pub fn linear(
    system: &System,
    plane: &Plane,
    window: &Window,
    grid: &SliceGrid,
    chain: &Chain,
    exact: &Prediction,
) -> Option<Slices> {
    let field = Linear::new(system, chain)?;
    Some(Table::new(&field, plane, window, exact.rule).slices(grid))
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
        plane: [grid.bins, ACROSS, grid.bins, ACROSS],
        light: FEW,
        tiles: [1; 2],
    };
    let table = Table::new(&Exact(system, plane), plane, window, rule);
    Projection {
        grid: *grid,
        values: table.projected() / grid.cell_area(),
    }
}
