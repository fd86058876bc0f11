//! Predicts the slices of scattered light by sums over scrambled nets of rays.

use super::draw::{LightStrategy, Lights, PlaneRaySampler, sky_density};
use super::exact::Leaving;
use super::incoming::LightPart;
use super::linear::Linear;
use crate::model::{Over, ShiftedModels};
use crate::nets::{self, DIMENSIONS, Integrand, RayBudget, RayNets, RayNode};
use crate::obstacle::LegRay;
use crate::path::{Observed, PathChain, PathSystem, PreparedPath};
use crate::plane::Plane;
use crate::predicted::Predicted;
use etendue_field::{EnvironmentMap, Light, SliceGrid, TwoPlane, Window};
use glam::DVec3;

/// Returns the windowed spectrum of the light that a surface scatters, and its derivatives with
/// respect to given parameters.
///
/// Rays are sampled at the plane. Each ray leaves the surface at a point, and one or four parts of
/// the light that shine on this point are sampled (docs/theory.md (40)). `chain` guides the
/// sampling; the function [`chain`](crate::path::chain()) returns such a chain. The result is bitwise
/// identical on any number of threads.
///
/// The difference between the chain and the exact prediction is a sum over rays of differences
/// between two radiances of the same ray. The derivatives are also such sums. These sums are
/// accurate to about a per cent of their values. Sampled parts of the light move with the light, so
/// the edges of the light cause no edges in a difference. However, sampled parts do not move with
/// the shadows of masks. Therefore points that are lit in only one of the two radiances add noise.
/// A larger step of the difference reduces this noise.
pub(crate) fn predict(
    view: &Observed,
    chain: Option<&PathChain>,
    moved: &[ShiftedModels<Observed>],
    (window, grid, picture): Over<'_>,
    budget: RayBudget,
) -> Predicted {
    let budget = affordable(&view.system, budget);
    let strategy = fastest(view, chain, (window, grid), budget);
    let field = ScatteredField::new(view, window, chain, strategy);
    let around = VariedFields::new(&field, chain, moved, strategy);
    let found = nets::sums(&field, (window, grid), picture.bins, budget);
    let mut means = nets::means(&around, (window, grid), &found).into_iter();
    Predicted {
        to_first_order: around.linear.as_ref().and_then(|_| means.next()),
        derivatives: means.map(|mean| mean.slices).collect(),
        ..found
    }
}

/// Calls `then` with the rays that [`predict`] sums over nets.
pub(crate) fn with_rays(
    view: &Observed,
    chain: Option<&PathChain>,
    (window, grid, _): Over<'_>,
    budget: RayBudget,
    then: &mut dyn FnMut(&dyn RayNets),
) {
    let budget = affordable(&view.system, budget);
    let strategy = fastest(view, chain, (window, grid), budget);
    let field = ScatteredField::new(view, window, chain, strategy);
    then(&nets::SampledNets::new(&field, budget));
}

/// Returns the strategy that has the smallest error for the same computing time.
fn fastest(
    view: &Observed,
    chain: Option<&PathChain>,
    (window, grid): (&Window, &SliceGrid),
    budget: RayBudget,
) -> LightStrategy {
    best(&view.system, |strategy| {
        let field = ScatteredField::new(view, window, chain, strategy);
        nets::trial(&field, (window, grid), budget).powi(2) * strategy.time()
    })
}

/// Returns a reduced budget that takes as much time for this system as `budget` takes for an
/// environment of few lobes.
fn affordable(system: &PathSystem, budget: RayBudget) -> RayBudget {
    RayBudget {
        nodes: budget.nodes / cost(system),
        ..budget
    }
}

/// Returns the exact prediction, and the difference between a given chain and this prediction. The
/// chain may differ from the result of [`chain`](crate::path::chain()).
#[must_use]
pub fn compare_chain(
    view: &Observed,
    chain: &PathChain,
    over: Over<'_>,
    budget: RayBudget,
) -> Predicted {
    predict(view, Some(chain), &[], over, budget)
}

/// Returns the computing time of a ray, relative to a ray in an environment of few lobes.
fn cost(system: &PathSystem) -> f64 {
    const FEW_LOBES: f64 = 16.0;
    match &system.light {
        Light::Environment { environment } => match &environment.map {
            EnvironmentMap::Lobes(lobes) => 1.0 + lobes.len() as f64 / FEW_LOBES,
            EnvironmentMap::LatLong(_) => 1.0,
        },
        _ => 1.0,
    }
}

/// Returns the strategy with the smallest cost. The search is greedy and tries each of the choices
/// once.
fn best(system: &PathSystem, cost: impl Fn(LightStrategy) -> f64) -> LightStrategy {
    let mut best = LightStrategy::default();
    let mut least = cost(best);
    for change in LightStrategy::CHOICES {
        let mut next = best;
        change(&mut next);
        let next = next.in_effect(system);
        if next == best {
            continue;
        }
        let tried = cost(next);
        if tried < least {
            (best, least) = (next, tried);
        }
    }
    best
}

/// The exact light field of a scattering surface, with the densities that sample it.
struct ScatteredField<'a> {
    view: &'a Observed,
    window: &'a Window,
    path: PreparedPath<'a>,
    rays: PlaneRaySampler,
    lights: Lights<'a>,
}

impl<'a> ScatteredField<'a> {
    fn new(
        view: &'a Observed,
        window: &'a Window,
        chain: Option<&PathChain>,
        strategy: LightStrategy,
    ) -> Self {
        let system = &view.system;
        let normal = chain.map_or(DVec3::NEG_Z, |chain| chain.scatterers[0].frame.d);
        Self {
            view,
            window,
            path: PreparedPath::new(system),
            rays: PlaneRaySampler::new(system, window, chain, strategy),
            lights: Lights::new(system, sky_density(system, normal), strategy),
        }
    }

    /// Returns a ray at the plane, the factor that multiplies its radiance, and the point where
    /// the ray leaves the surface.
    fn draw(&self, [a, b, c, d, ..]: &[f64; DIMENSIONS]) -> Option<([f64; 4], f64, Leaving)> {
        let (z, density) = self.rays.draw([*a, *b, *c, *d]);
        let [x, y, u, v] = z;
        let seen = self.window.value(&TwoPlane { x, y, u, v }) * self.view.plane.factor(z);
        let factor = seen / density;
        if seen <= 0.0 || !factor.is_finite() {
            return None;
        }
        Some((z, factor, self.view.system.leaving(&self.view.plane, z)?))
    }

    /// Returns the radiance of a ray due to a part of the light.
    fn radiance(&self, leaving: &Leaving, part: LightPart) -> f64 {
        radiance(&self.view.plane, &self.path, leaving, part)
    }
}

/// Returns a ray's radiance divided by its sampling density, where 0/0 counts as 0.
fn over(radiance: f64, density: f64) -> f64 {
    if radiance == 0.0 {
        0.0
    } else {
        radiance / density
    }
}

/// Returns the radiance of a ray at a plane due to a part of the light, per unit of the part's
/// measure.
fn radiance(plane: &Plane, path: &PreparedPath<'_>, leaving: &Leaving, part: LightPart) -> f64 {
    let passes = past_obstacles(plane, path, leaving);
    let radiance = if passes > 0.0 {
        passes * path.radiance(leaving, part)
    } else {
        0.0
    };
    if plane.orientation.is_local() {
        // For a plane on the surface itself, the integral is over the surface's area, which is
        // larger than the area on the tangent plane.
        radiance / leaving.normal.dot(plane.frame.d).abs()
    } else {
        radiance
    }
}

/// Returns the fraction of a ray's radiance that passes between the surface and the plane.
fn past_obstacles(plane: &Plane, path: &PreparedPath<'_>, leaving: &Leaving) -> f64 {
    let ray = LegRay {
        point: leaving.point,
        direction: leaving.direction,
    };
    let along = plane.along(&ray);
    along.map_or(0.0, |length| path.leaves(&ray, length))
}

impl Integrand for ScatteredField<'_> {
    fn nodes(&self, at: &[f64; DIMENSIONS], nodes: &mut [RayNode]) {
        let Some((z, factor, leaving)) = self.draw(at) else {
            return;
        };
        let parts = self.lights.each(&leaving, [at[4], at[5]]);
        let radiance = parts.map(|(part, density)| over(self.radiance(&leaving, part), density));
        nodes[0] = RayNode {
            z,
            weight: factor * radiance.sum::<f64>(),
        };
    }
}

/// A sampled part of the light and the density with which it was sampled, or `None` if no part was
/// sampled.
type DrawnPart = Option<(LightPart, f64)>;

/// A light field in which a parameter is changed.
///
/// If the change does not affect rays or the light, their values are taken from the original light
/// field.
struct VariedField<'a> {
    view: &'a Observed,
    moves_surface: bool,
    moves_light: bool,
    path: PreparedPath<'a>,
    lights: Lights<'a>,
}

impl<'a> VariedField<'a> {
    fn new(view: &'a Observed, field: &'a ScatteredField<'a>, strategy: LightStrategy) -> Self {
        let Observed { system, plane } = field.view;
        let moves_surface = view.system.surfaces != system.surfaces || view.plane != *plane;
        Self {
            view,
            moves_surface,
            moves_light: view.system.light != system.light
                || moves_surface && field.lights.is_by_lobe(),
            path: PreparedPath::new(&view.system),
            lights: field.lights.of(&view.system, strategy),
        }
    }

    /// Returns the radiance of a ray due to a part of the light, divided by the density with which
    /// this part was sampled. `own` contains two values of the original light field: the point
    /// where the ray leaves the surface, and the sampled part of the light.
    fn radiance(&self, z: [f64; 4], at: [f64; 2], own: &(Leaving, DrawnPart)) -> Option<f64> {
        let Observed { system, plane } = self.view;
        let (mut leaving, mut drawn) = *own;
        if self.moves_surface {
            leaving = system.leaving(plane, z)?;
        }
        if self.moves_light {
            drawn = self.lights.draw(&leaving, at);
        }
        let (part, density) = drawn?;
        let radiance = radiance(plane, &self.path, &leaving, part);
        Some(over(radiance, density))
    }
}

/// Variants of a light field: the field of the first-order chain, and fields in which a parameter
/// is changed.
struct VariedFields<'a> {
    field: &'a ScatteredField<'a>,
    linear: Option<Linear<'a>>,
    moved: Vec<(f64, [VariedField<'a>; 2])>,
}

impl<'a> VariedFields<'a> {
    fn new(
        field: &'a ScatteredField<'a>,
        chain: Option<&'a PathChain>,
        moved: &'a [ShiftedModels<Observed>],
        strategy: LightStrategy,
    ) -> Self {
        let side = |view| VariedField::new(view, field, strategy);
        let moved = moved.iter();
        Self {
            field,
            linear: chain.and_then(|chain| Linear::new(&field.view.system, chain)),
            moved: moved
                .map(|moved| (moved.apart, moved.sides.each_ref().map(side)))
                .collect(),
        }
    }
}

impl Integrand for VariedFields<'_> {
    fn fields(&self) -> usize {
        usize::from(self.linear.is_some()) + self.moved.len()
    }

    fn nodes(&self, at: &[f64; DIMENSIONS], nodes: &mut [RayNode]) {
        let Self {
            field,
            linear,
            moved,
        } = self;
        let Some((z, factor, leaving)) = field.draw(at) else {
            return;
        };
        let at = [at[4], at[5]];
        let own = (leaving, field.lights.draw(&leaving, at));
        let mut nodes = nodes.iter_mut();
        let mut put = |difference: f64| {
            if let Some(node) = nodes.next() {
                let weight = factor * difference;
                *node = RayNode { z, weight };
            }
        };
        if let Some(linear) = linear {
            put(own.1.map_or(0.0, |(part, density)| {
                let exact = field.radiance(&leaving, part);
                // The chain treats obstacles between the surface and the plane exactly.
                let passes = past_obstacles(&field.view.plane, &field.path, &leaving);
                let first_order = passes * linear.radiance(&field.path, z, part);
                over(first_order - exact, density)
            }));
        }
        for (apart, sides) in moved {
            let [above, below] = sides
                .each_ref()
                .map(|side| side.radiance(z, at, &own).unwrap_or(0.0));
            put((above - below) / apart);
        }
    }
}
