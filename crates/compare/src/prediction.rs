//! Everything that a measurement of a plane is compared with.

use crate::applicability::Applicability;
use crate::budget::budget;
use crate::class::Class;
use crate::depth::depth;
use crate::first_order::FirstOrder;
use crate::off_patches::OffPatches;
use crate::theories::Theory;
use etendue_field::{Projection, ProjectionGrid, Slices, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::estimate::{self, TooFewBatches};
use etendue_spectrum::{Measurement, PROJECTION_BINS};
use etendue_theory::{Model, Over, Parameter, RayBudget};
use ndarray::Array2;

/// Everything that a measurement of a plane is compared with.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// The kind of prediction.
    pub class: Class,
    /// The steps that produce the spectrum, with one line for each step.
    pub steps: Vec<String>,
    /// The slices of the windowed spectrum.
    pub slices: Slices,
    /// The estimated ‖error‖/‖slices‖: the standard error where theory has replicates, otherwise
    /// the quadrature error. The error is `None` for a closed form and for a reference.
    pub quadrature_error: Option<f64>,
    /// The relative error ‖error‖/‖slices‖ due to smooth meshes. Theory replaces smooth meshes by
    /// osculating patches, and the two tracers of a reference deflect rays at them differently. The
    /// error is `None` without a smooth mesh.
    pub mesh_error: Option<f64>,
    /// The quadrature error of lights without replicates, relative to the slices of all lights, if
    /// other lights have replicates.
    pub rule_error: Option<f64>,
    /// The first-order chain. Where a first-order chain exists, `slices` and all other fields
    /// belong to the exact ray-space prediction.
    pub first_order: Option<FirstOrder>,
    /// Independent replicates, which are batches of a reference or randomised rules of theory;
    /// `slices` is their mean. The list is empty where the slices have no statistical error. With n
    /// replicates, a p-value is at least 2¹⁻ⁿ, so at least 16 replicates should be used.
    pub replicates: Vec<Slices>,
    /// ∫ L W without occluders; zero for a reference. The slices of theory are compared with this
    /// value to decide whether they are dark.
    pub unblocked: f64,
    /// The windowed light field in (x, u).
    pub projection: Projection,
    /// For each parameter of the chain: name, value and derivative of the slices.
    pub parameters: Vec<PredictedParameter>,
    /// The shortest and the longest distance, in metres, from the plane back to the occluders of
    /// its light. The value is `None` if there are no occluders, or if light is reflected between
    /// the occluders and the plane.
    pub depth: Option<[f64; 2]>,
    /// The cuts, in cycles per metre, for a plane where light leaves a diffuse surface. Energy
    /// above a cut counts as high-frequency.
    pub cuts: Vec<f64>,
}

/// A parameter of the chain and how the slices depend on it.
#[derive(Clone, Debug)]
pub struct PredictedParameter {
    /// Name, such as "travel light to blockers".
    pub name: String,
    /// Unit of the value; empty for a pure number.
    pub unit: String,
    /// Value in the scene.
    pub value: f64,
    /// ∂ slices / ∂ parameter.
    pub derivative: Slices,
}

impl Prediction {
    /// Checks whether the slices have a statistical error, which their replicates show.
    pub(crate) fn is_statistical(&self) -> bool {
        !self.replicates.is_empty()
    }

    /// Returns ‖error‖/‖slices‖ for the errors that replicates do not show.
    pub(crate) fn systematic_error(&self) -> Option<f64> {
        let quadrature = self.quadrature_error.filter(|_| !self.is_statistical());
        both(both(quadrature, self.rule_error), self.mesh_error)
    }

    /// Returns ‖error‖/‖slices‖ as estimated from the replicates of theory. This error does not
    /// shrink with more photons.
    pub(crate) fn statistical_error(&self) -> Option<f64> {
        self.quadrature_error.filter(|_| self.is_statistical())
    }

    /// Returns the combined ‖error‖/‖slices‖ of all kinds of error.
    pub(crate) fn error(&self) -> Option<f64> {
        both(
            both(self.quadrature_error, self.rule_error),
            self.mesh_error,
        )
    }

    /// Returns the prediction of theory for a plane of a scene: the sum over all lights. Returns
    /// darkness where no theory applies and [`Self::reference`] takes its place.
    #[must_use]
    pub fn new(scene: &Scene, plane: &VirtualPlane, applicability: &Applicability) -> Self {
        let each = Self::of_lights(scene, plane, applicability).map(|(_, of)| of);
        let mut each: Vec<Self> = each.collect();
        if each.len() == 1 {
            return each.remove(0);
        }
        let theories = applicability.of_lights(scene, plane);
        let theories: Vec<&Theory> = theories.map(|(_, _, of, _)| &of.theory).collect();
        let first_order = Self::chain_of_lights(&each, &theories);
        let sum = each.into_iter().reduce(Self::plus);
        let sum = sum.unwrap_or_else(|| Self::darkness(scene, plane, applicability));
        Self { first_order, ..sum }
    }

    /// Returns the prediction of theory for each light that may reach a plane, with the number of
    /// the light, which begins at 1.
    pub fn of_lights<'a>(
        scene: &'a Scene,
        plane: &'a VirtualPlane,
        applicability: &'a Applicability,
    ) -> impl Iterator<Item = (usize, Self)> + 'a {
        let is_alone = scene.other_lights.is_empty();
        let each = applicability.of_lights(scene, plane);
        let mut budget = budget(scene);
        each.map(move |(of, seen, theory, number)| {
            let among = (!is_alone).then_some(number);
            let (window, grid) = (plane.window, plane.grid);
            let seen = VirtualPlane {
                window,
                grid,
                ..seen.clone()
            };
            let found = Self::of_light((of, &seen, theory), budget, among);
            budget.beside = libm::hypot(budget.beside, found.slices.norm());
            (number, found)
        })
    }

    /// Returns the prediction for one light. `number` is the number of the light if there are
    /// others.
    fn of_light(
        (scene, plane, applicability): (&Scene, &VirtualPlane, &Applicability),
        budget: RayBudget,
        number: Option<usize>,
    ) -> Self {
        let empty = Self::darkness(scene, plane, applicability);
        if applicability.dark.is_some() {
            return empty;
        }
        let cells = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
        let over = (&plane.window, &plane.grid, &cells);
        match &applicability.theory {
            Theory::Parallel(chain) => empty.by(chain, over, (budget, number), |_| None),
            Theory::None => empty,
            Theory::Path(view) => {
                let found = empty.by(view.as_ref(), over, (budget, number), |exact| {
                    FirstOrder::of_path(scene, view, over, (exact, budget))
                });
                let size = found.slices.norm();
                let meshes = applicability.off_patches.filter(|_| size > 0.0);
                let error = |off: OffPatches| off.change * found.slices.at_zero() / size;
                Self {
                    mesh_error: meshes.map(error),
                    ..found
                }
            }
        }
    }

    /// Returns the prediction of a model, with the first-order chain beside it.
    fn by<M: Model>(
        self,
        model: &M,
        over: Over<'_>,
        (budget, number): (RayBudget, Option<usize>),
        first_order: impl FnOnce(&etendue_theory::Predicted) -> Option<FirstOrder>,
    ) -> Self {
        let parameters = model.parameters();
        let found = model.predict(&parameters, over, budget);
        let first_order = first_order(&found);
        let name = |parameter| match number.filter(|_| is_of_light(parameter, &parameters)) {
            Some(number) => format!("{} (light {number})", model.name(parameter)),
            None => model.name(parameter),
        };
        let derivatives = parameters.iter().copied().zip(found.derivatives);
        let parameters = derivatives.filter_map(|(parameter, derivative)| {
            Some(PredictedParameter {
                name: name(parameter),
                unit: model.unit(parameter).to_owned(),
                value: model.value(parameter)?,
                derivative,
            })
        });
        Self {
            slices: found.slices,
            quadrature_error: found.error,
            first_order,
            replicates: found.replicates,
            unblocked: found.unblocked,
            projection: found.projection,
            parameters: parameters.collect(),
            ..self
        }
    }

    /// Returns a prediction in which no light arrives.
    fn darkness(scene: &Scene, plane: &VirtualPlane, applicability: &Applicability) -> Self {
        let grid = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
        let values = Array2::zeros((grid.bins, grid.bins));
        let class = applicability.class();
        Self {
            class,
            steps: applicability.steps(scene, plane),
            slices: Slices::zeros(plane.grid),
            quadrature_error: None,
            mesh_error: None,
            rule_error: None,
            first_order: None,
            replicates: Vec::new(),
            unblocked: 0.0,
            projection: Projection { grid, values },
            parameters: Vec::new(),
            depth: depth(scene, plane),
            cuts: match class {
                // For light that leaves a mirror or a lobe, no cut separates high frequencies.
                Class::FirstOrder => Vec::new(),
                Class::Exact | Class::Reference => cuts(scene, plane),
            },
        }
    }

    /// Returns a prediction that consists of another, independent measurement of plane `index`.
    /// Such a prediction is used where no theory applies.
    ///
    /// # Errors
    /// Returns an error if that measurement has too few batches.
    pub fn reference(
        scene: &Scene,
        index: usize,
        applicability: &Applicability,
        measurement: &Measurement,
        at: usize,
    ) -> Result<Self, TooFewBatches> {
        let plane = &scene.planes[index];
        Ok(Self {
            steps: applicability.steps(scene, plane),
            mesh_error: scene.mesh_mismatch(plane),
            depth: depth(scene, plane),
            cuts: cuts(scene, plane),
            ..Self::measured(measurement, at)?
        })
    }

    /// Returns a plane of a measurement in the form of a prediction. Another, independent
    /// measurement is compared with it.
    ///
    /// # Errors
    /// Returns an error if the measurement has too few batches.
    pub fn measured(measurement: &Measurement, plane: usize) -> Result<Self, TooFewBatches> {
        let batches = measurement.at_plane(plane);
        Ok(Self {
            class: Class::Reference,
            steps: Vec::new(),
            slices: estimate::slices(measurement, plane)?.mean,
            quadrature_error: None,
            mesh_error: None,
            rule_error: None,
            first_order: None,
            replicates: batches.map(|batch| batch.slices.clone()).collect(),
            unblocked: 0.0,
            projection: estimate::projection(measurement, plane)?.mean,
            parameters: Vec::new(),
            depth: None,
            cuts: Vec::new(),
        })
    }
}

/// Returns whether a parameter belongs to a light, and not to an object that all lights share.
/// `all` are the parameters of a model; the first travel begins at the light.
fn is_of_light(parameter: Parameter, all: &[Parameter]) -> bool {
    match parameter {
        Parameter::SourceSize | Parameter::SpotExponent | Parameter::ImageWidth => true,
        Parameter::Travel(_) => {
            let is_travel = |other: &&Parameter| matches!(other, Parameter::Travel(_));
            all.iter().find(is_travel) == Some(&parameter)
        }
        _ => false,
    }
}

/// Returns the root of the sum of squares of two errors.
fn both(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(libm::hypot(a, b)),
        (a, b) => a.or(b),
    }
}

/// Returns two cuts. The main lobe of the transform of a Hann window ends at the frequency
/// 1/half-width. The first cut is twice this frequency. The second cut is 1.5 times the first, to
/// show whether H depends on the cut. The list is empty where light does not leave a surface.
fn cuts(scene: &Scene, plane: &VirtualPlane) -> Vec<f64> {
    if plane.leg == 0 || scene.path.along(plane) > 0.0 {
        return Vec::new();
    }
    let cut = 2.0 / plane.window.x.half_width();
    vec![cut, 1.5 * cut]
}
