//! Everything a measurement of a plane is held against.

use crate::applicability::{Applicability, Theory};
use crate::budget::{budget, is_sampled};
use crate::chain::chain;
use crate::class::Class;
use crate::first_order::FirstOrder;
use etendue_field::{Projection, ProjectionGrid, Slices, VirtualPlane, Window};
use etendue_scene::Scene;
use etendue_spectrum::estimate::{self, TooFewBatches};
use etendue_spectrum::{Measurement, PROJECTION_BINS};
use etendue_theory::rays::{self, Plane, System};
use etendue_theory::{Chain, Operator};
use ndarray::Array2;

/// Everything a measurement of a plane is held against.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// What kind it is.
    pub class: Class,
    /// What makes the spectrum, a line for each step.
    pub steps: Vec<String>,
    /// The slices of the windowed spectrum.
    pub slices: Slices,
    /// ‖error‖/‖slices‖, estimated: the standard error where there are replicates of theory, else
    /// that of a quadrature. `None` for a closed form, and for a reference.
    pub quadrature_error: Option<f64>,
    /// The first-order chain; `slices` and all else are then those of the exact ray-space
    /// prediction.
    pub first_order: Option<FirstOrder>,
    /// Independent replicates, of which `slices` is the mean: batches of a reference, or randomised
    /// rules of theory. Empty where the slices have no statistical error. A p-value is no smaller
    /// than 2¹⁻ⁿ with n of them, so there should be 16 or more.
    pub replicates: Vec<Slices>,
    /// ∫ L W if nothing stood in the way, what the slices of theory are small or large against;
    /// zero for a reference.
    pub unblocked: f64,
    /// The windowed light field in (x, u).
    pub projection: Projection,
    /// For each parameter of the chain: name, value and derivative of the slices.
    pub parameters: Vec<PredictedParameter>,
    /// Where energy begins to count as high, cycles per metre, on a plane that light leaves
    /// diffusely.
    pub cuts: Vec<f64>,
}

/// A parameter of the chain and how the slices depend on it.
#[derive(Clone, Debug)]
pub struct PredictedParameter {
    /// Name, such as "travel light to blockers".
    pub name: String,
    /// Unit of the value; none for a pure number.
    pub unit: String,
    /// Value in the scene.
    pub value: f64,
    /// ∂ slices / ∂ parameter.
    pub derivative: Slices,
}

/// Metres, and whatever else parameters are in, that rounding leaves of zero.
const NOTHING: f64 = 1e-9;

impl Prediction {
    /// Whether the slices have a statistical error, which their replicates show.
    pub(crate) fn is_statistical(&self) -> bool {
        !self.replicates.is_empty()
    }

    /// Whether theory's rays found no way to the plane. That is no proof that there is none.
    pub(crate) fn found_nothing(&self) -> bool {
        let is_dark = || self.slices.half.iter().all(|f| f.norm_sqr() <= 0.0);
        self.class != Class::Reference && self.is_statistical() && is_dark()
    }

    /// ‖error‖/‖slices‖ that no replicates show.
    pub(crate) fn systematic_error(&self) -> Option<f64> {
        self.quadrature_error.filter(|_| !self.is_statistical())
    }

    /// ‖error‖/‖slices‖ of theory's own replicates, which stays however many photons are measured.
    pub(crate) fn statistical_error(&self) -> Option<f64> {
        self.quadrature_error.filter(|_| self.is_statistical())
    }

    /// What theory predicts for a plane of a scene. Where no theory applies it is that of its chain
    /// as far as the chain goes: see [`Self::reference`].
    #[must_use]
    pub fn new(scene: &Scene, plane: &VirtualPlane) -> Self {
        let applicability = Applicability::new(scene, plane);
        let steps = applicability.steps(scene, plane);
        if applicability.dark.is_some() {
            return Self::darkness(scene, plane, applicability.class(), steps);
        }
        match applicability.theory {
            Theory::Parallel(chain) if is_sampled(plane, &chain) => {
                Self::by_nets(scene, plane, &chain, steps)
            }
            Theory::Parallel(chain) => Self::by_chain(scene, plane, &chain, steps),
            Theory::Specular(system, at) => Self::by_rays(scene, plane, &system, &at, steps),
            Theory::Scattering(system, at) => {
                Self::by_scattering(scene, plane, &system, &at, steps)
            }
            Theory::None => Self {
                class: Class::Reference,
                ..Self::by_chain(scene, plane, &chain(scene, plane), steps)
            },
        }
    }

    /// No light at all.
    fn darkness(scene: &Scene, plane: &VirtualPlane, class: Class, steps: Vec<String>) -> Self {
        let grid = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
        let values = Array2::zeros((grid.bins, grid.bins));
        Self {
            class,
            steps,
            slices: Slices::zeros(plane.grid),
            quadrature_error: None,
            first_order: None,
            replicates: Vec::new(),
            unblocked: 0.0,
            projection: Projection { grid, values },
            parameters: Vec::new(),
            cuts: cuts(scene, plane),
        }
    }

    /// What the closed forms of light between parallel planes say.
    fn by_chain(scene: &Scene, plane: &VirtualPlane, chain: &Chain, steps: Vec<String>) -> Self {
        let (window, grid) = (&plane.window, &plane.grid);
        let slices = etendue_theory::slices(chain, window, grid);
        let cells = ProjectionGrid::new(window, PROJECTION_BINS);
        let parameters = chain.parameters().into_iter();
        let parameters = parameters.map(|parameter| PredictedParameter {
            name: chain.name(parameter),
            unit: chain.unit(parameter).to_owned(),
            value: chain.value(parameter),
            derivative: etendue_theory::derivative(chain, parameter, window, grid, &slices),
        });
        Self {
            class: Class::Exact,
            steps,
            quadrature_error: etendue_theory::quadrature_error(chain, window, grid, &slices),
            first_order: None,
            replicates: Vec::new(),
            unblocked: unblocked(chain.clone(), window),
            projection: etendue_theory::projection(chain, window, &cells),
            parameters: parameters.collect(),
            slices,
            cuts: cuts(scene, plane),
        }
    }

    /// The same by nets of rays, where closed forms take too long or do not resolve the scene.
    fn by_nets(scene: &Scene, plane: &VirtualPlane, chain: &Chain, steps: Vec<String>) -> Self {
        let cells = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
        let over = (&plane.window, &plane.grid, &cells);
        let all = chain.parameters();
        let found = chain.sampled(&all, over, budget(scene));
        let parameters = all.into_iter().zip(found.derivatives);
        let parameters = parameters.map(|(parameter, derivative)| PredictedParameter {
            name: chain.name(parameter),
            unit: chain.unit(parameter).to_owned(),
            value: chain.value(parameter),
            derivative,
        });
        Self {
            class: Class::Exact,
            steps,
            quadrature_error: Some(found.error),
            first_order: None,
            parameters: parameters.collect(),
            slices: found.slices,
            replicates: found.replicates,
            unblocked: 0.0,
            projection: found.projection,
            cuts: cuts(scene, plane),
        }
    }

    /// What rays followed through the real geometry say, and the first-order chain.
    fn by_rays(
        scene: &Scene,
        plane: &VirtualPlane,
        system: &System,
        at: &Plane,
        steps: Vec<String>,
    ) -> Self {
        let cells = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
        let over = (&plane.window, &plane.grid, &cells);
        let exact = rays::exact(system, at, over, budget(scene));
        let first_order = FirstOrder::new(scene, system, at, over, &exact);
        // A plane at its surface has no travel to it.
        let value = |parameter| {
            let value = system.value(at, parameter);
            value.filter(|value| value.abs() > NOTHING)
        };
        let all = system.parameters(at).into_iter();
        let (all, moved): (Vec<_>, Vec<_>) = all
            .filter(|parameter| value(*parameter).is_some())
            .filter_map(|parameter| Some((parameter, system.moved(at, parameter)?)))
            .unzip();
        let derivatives = rays::derivatives(&moved, over, &exact);
        let parameters = all.into_iter().zip(derivatives);
        let parameters = parameters.filter_map(|(parameter, derivative)| {
            Some(PredictedParameter {
                name: system.name(parameter),
                unit: system.unit(parameter).to_owned(),
                value: value(parameter)?,
                derivative,
            })
        });
        Self {
            class: Class::FirstOrder,
            steps,
            quadrature_error: Some(exact.error),
            first_order,
            parameters: parameters.collect(),
            slices: exact.slices,
            replicates: exact.replicates,
            unblocked: 0.0,
            projection: exact.projection,
            cuts: Vec::new(),
        }
    }

    /// What another, independent measurement of plane `index` says, where theory has no word.
    ///
    /// # Errors
    /// When that measurement has too few batches.
    pub fn reference(
        scene: &Scene,
        index: usize,
        measurement: &Measurement,
        at: usize,
    ) -> Result<Self, TooFewBatches> {
        let plane = &scene.planes[index];
        Ok(Self {
            class: Class::Reference,
            steps: Applicability::new(scene, plane).steps(scene, plane),
            slices: estimate::slices(measurement, at)?.mean,
            quadrature_error: None,
            first_order: None,
            replicates: measurement
                .at_plane(at)
                .map(|batch| batch.slices.clone())
                .collect(),
            unblocked: 0.0,
            projection: estimate::projection(measurement, at)?.mean,
            parameters: Vec::new(),
            cuts: cuts(scene, plane),
        })
    }
}

/// Two main lobes of the transform of a Hann window, which end at 1/half-width each, and 1.5 times
/// that, to see whether H hangs on the cut; none where light does not leave a surface.
fn cuts(scene: &Scene, plane: &VirtualPlane) -> Vec<f64> {
    if plane.leg == 0 || scene.path.along(plane) > 0.0 {
        return Vec::new();
    }
    let cut = 2.0 / plane.window.x.half_width();
    vec![cut, 1.5 * cut]
}

/// ∫ L W without what stands in the way.
fn unblocked(mut chain: Chain, window: &Window) -> f64 {
    chain
        .operators
        .retain(|o| !matches!(o, Operator::Visibility { .. }));
    etendue_theory::at(&chain, window, [0.0; 4]).re
}
