//! Determines the order with which the error of the first-order chain decreases as the
//! neighbourhood shrinks.

use super::TableRun;
use crate::predicted;
use crate::report::{Bound::AtMost, Check};
use etendue_field::{FrequencyAxis, Orientation, SliceGrid, Specular, Window};
use etendue_theory::geometry::Edition;
use etendue_theory::rays::{self, SpecularSystem};
use etendue_theory::{Model, Observed, Parameter};

/// Sizes of the neighbourhood, relative to the size in the scene file.
const SIZES: [f64; 4] = [1.0, 0.5, 0.25, 0.125];

/// Maximum deviation of a fitted order from the known order.
pub(crate) const ORDER: f64 = 0.15;

/// Checks that the order fitted to decreasing errors equals the known order.
pub(crate) fn check(fitted: f64, known: f64) -> Check {
    let off = (fitted - known).abs();
    Check::new("order", off, AtMost(ORDER), "error of a fit to four sizes")
}

/// Angle of incidence below which an angle counts as 0, radians.
const NORMAL: f64 = 1e-6;

/// The order known in advance (docs/theory.md, section 7).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum KnownOrder {
    /// The chain is exact: the path has only travel and plane mirrors.
    Exact,
    /// The error is of first order: light arrives obliquely at some surface.
    First,
    /// The error is of second order: light arrives along the normal of every surface.
    Second,
}

impl KnownOrder {
    /// Returns the order at which the error at a plane is known to decrease.
    pub(super) fn expected(view: &Observed<SpecularSystem>) -> Self {
        let Observed { system, plane } = view;
        let across = plane.orientation == Orientation::Orthogonal;
        let flat = |e: &rays::SpecularSurface| {
            let flat = e.patch.curvature.iter().all(|k| k.abs() <= 0.0);
            flat && matches!(e.event, Specular::Mirror)
        };
        if across && system.elements.iter().all(flat) {
            return Self::Exact;
        }
        let angle = |i: usize| view.value(Parameter::Incidence(i)).unwrap_or(0.0);
        let mut angles = (0..system.elements.len()).map(angle);
        let here = if across { 0.0 } else { plane.longitude };
        if here.abs() > NORMAL || angles.any(|a| a.abs() > NORMAL) {
            Self::First
        } else {
            Self::Second
        }
    }

    /// Returns the exponent with which the error decreases, or `None` if the chain has no error.
    pub(super) fn exponent(self) -> Option<f64> {
        match self {
            Self::Exact => None,
            Self::First => Some(1.0),
            Self::Second => Some(2.0),
        }
    }
}

/// The error of the chain at each size of the neighbourhood, and the fitted exponent.
#[derive(Clone, Debug)]
pub(super) struct Fall {
    pub(super) errors: [f64; 4],
    pub(super) order: f64,
}

/// Computes ‖first order − exact‖/‖exact‖ on neighbourhoods of all sizes, and fits its order.
///
/// # Panics
/// Panics if the chain does not arrive.
pub(super) fn fall(outcome: &TableRun, index: usize) -> Fall {
    let view = outcome.system(index);
    let at = &outcome.scene.planes[index];
    let map = rays::chain(&view, Edition::Corrected).expect("light arrives");
    let errors = SIZES.map(|size| {
        let view = Observed {
            system: view.system.shrunk(size),
            plane: view.plane,
        };
        let (window, grid) = (narrowed(&at.window, size), widened(&at.grid, size));
        let exact = predicted::traced(&view, &window, &grid).slices;
        let linear = predicted::linear(&view, &window, &grid, &map.map);
        linear.independent_relative_difference(&exact)
    });
    let logs = [0, 1, 2, 3].map(|i: usize| [SIZES[i].ln(), errors[i].ln()]);
    Fall {
        errors,
        order: slope(&logs),
    }
}

/// Returns the slope of the least-squares line.
pub(crate) fn slope(points: &[[f64; 2]]) -> f64 {
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|p| p[axis]).sum::<f64>() / count;
    let [a, b] = [mean(0), mean(1)];
    let both: f64 = points.iter().map(|p| (p[0] - a) * (p[1] - b)).sum();
    let own: f64 = points.iter().map(|p| (p[0] - a).powi(2)).sum();
    both / own
}

fn narrowed(window: &Window, size: f64) -> Window {
    Window {
        x: window.x.scaled(size),
        y: window.y.scaled(size),
        u: window.u.scaled(size),
        v: window.v.scaled(size),
    }
}

fn widened(grid: &SliceGrid, size: f64) -> SliceGrid {
    let axis = |axis: FrequencyAxis| FrequencyAxis {
        spacing: axis.spacing / size,
        ..axis
    };
    SliceGrid {
        azimuths: grid.azimuths,
        rho: axis(grid.rho),
        nu: axis(grid.nu),
    }
}
