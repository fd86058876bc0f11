//! Slices by quadrature.

use super::quadrature::{MOST_NODES, Rule};
use super::region::{Field, Finder};
use super::sums::sums;
use super::work::Size;
use super::{Plane, System};
use crate::error::distance;
use crate::geometry::{Map, SpectrumMap};
use etendue_field::{Mask, SliceGrid, Slices, Window};

/// A prediction by rays.
#[derive(Clone, Debug, PartialEq)]
pub struct RaySlices {
    /// The slices of the windowed spectrum.
    pub slices: Slices,
    /// ‖error‖/‖F‖: twice what finer rules change, on slices at right angles. Infinite if no ray arrives beside the central one.
    pub quadrature_error: f64,
    /// Rays of the rule, those outside the window included.
    pub nodes: usize,
    /// That rule.
    pub(super) rule: Rule,
}

/// Relative change at which a rule is good enough.
const ENOUGH: f64 = 1e-4;

/// The slices of the windowed spectrum, rays followed through the geometry as it is.
///
/// For a projector, point or beam a midpoint rule over the two coordinates of its rays, for an area light also a Gauss rule over the light.
/// Nodes are added until they change the slices by less than 10⁻⁴, or there are four million, or sums over them would take minutes. Unit: W m⁻² sr⁻¹ · m², on a surface
/// W m⁻² sr⁻¹ · m² rad². The same bytes on any number of threads.
#[must_use]
pub fn exact(system: &System, plane: &Plane, window: &Window, grid: &SliceGrid) -> RaySlices {
    let (open, opaque) = system.apart();
    let field = exact_field(&open, plane);
    predict(&field, &open, opaque, window, grid)
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
    let (open, opaque) = system.apart();
    let field = linear_field(&open, plane, map);
    predict(&field, &open, opaque, window, grid)
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

fn predict(
    field: &impl Field,
    system: &System,
    opaque: Vec<(f64, Mask)>,
    window: &Window,
    grid: &SliceGrid,
) -> RaySlices {
    let Some(finder) = Finder::new(field, window, system.emission(), opaque) else {
        return RaySlices {
            slices: Slices::zeros(*grid),
            quadrature_error: f64::INFINITY,
            nodes: 0,
            rule: Rule { outer: 1, inner: 1 },
        };
    };
    // Two slices at right angles tell how good a rule is.
    let trial = SliceGrid {
        azimuths: grid.azimuths.min(2),
        ..*grid
    };
    let slices = |rule| sums(&finder.nodes(rule), &trial);
    let size = Size::new(&finder, grid);
    let mut rule = finder.rule(grid);
    loop {
        let nodes = finder.nodes(rule);
        let outside = rule.finer_outside().map_or(0.0, |finer| {
            LEFT * distance(&sums(&nodes, &trial), &slices(finer))
        });
        // From a few points of the light the inner rule does as well as from many.
        let few = Rule {
            outer: rule.outer.min(SOME_POINTS),
            ..rule
        };
        let inside = LEFT * distance(&slices(few), &slices(few.finer_inside()));
        let mut next = rule;
        if inside > 0.5 * ENOUGH {
            next = next.finer_inside();
        }
        if outside > 0.5 * ENOUGH {
            next = next.finer_outside().unwrap_or(next);
        }
        if next == rule || next.nodes() > MOST_NODES || size.of(next).is_beyond() {
            return RaySlices {
                slices: sums(&nodes, grid),
                quadrature_error: inside + outside,
                nodes: rule.nodes(),
                rule,
            };
        }
        rule = next;
    }
}

/// Points of an area light from which the inner rule is tried, along each side.
const SOME_POINTS: usize = 8;
/// What is left of an error over what a finer rule takes off: a Hann window's falls as n⁻³ beyond its frequencies, (5/4)³ being 2.
const LEFT: f64 = 2.0;

impl Rule {
    fn finer_inside(self) -> Self {
        Self {
            inner: (self.inner * 5).div_ceil(4),
            ..self
        }
    }

    /// `None` where there is no outer rule. Beyond two nodes for a cycle each node more takes off a digit.
    fn finer_outside(self) -> Option<Self> {
        (self.outer > 1).then(|| Self {
            outer: self.outer + 4,
            ..self
        })
    }
}
