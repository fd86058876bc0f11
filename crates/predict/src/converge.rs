//! Measures how fast the error of the first-order chain decreases as the neighbourhood of the
//! central ray shrinks.

use crate::applicability::Applicability;
use crate::theory_input::print;
use etendue_field::{FrequencyAxis, ProjectionGrid, SliceGrid, Slices, VirtualPlane, Window};
use etendue_scene::Scene;
use etendue_theory::path::{rays, reflections};
use etendue_theory::{Model, NetMean, Observed, Over, PathKind, Predicted, RayBudget, path};
use serde::Serialize;

/// The error of a plane's first-order chain in successively smaller neighbourhoods of the central
/// ray.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Convergence {
    /// Name of the plane.
    pub plane: String,
    /// The neighbourhoods, in descending order of size.
    pub steps: Vec<ConvergenceStep>,
    /// The order n. The error is proportional to eⁿ, and n is fitted by least squares to the last
    /// three steps of those with clear errors. The order is `None` if fewer than three errors are
    /// clear, or if a neighbourhood is dark.
    pub order: Option<f64>,
}

/// The error of a first-order chain in one neighbourhood of the central ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ConvergenceStep {
    /// The share e of the scene's widths.
    pub share: f64,
    /// ‖first order − exact‖/‖exact‖, without the mean power of noise.
    pub error: f64,
    /// The floor: what `error` may be if the chain is exact.
    pub floor: f64,
}

impl ConvergenceStep {
    /// Checks whether no light is left. Masks do not shrink, so they may cover the whole light.
    #[must_use]
    pub fn is_dark(&self) -> bool {
        self.error.max(self.floor) <= 0.0
    }
}

/// The budget of rays of each step, for planes where no quadrature rule converges.
const BUDGET: RayBudget = RayBudget::new(4e6, 1e-4);
/// The budget of paths of each step. The difference between the chain and the exact prediction has
/// rays of its own, and more paths do not add to these rays.
const PATHS: RayBudget = RayBudget::new(524_288.0, 1e-4);
/// The shares e.
const SHARES: [f64; 5] = [1.0, 0.5, 0.25, 0.125, 0.0625];
/// If the error of the chain is less than this multiple of its floor, it does not show whether the
/// chain is right.
const CLEAR: f64 = 5.0;
/// The share of the noise of nets that may remain after its mean power is subtracted.
const NOISE_LEFT: f64 = 0.2;
/// The maximum angle between the central ray and a mirror direction that count as the same, radians.
const PEAK: f64 = 1e-3;
/// The number of steps to which an order is fitted.
const FITTED: usize = 3;

/// Shrinks the light and the window of a plane behind specular surfaces. Where surfaces scatter
/// light, shrinks their textures too, and their lobes if the central ray is at the peaks of these
/// lobes. Widens the frequencies by the same factor. Returns `None` for any other plane, and if a
/// Lambertian surface is one of several surfaces or is lit by an environment. No photons are traced.
#[must_use]
pub fn converge(
    scene: &Scene,
    plane: &VirtualPlane,
    applicability: &Applicability,
) -> Option<Convergence> {
    converge_to(scene, plane, applicability, None)
}

/// As [`converge`], for the chain of another scene, such as a scene with a planted fault. The plane
/// of the other scene has the same place.
#[must_use]
pub fn converge_to(
    scene: &Scene,
    plane: &VirtualPlane,
    applicability: &Applicability,
    chain: Option<&Scene>,
) -> Option<Convergence> {
    let other = chain.map(|scene| (scene, Applicability::new(scene, plane).theory));
    let mut steps = Vec::new();
    for e in SHARES {
        let Window { x, y, u, v } = plane.window;
        let [x, y, u, v] = [x, y, u, v].map(|profile| profile.scaled(e));
        let window = Window { x, y, u, v };
        let wider = |axis: FrequencyAxis| FrequencyAxis {
            spacing: axis.spacing / e,
            ..axis
        };
        let grid = SliceGrid {
            rho: wider(plane.grid.rho),
            nu: wider(plane.grid.nu),
            ..plane.grid
        };
        let picture = ProjectionGrid::new(&window, 1);
        let over = (&window, &grid, &picture);
        let view = applicability.theory.path()?;
        let other = match &other {
            Some((scene, theory)) => Some((*scene, theory.path()?)),
            None => None,
        };
        let [error, floor] = if view.kind() == PathKind::Specular {
            by_rays(scene, view, other.map_or(view, |(_, other)| other), e, over)?
        } else {
            by_paths(view, other.map(|(_, other)| other), e, over)?
        };
        steps.push(ConvergenceStep {
            share: e,
            error,
            floor,
        });
    }
    let is_clear = |step: &&ConvergenceStep| step.error > CLEAR * step.floor;
    let clear = steps.iter().take_while(is_clear).count();
    let is_lit = !steps.iter().any(ConvergenceStep::is_dark);
    let order = (is_lit && clear >= FITTED).then(|| order(&steps[clear - FITTED..clear]));
    Some(Convergence {
        plane: plane.name.clone(),
        order,
        steps,
    })
}

/// The error of a first-order chain behind specular surfaces at the scale e, and the floor
/// of this error.
fn by_rays(
    scene: &Scene,
    whole: &Observed,
    chain: &Observed,
    e: f64,
    over: Over<'_>,
) -> Option<[f64; 2]> {
    let view = Observed {
        system: whole.system.shrunk(e, false)?,
        plane: whole.plane,
    };
    let chain = rays::chain(chain, print(scene))?;
    let exact = view.predict(&[], over, BUDGET);
    let linear = rays::linear(&view, over, &chain.map, BUDGET);
    if let Some(difference) = linear.minus(&exact) {
        return Some(of_nets(&difference, &exact.slices));
    }
    let own = |prediction: &Predicted| prediction.error.unwrap_or(0.0);
    let error = linear.slices.independent_relative_difference(&exact.slices);
    Some([error, own(&exact).max(own(&linear))])
}

/// The error of the chain where surfaces scatter, and the floor of this error. The same
/// paths give the exact sum and the sum of the chain.
fn by_paths(
    whole: &Observed,
    chain: Option<&Observed>,
    e: f64,
    over: Over<'_>,
) -> Option<[f64; 2]> {
    let keeps_lobes = are_beside_peaks(whole)?;
    let predicted = |whole: &Observed| {
        let view = Observed {
            system: whole.system.shrunk(e, keeps_lobes)?,
            plane: whole.plane,
        };
        Some(reflections::by_paths(&view, over, PATHS))
    };
    let exact = predicted(whole)?;
    let Some(chain) = chain else {
        return Some(of_nets(exact.to_first_order.as_ref()?, &exact.slices));
    };
    let other = predicted(chain)?;
    let mut difference = other.minus(&exact)?;
    difference.slices.half += &other.to_first_order?.slices.half;
    Some(of_nets(&difference, &exact.slices))
}

/// Checks whether the central ray leaves a scattering surface beside the mirror direction. A lobe
/// that becomes narrower would then no longer reach the window.
fn are_beside_peaks(view: &Observed) -> Option<bool> {
    let scatterers = path::chain(view)?.scatterers;
    let mut angles = scatterers.iter().map(|scatterer| {
        let [longitude, latitude] = scatterer.outgoing;
        libm::hypot(longitude + scatterer.incidence, latitude)
    });
    Some(angles.any(|angle| angle > PEAK))
}

/// The size of a mean over nets relative to the exact slices, and its floor.
fn of_nets(difference: &NetMean, exact: &Slices) -> [f64; 2] {
    let mut linear = exact.clone();
    linear.half += &difference.slices.half;
    let all = linear.independent_relative_difference(exact);
    let noise = if all > 0.0 {
        all * difference.error
    } else {
        0.0
    };
    let power = all * all - noise * noise;
    [power.max(0.0).sqrt(), NOISE_LEFT * noise]
}

/// The slope of ln error over ln e.
fn order(steps: &[ConvergenceStep]) -> f64 {
    let logs = steps.iter().map(|step| [step.share, step.error]);
    let logs: Vec<[f64; 2]> = logs.map(|pair| pair.map(libm::log)).collect();
    let n = logs.len() as f64;
    let mean = [0, 1].map(|i| logs.iter().map(|l| l[i]).sum::<f64>() / n);
    let sum = |f: &dyn Fn(&[f64; 2]) -> f64| logs.iter().map(f).sum::<f64>();
    let along = sum(&|l| (l[0] - mean[0]) * (l[1] - mean[1]));
    along / sum(&|l| (l[0] - mean[0]).powi(2))
}
