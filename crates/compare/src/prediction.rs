use crate::chain::chain;
use crate::class::{Class, without_theory};
use crate::first_order::{FirstOrder, affine_chain};
use crate::scattering::{budget, scattered};
use crate::system::system;
use etendue_field::{Projection, ProjectionGrid, Slices, VirtualPlane, Window};
use etendue_scene::Scene;
use etendue_spectrum::estimate::{self, TooFewBatches};
use etendue_spectrum::{Measurement, PROJECTION_BINS};
use etendue_theory::rays::{self, Plane, System};
use etendue_theory::{Chain, Operator};

/// Everything a measurement of a plane is held against.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// What kind it is.
    pub class: Class,
    /// What makes the spectrum, a line for each step.
    pub steps: Vec<String>,
    /// The slices of the windowed spectrum.
    pub slices: Slices,
    /// ‖error‖/‖slices‖ of a quadrature, estimated; `None` for a closed form.
    pub quadrature_error: Option<f64>,
    /// The first-order chain; `slices` and all else are then those of the exact ray-space prediction.
    pub first_order: Option<FirstOrder>,
    /// For a reference, its independent batches, of which `slices` is the mean; theory has none.
    pub replicates: Vec<Slices>,
    /// ∫ L W if nothing stood in the way, what the slices of theory are small or large against; zero for a reference.
    pub unblocked: f64,
    /// The windowed light field in (x, u).
    pub projection: Projection,
    /// For each parameter of the chain: name, value and derivative of the slices.
    pub parameters: Vec<PredictedParameter>,
    /// Where energy begins to count as high, cycles per metre, on a plane that light leaves diffusely.
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

/// The steps that make the spectrum of a plane, a line for each: the chain, what theory has no word for, and the window last.
#[must_use]
pub fn steps(scene: &Scene, plane: &VirtualPlane) -> Vec<String> {
    let Window { x, y, u, v } = &plane.window;
    let mut steps = chain(scene, plane).describe();
    if let Some((system, at)) = scattered(scene, plane) {
        let chain = etendue_theory::scattering::chain(&system, &at);
        steps.truncate(1);
        steps.extend(chain.into_iter().flat_map(|chain| chain.steps));
    }
    if let Some(chain) = affine_chain(scene, plane) {
        // What shines is said alike; how it travels, by the maps.
        steps.truncate(1);
        steps.extend(chain.steps);
    }
    let unknown = match Class::of(scene, plane) {
        Class::FirstOrder => Vec::new(),
        Class::Exact | Class::Reference => without_theory(scene, plane),
    };
    steps.extend(unknown.iter().map(|step| format!("without theory  {step}")));
    steps.push(format!(
        "multiply  window: x {x:?}, y {y:?}, u {u:?}, v {v:?}"
    ));
    steps
}

/// Metres, and whatever else parameters are in, that rounding leaves of zero.
const NOTHING: f64 = 1e-9;

impl Prediction {
    /// What theory predicts for a plane of a scene; for a plane behind a mesh see [`Self::reference`].
    #[must_use]
    pub fn new(scene: &Scene, plane: &VirtualPlane) -> Self {
        if Class::of(scene, plane) == Class::FirstOrder
            && let Some((system, at)) = system(scene, plane)
        {
            return Self::by_rays(scene, plane, &system, &at);
        }
        if let Some((system, at)) = scattered(scene, plane) {
            return Self::by_scattering(scene, plane, &system, &at);
        }
        let chain = chain(scene, plane);
        let (window, grid) = (&plane.window, &plane.grid);
        let slices = etendue_theory::slices(&chain, window, grid);
        let cells = ProjectionGrid::new(window, PROJECTION_BINS);
        let parameters = chain
            .parameters()
            .into_iter()
            .map(|parameter| PredictedParameter {
                name: chain.name(parameter),
                unit: chain.unit(parameter).to_owned(),
                value: chain.value(parameter),
                derivative: etendue_theory::derivative(&chain, parameter, window, grid, &slices),
            })
            .collect();
        Self {
            class: Class::of(scene, plane),
            steps: steps(scene, plane),
            quadrature_error: etendue_theory::quadrature_error(&chain, window, grid, &slices),
            first_order: None,
            replicates: Vec::new(),
            unblocked: unblocked(chain.clone(), window),
            projection: etendue_theory::projection(&chain, window, &cells),
            slices,
            parameters,
            cuts: cuts(scene, plane),
        }
    }

    /// What rays followed through the real geometry say, and the first-order chain.
    fn by_rays(scene: &Scene, plane: &VirtualPlane, system: &System, at: &Plane) -> Self {
        let cells = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
        let over = (&plane.window, &plane.grid, &cells);
        let exact = rays::exact(system, at, over, budget(scene));
        let first_order = FirstOrder::new(scene, system, at, over, &exact);
        // A plane at its surface has no travel to it.
        let value = |parameter| {
            let value = system.value(at, parameter);
            value.filter(|value| value.abs() > NOTHING)
        };
        let mut all = system.parameters(at);
        all.retain(|parameter| value(*parameter).is_some());
        let derivatives = rays::derivatives(system, at, &all, over);
        let parameters = all.into_iter().zip(derivatives);
        let parameters = parameters.filter_map(|(parameter, derivative)| {
            Some(PredictedParameter {
                name: system.name(parameter),
                unit: system.unit(parameter).to_owned(),
                value: value(parameter)?,
                derivative: derivative?,
            })
        });
        Self {
            class: Class::FirstOrder,
            steps: steps(scene, plane),
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
            steps: steps(scene, plane),
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

/// Two main lobes of the transform of a Hann window, which end at 1/half-width each, and 1.5 times that, to see whether
/// H hangs on the cut; none where light does not leave a surface.
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
