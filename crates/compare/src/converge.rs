//! Measures how fast the error of the first-order chain decreases as the neighbourhood of the
//! central ray shrinks.

use crate::applicability::Applicability;
use crate::theories::Theory;
use crate::theory_input::{print, reflected};
use etendue_field::{FrequencyAxis, ProjectionGrid, SliceGrid, VirtualPlane, Window};
use etendue_scene::Scene;
use etendue_theory::{Model, Observed, Over, Predicted, RayBudget, rays, reflections};
use serde::Serialize;

/// The error of a plane's first-order chain in successively smaller neighbourhoods of the central
/// ray.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Convergence {
    /// Name of the plane.
    pub plane: String,
    /// The shares e of the scene's widths, in descending order, and ‖first order − exact‖/‖exact‖
    /// for each share.
    pub steps: Vec<[f64; 2]>,
    /// The order n. The error is proportional to eⁿ, and n is fitted by least squares to the last
    /// three steps. The order is `None` where the error is not clearly above the error of the
    /// quadrature. This condition is not checked where surfaces scatter.
    pub order: Option<f64>,
}

/// The budget of rays of each step, for planes where no quadrature rule converges.
const BUDGET: RayBudget = RayBudget::new(4e6, 1e-4);
/// The shares e.
const SHARES: [f64; 5] = [1.0, 0.5, 0.25, 0.125, 0.0625];
/// If the error of the chain is less than this multiple of the quadrature error, it does not show
/// whether the chain is right.
const CLEAR: f64 = 5.0;

/// Shrinks the light and the window of a plane behind specular surfaces. Where surfaces scatter
/// light, shrinks their lobes and textures too. Widens the frequencies by the same factor. Returns
/// `None` for any other plane, and for Lambertian surfaces. No photons are traced.
#[must_use]
pub fn converge(
    scene: &Scene,
    plane: &VirtualPlane,
    applicability: &Applicability,
) -> Option<Convergence> {
    let mut steps = Vec::new();
    let mut clear = true;
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
        let [error, own] = match &applicability.theory {
            Theory::Specular(view) => by_rays(scene, view, e, over)?,
            Theory::Reflections(view) => [by_paths(view, e, over)?, 0.0],
            Theory::Scattering(_) => [by_paths(&reflected(scene, plane)?, e, over)?, 0.0],
            Theory::Parallel(_) | Theory::None => return None,
        };
        clear &= error > CLEAR * own;
        steps.push([e, error]);
    }
    Some(Convergence {
        plane: plane.name.clone(),
        order: clear.then(|| order(&steps[SHARES.len() - 3..])),
        steps,
    })
}

/// Returns the error of a first-order chain behind specular surfaces at the scale e. The first
/// error is computed from sums over rays. Also returns the error of these sums.
fn by_rays(
    scene: &Scene,
    whole: &Observed<rays::SpecularSystem>,
    e: f64,
    over: Over<'_>,
) -> Option<[f64; 2]> {
    let view = Observed {
        system: whole.system.shrunk(e),
        plane: whole.plane,
    };
    let chain = rays::chain(&view, print(scene))?;
    let exact = view.predict(&[], over, BUDGET);
    let linear = rays::linear(&view, over, &chain.map, BUDGET);
    let own = |prediction: &Predicted| prediction.error.unwrap_or(0.0);
    let error = linear.slices.independent_relative_difference(&exact.slices);
    Some([error, own(&exact).max(own(&linear))])
}

/// Returns the error of the chain where surfaces scatter. The same paths give the exact sum
/// and the sum of the chain. Their difference gives the error of the chain to a few per cent.
fn by_paths(
    whole: &Observed<reflections::ReflectionSystem>,
    e: f64,
    over: Over<'_>,
) -> Option<f64> {
    let view = Observed {
        system: whole.system.shrunk(e)?,
        plane: whole.plane,
    };
    let exact = view.predict(&[], over, BUDGET);
    let mut linear = exact.to_first_order?;
    linear.half += &exact.slices.half;
    Some(linear.independent_relative_difference(&exact.slices))
}

/// Returns the slope of ln error over ln e.
fn order(steps: &[[f64; 2]]) -> f64 {
    let logs: Vec<[f64; 2]> = steps.iter().map(|step| step.map(libm::log)).collect();
    let n = logs.len() as f64;
    let mean = [0, 1].map(|i| logs.iter().map(|l| l[i]).sum::<f64>() / n);
    let sum = |f: &dyn Fn(&[f64; 2]) -> f64| logs.iter().map(f).sum::<f64>();
    let along = sum(&|l| (l[0] - mean[0]) * (l[1] - mean[1]));
    along / sum(&|l| (l[0] - mean[0]).powi(2))
}
