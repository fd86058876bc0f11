//! The paper's linearised chain beside the exact ray-space prediction.

use crate::report::Verdict;
use crate::residuals::Residuals;
use etendue_field::{Slices, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_theory::geometry::{Matrix, Print};
use etendue_theory::rays::{self, Plane, System};
use ndarray::Array3;
use serde::{Deserialize, Serialize};

/// What the chain of affine maps predicts.
#[derive(Clone, Debug)]
pub struct FirstOrder {
    /// Its slices; by the paper's printed formulas where a scene asks for them.
    pub slices: Slices,
    /// Its numbers.
    pub chain: FirstOrderChain,
}

/// The numbers of a chain of affine maps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FirstOrderChain {
    /// ‖first order − exact‖/‖exact‖, computed, of the corrected formulas.
    pub error: f64,
    /// A of the rays from the light to the plane, z' = A z; of the corrected formulas.
    pub matrix: Matrix<4>,
    /// Distances from the last surface, metres, at which rays meet that left the light parallel.
    pub foci: Vec<f64>,
    /// Whether `slices` are those of the paper's printed formulas.
    pub as_printed: bool,
}

/// The photons held against the first-order chain, as in `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FirstOrderReport {
    /// Its numbers.
    #[serde(flatten)]
    pub chain: FirstOrderChain,
    /// Signed root of ‖S − F₁‖² less noise, over ‖F₁‖²: its disagreement beyond noise.
    pub excess: Option<f64>,
    /// Upper 95 % bound of the excess.
    pub excess_bound: Option<f64>,
    /// The excess that this much noise lets one see, at 95 %.
    pub resolvable: Option<f64>,
    /// Probability of such a disagreement if the first-order chain were the truth.
    pub p_value: Option<f64>,
    /// What it comes to.
    pub verdict: Verdict,
}

/// The first-order chain passes up to this multiple of its computed error, which is itself good to a few per cent where it is large.
const FACTOR: f64 = 1.1;
/// Nor is it held to be better than this: at normal incidence its error can be a millionth, and no photons would ever tell.
const FLOOR: f64 = 0.01;
/// One-sided 95 % of a normal distribution.
const NINETY_FIVE: f64 = 1.645;

/// The formulas a scene asks for.
pub(crate) fn print(scene: &Scene) -> Print {
    if scene.file.as_printed {
        Print::Equations
    } else {
        Print::Corrected
    }
}

impl FirstOrderReport {
    /// How many times as many photons would bring the bound of the excess to what is allowed; 1 where they would not decide.
    pub(crate) fn more(&self) -> f64 {
        let (Verdict::Undecided, Some(excess), Some(bound)) =
            (self.verdict, self.excess, self.excess_bound)
        else {
            return 1.0;
        };
        let allowed = (FACTOR * self.chain.error).max(FLOOR).powi(2);
        let [excess, bound] = [excess, bound].map(|x| x * x.abs());
        // Noise falls as one over photons; what is left of the excess must be below.
        ((bound - excess) / (allowed - excess).abs()).max(1.0)
    }
}

impl FirstOrder {
    pub(crate) fn new(
        scene: &Scene,
        plane: &VirtualPlane,
        system: &System,
        at: &Plane,
        exact: &Slices,
    ) -> Option<Self> {
        let (window, grid) = (&plane.window, &plane.grid);
        let corrected = rays::chain(system, at, Print::Corrected)?;
        let linear = rays::linear(system, at, window, grid, &corrected.map).slices;
        let chain = FirstOrderChain {
            error: distance(&linear, exact),
            matrix: corrected.rays().matrix,
            foci: corrected.foci.clone(),
            as_printed: scene.file.as_printed,
        };
        let slices = if scene.file.as_printed {
            let printed = rays::chain(system, at, print(scene))?;
            rays::linear(system, at, window, grid, &printed.map).slices
        } else {
            linear
        };
        Some(Self { slices, chain })
    }

    /// Holds a measurement against it; `exact` are the residuals from the exact ray-space prediction.
    pub(crate) fn report(
        &self,
        measurement: &Measurement,
        index: usize,
        exact: &Residuals,
        seed: u64,
    ) -> FirstOrderReport {
        let residuals = Residuals::new(measurement, index, &self.slices);
        let half = &self.slices.half;
        let predicted = residuals.sum(half, half, |f, _| f.norm_sqr());
        let (squared, error) = residuals.squared();
        let allowed = (FACTOR * self.chain.error).max(FLOOR).powi(2) * predicted;
        let [low, high] = [-1.0, 1.0].map(|s| squared + s * NINETY_FIVE * error);
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
            verdict: if high <= allowed {
                Verdict::Pass
            } else if low > allowed {
                Verdict::Fail
            } else {
                Verdict::Undecided
            },
        }
    }
}

/// ‖a − b‖/‖b‖ over the independent frequencies, with those on the border of the half-plane counted alike.
pub(crate) fn distance(a: &Slices, b: &Slices) -> f64 {
    let norm = |array: &Array3<etendue_field::Complex>| -> f64 {
        let grid = b.grid;
        let cells = array.indexed_iter();
        let cells = cells.filter(|((_, m, n), _)| grid.is_independent(*m, *n));
        cells.map(|(_, v)| v.norm_sqr()).sum()
    };
    (norm(&(&a.half - &b.half)) / norm(&b.half)).sqrt()
}
