//! Slices by quadrature.

use super::quadrature::{MOST_NODES, Rule};
use super::region::{Field, Finder};
use super::sums::sums;
use super::{Plane, System};
use crate::error::distance;
use crate::geometry::{Map, SpectrumMap};
use etendue_field::{SliceGrid, Slices, Window};

/// A prediction by rays.
#[derive(Clone, Debug, PartialEq)]
pub struct RaySlices {
    /// The slices of the windowed spectrum.
    pub slices: Slices,
    /// ‖error‖/‖F‖: what rules half as fine again change, and so more than is left of it. Infinite if no ray arrives beside the central one.
    pub quadrature_error: f64,
    /// Rays of the last rule, those outside the window included.
    pub nodes: usize,
    /// That rule.
    pub(super) rule: Rule,
}

/// Relative change at which a rule is good enough.
const ENOUGH: f64 = 1e-4;

/// The slices of the windowed spectrum, rays followed through the geometry as it is.
///
/// For a projector, point or beam a midpoint rule over the two coordinates of its rays, for an area light also a Gauss rule over the light.
/// Nodes are added until they change the slices by less than 10⁻⁴, or there are four million. Unit: W m⁻² sr⁻¹ · m², on a surface
/// W m⁻² sr⁻¹ · m² rad². The same bytes on any number of threads.
#[must_use]
pub fn exact(system: &System, plane: &Plane, window: &Window, grid: &SliceGrid) -> RaySlices {
    let field = exact_field(system, plane);
    predict(&field, system, window, grid)
}

/// The slices that a first-order chain predicts, such as that of [`chain`](super::chain), by the same quadrature.
///
/// The radiance of ray z at the light goes to A z + t, A being the transpose of the map's matrix and t its phase, and its spectrum is multiplied by
/// the map's factor: F = factor · ∫ ℓ(z) W(A z + t) e^(−2πi Ω·(A z + t)) dz. Masks of the first leg are exact.
#[must_use]
pub fn linear(
    system: &System,
    plane: &Plane,
    window: &Window,
    grid: &SliceGrid,
    map: &SpectrumMap<4>,
) -> RaySlices {
    let field = linear_field(system, plane, map);
    predict(&field, system, window, grid)
}

pub(super) fn exact_field<'a>(system: &'a System, plane: &'a Plane) -> impl Field + 'a {
    move |ray| {
        let flux = system.flux(ray);
        let (z, per_flux) = plane.coordinates(&system.follow(ray)?)?;
        Some((z, flux * per_flux))
    }
}

fn linear_field<'a>(
    system: &'a System,
    plane: &'a Plane,
    map: &'a SpectrumMap<4>,
) -> impl Field + 'a {
    let rays = Map {
        matrix: crate::geometry::transpose(&map.matrix),
        offset: map.phase,
    };
    move |ray: [f64; 4]| {
        let [.., u, v] = ray;
        let radiance = system.flux(ray) * (1.0 + u * u + v * v).powi(2);
        let z = rays.apply(ray);
        Some((z, map.factor * radiance * plane.factor(z)))
    }
}

fn predict(field: &impl Field, system: &System, window: &Window, grid: &SliceGrid) -> RaySlices {
    let Some(finder) = Finder::new(field, window, system.emission()) else {
        return RaySlices {
            slices: Slices::zeros(*grid),
            quadrature_error: f64::INFINITY,
            nodes: 0,
            rule: Rule { outer: 1, inner: 1 },
        };
    };
    let slices = |rule| sums(&finder.nodes(rule), grid);
    let mut rule = finder.rule(grid);
    let mut coarse = slices(rule);
    loop {
        let inner = rule.finer_inside();
        let finer_inside = slices(inner);
        let mut best = finer_inside.clone();
        let errors = [
            distance(&coarse, &finer_inside),
            rule.finer_outside().map_or(0.0, |outer| {
                let finer_outside = slices(outer);
                let error = distance(&coarse, &finer_outside);
                // Both gains at once: what is left are their products.
                best.half += &finer_outside.half;
                best.half -= &coarse.half;
                error
            }),
        ];
        let mut next = if errors[0] > 0.5 * ENOUGH {
            inner
        } else {
            rule
        };
        if errors[1] > 0.5 * ENOUGH {
            next = next.finer_outside().unwrap_or(next);
        }
        let largest = next
            .finer_outside()
            .unwrap_or(next)
            .nodes()
            .max(next.finer_inside().nodes());
        if next == rule || largest > MOST_NODES {
            return RaySlices {
                slices: best,
                quadrature_error: errors.iter().sum(),
                nodes: inner.nodes(),
                rule,
            };
        }
        coarse = if next == inner {
            finer_inside
        } else {
            slices(next)
        };
        rule = next;
    }
}

impl Rule {
    fn finer_inside(self) -> Self {
        Self {
            inner: self.inner.div_ceil(2) * 3,
            ..self
        }
    }

    /// `None` where there is no outer rule.
    fn finer_outside(self) -> Option<Self> {
        (self.outer > 1).then(|| Self {
            outer: self.outer.div_ceil(2) * 3,
            ..self
        })
    }
}
