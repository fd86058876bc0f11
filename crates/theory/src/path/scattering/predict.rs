//! Predicts the slices of scattered light by sums over scrambled nets of rays.

use super::draw::{LightStrategy, Lights, PlaneRaySampler};
use super::exact::Leaving;
use super::linear::Linear;
use crate::light::{LightPart, LightParts};
use crate::model::{Over, ShiftedModels};
use crate::nets::{self, DIMENSIONS, Integrand, RayBudget, RayNets, RayNode};
use crate::obstacle::LegRay;
use crate::path::differences::{Differences, DrawnField};
use crate::path::{AtMask, Observed, PathChain, PathSystem, PreparedPath};
use crate::predicted::Predicted;
use etendue_field::{EnvironmentMap, SliceGrid, TwoPlane, Window};
use glam::DVec3;

/// The windowed spectrum of the light that a surface scatters, and its derivatives with
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
    over: Over<'_>,
    budget: RayBudget,
) -> Predicted {
    let (window, grid, picture) = over;
    let budget = affordable(&view.system, budget);
    let strategy = fastest(view, chain, (window, grid), budget);
    let field = ScatteredField::new(view, window, chain, strategy);
    let found = nets::sums(&field, (window, grid), picture.bins, budget);
    Differences::new(&field, moved, |view| Some(field.of(view, strategy))).complete(found, over)
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

/// The strategy that has the smallest error for the same computing time.
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

/// A reduced budget that takes as much time for this system as `budget` takes for an
/// environment of few lobes.
fn affordable(system: &PathSystem, budget: RayBudget) -> RayBudget {
    RayBudget {
        nodes: budget.nodes / cost(system),
        ..budget
    }
}

/// The exact prediction, and the difference between a given chain and this prediction. The
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

/// The computing time of a ray, relative to a ray in an environment of few lobes.
fn cost(system: &PathSystem) -> f64 {
    const FEW_LOBES: f64 = 16.0;
    match system
        .light
        .environment()
        .map(|environment| &environment.map)
    {
        Some(EnvironmentMap::Lobes(lobes)) => 1.0 + lobes.len() as f64 / FEW_LOBES,
        Some(EnvironmentMap::LatLong(_)) | None => 1.0,
    }
}

/// The strategy with the smallest cost. The search is greedy and tries each of the choices
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
    linear: Option<Linear<'a>>,
}

impl<'a> ScatteredField<'a> {
    fn new(
        view: &'a Observed,
        window: &'a Window,
        chain: Option<&'a PathChain>,
        strategy: LightStrategy,
    ) -> Self {
        let system = &view.system;
        let normal = chain.map_or(DVec3::NEG_Z, |chain| chain.scatterers[0].frame.d);
        Self {
            view,
            window,
            path: PreparedPath::new(system),
            rays: PlaneRaySampler::new(system, window, chain, strategy),
            lights: Lights::new(system, LightParts::new(&system.light, normal), strategy),
            linear: chain.and_then(|chain| Linear::new(system, chain)),
        }
    }

    /// The field of a changed model, whose rays at the plane are the same.
    fn of<'b>(&'b self, view: &'b Observed, strategy: LightStrategy) -> ScatteredField<'b> {
        ScatteredField {
            view,
            window: self.window,
            path: PreparedPath::new(&view.system),
            rays: self.rays.clone(),
            lights: self.lights.of(&view.system, strategy),
            linear: None,
        }
    }

    /// A ray at the plane, the factor that multiplies its radiance, and the point where
    /// the ray leaves the surface.
    fn leaving(&self, [a, b, c, d, ..]: &[f64; DIMENSIONS]) -> Option<([f64; 4], f64, Leaving)> {
        let (z, density) = self.rays.draw([*a, *b, *c, *d]);
        let [x, y, u, v] = z;
        let seen = self.window.value(&TwoPlane { x, y, u, v }) * self.view.plane.factor(z);
        let factor = seen / density;
        if seen <= 0.0 || !factor.is_finite() {
            return None;
        }
        Some((z, factor, self.view.system.leaving(&self.view.plane, z)?))
    }

    /// The radiance of a ray at the plane due to a part of the light, per unit of the
    /// part's measure.
    fn radiance(&self, leaving: &Leaving, part: LightPart, at_mask: AtMask<'_>) -> f64 {
        let plane = &self.view.plane;
        let passes = self.passes(leaving, at_mask);
        let radiance = if passes > 0.0 {
            passes * self.path.radiance(leaving, part, at_mask)
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

    /// The fraction of a ray's radiance that passes between the surface and the plane.
    fn passes(&self, leaving: &Leaving, at_mask: AtMask<'_>) -> f64 {
        let ray = LegRay {
            point: leaving.point,
            direction: leaving.direction,
        };
        let along = self.view.plane.along(&ray);
        along.map_or(0.0, |length| self.path.leaves(&ray, length, at_mask))
    }
}

/// A ray's radiance divided by its sampling density, where 0/0 counts as 0.
fn over(radiance: f64, density: f64) -> f64 {
    if radiance == 0.0 {
        0.0
    } else {
        radiance / density
    }
}

impl Integrand for ScatteredField<'_> {
    fn nodes(&self, at: &[f64; DIMENSIONS], _: &[bool], nodes: &mut [RayNode]) {
        let Some((z, factor, leaving)) = self.leaving(at) else {
            return;
        };
        let parts = self.lights.each(&leaving, [at[4], at[5]]);
        let radiance = parts.map(|(part, density)| {
            let radiance = self.radiance(&leaving, part, &mut self.path.at_mask());
            over(radiance, density)
        });
        nodes[0] = RayNode {
            z,
            weight: factor * radiance.sum::<f64>(),
        };
    }
}

impl DrawnField for ScatteredField<'_> {
    fn path(&self) -> &PreparedPath<'_> {
        &self.path
    }

    fn draw(&self, at: &[f64; DIMENSIONS], at_mask: AtMask<'_>) -> Option<RayNode> {
        let (z, factor, leaving) = self.leaving(at)?;
        let (part, density) = self.lights.draw(&leaving, [at[4], at[5]])?;
        let weight = factor * over(self.radiance(&leaving, part, at_mask), density);
        Some(RayNode { z, weight })
    }

    fn has_chain(&self) -> bool {
        self.linear.is_some()
    }

    /// The chain treats obstacles between the surface and the plane exactly.
    fn beside_chain(&self, at: &[f64; DIMENSIONS]) -> [Option<RayNode>; 2] {
        let first_order = || {
            let (z, factor, leaving) = self.leaving(at)?;
            let (part, density) = self.lights.draw(&leaving, [at[4], at[5]])?;
            let radiance = self.linear.as_ref()?.radiance(&self.path, z, part);
            let passes = self.passes(&leaving, &mut self.path.at_mask());
            let weight = factor * over(passes * radiance, density);
            Some(RayNode { z, weight })
        };
        [first_order(), self.draw(at, &mut self.path.at_mask())]
    }
}
