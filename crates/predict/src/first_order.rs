//! Predicts the light of a plane by the first-order chain of its path.

use crate::theory_input::print;
use etendue_compare::{FirstOrder, FirstOrderChain};
use etendue_field::{EmittedRays, Image, Profile, Slices, Window};
use etendue_scene::Scene;
use etendue_theory::geometry::{AffineMap, Edition, Matrix};
use etendue_theory::path::{self, PathSystem, rays};
use etendue_theory::{Observed, Over, PathKind, Predicted, RayBudget};
use std::f64::consts::{PI, TAU};

/// The chain along a path, if the central ray arrives.
pub(crate) fn first_order(
    scene: &Scene,
    view: &Observed,
    over: Over<'_>,
    (exact, budget): (&Predicted, RayBudget),
) -> Option<FirstOrder> {
    if view.kind() == PathKind::Specular {
        return of_specular(scene, view, over, (exact, budget));
    }
    let chain = path::chain(view)?;
    let defect = path::defect(view, &chain)?;
    of_reflection(exact, defect, chain.rays().matrix)
}

fn of_specular(
    scene: &Scene,
    view: &Observed,
    over: Over<'_>,
    (exact, budget): (&Predicted, RayBudget),
) -> Option<FirstOrder> {
    if exact.slices.is_dark() {
        return None;
    }
    let by = |print| {
        let chain = rays::chain(view, print)?;
        let linear = rays::linear(view, over, &chain.map, budget);
        Some((chain, linear))
    };
    let (corrected, mut linear) = by(Edition::Corrected)?;
    let matrix = corrected.map.rays().matrix;
    let mut chain = FirstOrderChain {
        error: linear.slices.independent_relative_difference(&exact.slices),
        defect: rays::defect(view, &corrected.map, over.0)?,
        radiance_defect: rays::radiance_defect(view, &corrected.map)?,
        matrix,
        covariance: [exact.covariance, propagated(&view.system, &matrix, over.0)],
        foci: corrected.foci,
        as_printed: scene.file.as_printed,
    };
    if scene.file.as_printed {
        let (printed, by_print) = by(print(scene))?;
        linear = by_print;
        chain.defect = rays::defect(view, &printed.map, over.0)?;
        chain.radiance_defect = rays::radiance_defect(view, &printed.map)?;
    }
    Some(FirstOrder {
        slices: linear.slices,
        replicates: linear.replicates,
        chain,
    })
}

/// The chain for light that surfaces scatter. `defect` is the defect of the chain, and
/// `matrix` is its matrix for rays along the mirror directions. The noise of the chain is the
/// noise of the exact prediction, because the difference between the chain and the exact
/// prediction has little noise.
fn of_reflection(exact: &Predicted, defect: f64, matrix: Matrix<4>) -> Option<FirstOrder> {
    let difference = exact.to_first_order.as_ref();
    let difference = difference.filter(|_| !exact.slices.is_dark())?;
    let near = |slices: &Slices| Slices {
        half: &slices.half + &difference.slices.half,
        ..*slices
    };
    let slices = near(&exact.slices);
    Some(FirstOrder {
        chain: FirstOrderChain {
            error: slices.independent_relative_difference(&exact.slices),
            defect,
            radiance_defect: 0.0,
            matrix,
            covariance: [exact.covariance, None],
            foci: Vec::new(),
            as_printed: false,
        },
        slices,
        replicates: exact.replicates.iter().map(near).collect(),
    })
}

/// The covariance of a Gaussian that starts as wide as the light, after it has passed the
/// chain and the window. Inverse covariances add in a product of Gaussians, and a map A takes S⁻¹
/// to A⁻ᵀ S⁻¹ A⁻¹. Returns `None` for an environment or a list of rays, which has no width.
fn propagated(system: &PathSystem, chain: &Matrix<4>, window: &Window) -> Option<Matrix<4>> {
    let window = [window.x, window.y, window.u, window.v].map(|profile| variance(&profile));
    // A zero width is replaced by a width that is much smaller than the window. An infinite width
    // adds no inverse covariance.
    let narrow = window.map(|v| 1e8 / v);
    let picture = |image: &Image| image.width.map(|w| TAU / (w * w));
    let ([x, y], [u, v]) = match system.light.rays() {
        EmittedRays::OfShape(shape) => (shape.variances().map(|v| 1.0 / v), [0.0; 2]),
        EmittedRays::OfPoint(image) => ([narrow[0], narrow[1]], image.map_or([0.0; 2], picture)),
        EmittedRays::Parallel(image) => (picture(image), [narrow[2], narrow[3]]),
        EmittedRays::OfSky(_) | EmittedRays::Listed(_) => return None,
    };
    let inverse = diagonal([x, y, u, v]);
    let mut inverse = AffineMap::linear(*chain).spectral_covariance(&inverse)?;
    for (row, v) in window.iter().enumerate() {
        inverse[row][row] += 1.0 / v;
    }
    Some(AffineMap::linear(inverse).inverse()?.matrix)
}

/// The variance of the Gaussian that has the curvature of the profile at the centre. For a
/// box, returns the variance of the box.
fn variance(profile: &Profile) -> f64 {
    match *profile {
        Profile::Hann(h) => 2.0 * (h / PI).powi(2),
        Profile::Box(h) => h * h / 3.0,
        Profile::Gaussian { width, .. } => width * width / TAU,
    }
}

fn diagonal(entries: [f64; 4]) -> Matrix<4> {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { entries[i] } else { 0.0 }))
}
