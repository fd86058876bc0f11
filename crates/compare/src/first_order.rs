//! Adds the paper's linearised chain to the exact ray-space prediction.

use crate::residuals::Residuals;
use crate::theory_input::print;
use crate::verdict::Verdict;
use etendue_field::{Light, Profile, Shape, Slices, Window};
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_theory::geometry::{AffineMap, Edition, Matrix};
use etendue_theory::path::{self, PathSystem, rays};
use etendue_theory::{Observed, Over, PathKind, Predicted, RayBudget};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// The prediction of the chain of affine maps.
#[derive(Clone, Debug)]
pub struct FirstOrder {
    /// The slices of the chain. They follow the paper's printed formulas where a scene asks for
    /// these formulas.
    pub slices: Slices,
    /// Independent replicates; `slices` is their mean. The list is empty where the slices have no
    /// statistical error.
    pub replicates: Vec<Slices>,
    /// The numbers that describe the chain.
    pub chain: FirstOrderChain,
}

/// The numbers that describe a chain of affine maps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FirstOrderChain {
    /// ‖first order − exact‖/‖exact‖ as computed, by the corrected formulas.
    pub error: f64,
    /// The error that remains as the neighbourhood of the central ray shrinks. The defect is zero,
    /// apart from rounding errors, if every map is right (see [`rays::defect`]). Where `slices`
    /// come from the printed formulas, the defect is also the defect of the printed formulas.
    pub defect: f64,
    /// The relative error of the radiance that the chain assigns to the central ray. This error is
    /// the part of the defect that is due to the constant factor of the chain.
    #[serde(default)]
    pub radiance_defect: f64,
    /// The matrix A in z' = A z, which takes rays from the light to the plane. It follows the
    /// corrected formulas.
    pub matrix: Matrix<4>,
    /// The covariance of the windowed light field as computed from rays, and as propagated by the
    /// chain (see [`Covariance`](crate::Covariance)).
    pub covariance: [Option<Matrix<4>>; 2],
    /// The distances, in metres, from the last surface to the foci. A focus is a point where rays
    /// that leave the light in parallel meet.
    pub foci: Vec<f64>,
    /// Whether `slices` come from the paper's printed formulas.
    pub as_printed: bool,
}

/// The comparison of the photons with the first-order chain, as in `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FirstOrderReport {
    /// The numbers that describe the chain.
    #[serde(flatten)]
    pub chain: FirstOrderChain,
    /// Signed root of (‖S − F₁‖² − noise)/‖exact‖²: the disagreement of the chain beyond noise.
    pub excess: Option<f64>,
    /// The upper 95 % bound of the excess.
    pub excess_bound: Option<f64>,
    /// The smallest excess that can be detected above this noise, at 95 %.
    pub resolvable: Option<f64>,
    /// Probability of a disagreement at least this large if the first-order chain were true.
    pub p_value: Option<f64>,
    /// The verdict on the exact prediction by rays that accompanies the chain.
    pub exact: Verdict,
    /// The verdict on the chain.
    pub verdict: Verdict,
}

/// If the defect exceeds this limit, a map of the chain is wrong. Finite differences alone cause a
/// defect of 10⁻⁹. If a first-order operator is missing or wrong by a thousandth, the defect
/// exceeds this limit.
const DEFECT: f64 = 1e-5;
/// If its error exceeds this limit, a first-order chain is useless as a prediction of the light
/// field.
const MAX_ERROR: f64 = 0.5;
/// The one-sided 95 % quantile of the normal distribution.
const NINETY_FIVE: f64 = 1.645;

impl FirstOrderChain {
    /// Returns the verdict on the chain. The chain fails if a map is wrong, and is undecided if its
    /// error is too large for a useful prediction.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        if self.defect > DEFECT {
            Verdict::Fail
        } else if self.error > MAX_ERROR {
            Verdict::Undecided
        } else {
            Verdict::Pass
        }
    }
}

impl FirstOrderReport {
    /// Returns the square of `excess`, with the sign of `excess`, and the standard error of this
    /// square.
    #[must_use]
    pub fn squared_excess(&self) -> Option<[f64; 2]> {
        let [square, high] = [self.excess?, self.excess_bound?].map(|root| root * root.abs());
        Some([square, (high - square) / NINETY_FIVE])
    }
}

impl FirstOrder {
    /// Returns the chain along a path, if the central ray arrives.
    pub(crate) fn of_path(
        scene: &Scene,
        view: &Observed,
        over: Over<'_>,
        (exact, budget): (&Predicted, RayBudget),
    ) -> Option<Self> {
        if view.kind() == PathKind::Specular {
            return Self::of_specular(scene, view, over, (exact, budget));
        }
        let chain = path::chain(view)?;
        let defect = path::defect(view, &chain)?;
        Self::of_reflection(exact, defect, chain.rays().matrix)
    }

    fn of_specular(
        scene: &Scene,
        view: &Observed,
        over: Over<'_>,
        (exact, budget): (&Predicted, RayBudget),
    ) -> Option<Self> {
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
        Some(Self {
            slices: linear.slices,
            replicates: linear.replicates,
            chain,
        })
    }

    /// Returns the chain for light that surfaces scatter. `defect` is the defect of the chain, and
    /// `matrix` is its matrix for rays along the mirror directions. The noise of the chain is the
    /// noise of the exact prediction, because the difference between the chain and the exact
    /// prediction has little noise.
    fn of_reflection(exact: &Predicted, defect: f64, matrix: Matrix<4>) -> Option<Self> {
        let difference = exact.to_first_order.as_ref();
        let difference = difference.filter(|_| !exact.slices.is_dark())?;
        let near = |slices: &Slices| Slices {
            half: &slices.half + &difference.slices.half,
            ..*slices
        };
        let slices = near(&exact.slices);
        Some(Self {
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

    /// Compares a measurement with the chain. `exact` holds the exact ray-space prediction and the
    /// differences between the photons and this prediction.
    pub(crate) fn report(
        &self,
        measurement: &Measurement,
        index: usize,
        (slices, exact, verdict): (&Slices, &Residuals, Verdict),
        seed: u64,
    ) -> FirstOrderReport {
        let residuals = Residuals::between(measurement, index, &self.slices, &self.replicates);
        let half = &slices.half;
        let predicted = residuals.sum(half, half, |f, _| f.norm_sqr());
        let (squared, error) = residuals.squared();
        let high = squared + NINETY_FIVE * error;
        let root = |x: f64| {
            let relative = x / predicted;
            (predicted > 0.0).then(|| relative.abs().sqrt().copysign(relative))
        };
        FirstOrderReport {
            chain: self.chain.clone(),
            excess: root(squared),
            excess_bound: root(high),
            resolvable: root(NINETY_FIVE * exact.squared_error()),
            p_value: residuals.p_value(seed),
            exact: verdict,
            verdict: self.chain.verdict(),
        }
    }
}

/// Returns the covariance of a Gaussian that starts as wide as the light, after it has passed the
/// chain and the window. Inverse covariances add in a product of Gaussians, and a map A takes S⁻¹
/// to A⁻ᵀ S⁻¹ A⁻¹. Returns `None` for an environment, which has no width.
fn propagated(system: &PathSystem, chain: &Matrix<4>, window: &Window) -> Option<Matrix<4>> {
    if matches!(system.light, Light::Environment { .. }) {
        return None;
    }
    let window = [window.x, window.y, window.u, window.v].map(|profile| variance(&profile));
    // A zero width is replaced by a width that is much smaller than the window. An infinite width
    // adds no inverse covariance.
    let narrow = window.map(|v| 1e8 / v);
    let picture = |w: f64| TAU / (w * w);
    let light = &system.light;
    let [a, b] = light
        .image()
        .map_or([0.0; 2], |image| image.width.map(picture));
    let inverse = match light.shape() {
        Some(Shape::Rectangle(r)) => {
            let [x, y] = r.size.map(|side| 12.0 / (side * side));
            [x, y, 0.0, 0.0]
        }
        Some(Shape::Disc(disc)) => {
            let inverse = 4.0 / (disc.radius * disc.radius);
            [inverse, inverse, 0.0, 0.0]
        }
        None if light.is_distant() => [a, b, narrow[2], narrow[3]],
        None => [narrow[0], narrow[1], a, b],
    };
    let mut inverse = AffineMap::linear(*chain).spectral_covariance(&diagonal(inverse))?;
    for (row, v) in window.iter().enumerate() {
        inverse[row][row] += 1.0 / v;
    }
    Some(AffineMap::linear(inverse).inverse()?.matrix)
}

/// Returns the variance of the Gaussian that has the curvature of the profile at the centre. For a
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
