use crate::chain::{chain, meshes, visited};
use etendue_field::{Profile, Projection, ProjectionGrid, Slices, VirtualPlane, Window};
use etendue_scene::Scene;
use etendue_spectrum::estimate::{self, TooFewBatches};
use etendue_spectrum::{Measurement, PROJECTION_BINS};
use etendue_theory::{Chain, Operator};
use serde::{Deserialize, Serialize};

/// What kind of prediction a plane has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// Equals the expectation of the measurement, in closed form or by quadrature.
    Exact,
    /// There is no theory: the other tracer's measurement takes its place.
    Reference,
}

impl Class {
    /// The kind of prediction a plane has: what stands in planes has closed forms or quadratures; a mesh has not, nor has a
    /// plane that sees the edge of the surface light leaves.
    #[must_use]
    pub fn of(scene: &Scene, plane: &VirtualPlane) -> Self {
        if meshes(scene, plane).next().is_some() || !is_covered(scene, plane) {
            Self::Reference
        } else {
            Self::Exact
        }
    }
}

/// Whether a plane after the reflection looks at nothing beyond the edge of the surface: theory takes it to be endless.
fn is_covered(scene: &Scene, plane: &VirtualPlane) -> bool {
    let (1.., Some(surface)) = (plane.reflections, visited(scene)) else {
        return true;
    };
    let (w, travelled) = (&plane.window, plane.distance - scene.path.length);
    let covers = |axis: usize, space: &Profile, slope: &Profile| {
        let reach = space.half_width() + travelled * slope.half_width();
        let [low, high] = surface.rectangle.extent(axis);
        low <= -reach && reach <= high
    };
    covers(0, &w.x, &w.u) && covers(1, &w.y, &w.v)
}

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
    /// For a reference, its independent batches, of which `slices` is the mean; theory has none.
    pub replicates: Vec<Slices>,
    /// ∫ L W if nothing stood in the way: what the slices are small or large against.
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

/// The steps that make the spectrum of a plane, a line for each: the chain, meshes, and the window last.
#[must_use]
pub fn steps(scene: &Scene, plane: &VirtualPlane) -> Vec<String> {
    let Window { x, y, u, v } = &plane.window;
    let mut steps = chain(scene, plane).describe();
    steps.extend(meshes(scene, plane).map(|mesh| {
        let (name, count, [near, far]) = (&mesh.name, mesh.triangles.len(), mesh.extent);
        format!("multiply  visibility of {name}: {count} triangles at {near:.4} to {far:.4} m, without theory")
    }));
    steps.push(format!(
        "multiply  window: x {x:?}, y {y:?}, u {u:?}, v {v:?}"
    ));
    steps
}

impl Prediction {
    /// What theory predicts for a plane of a scene; for a plane behind a mesh see [`Self::reference`].
    #[must_use]
    pub fn new(scene: &Scene, plane: &VirtualPlane) -> Self {
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
            replicates: Vec::new(),
            unblocked: unblocked(chain.clone(), window),
            projection: etendue_theory::projection(&chain, window, &cells),
            slices,
            parameters,
            cuts: cuts(scene, plane),
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
            replicates: measurement
                .at_plane(at)
                .map(|batch| batch.slices.clone())
                .collect(),
            unblocked: unblocked(chain(scene, plane), &plane.window),
            projection: estimate::projection(measurement, at)?.mean,
            parameters: Vec::new(),
            cuts: cuts(scene, plane),
        })
    }
}

/// Two main lobes of the transform of a Hann window, which end at 1/half-width each, and 1.5 times that, to see whether
/// H hangs on the cut; none where light does not leave a surface.
fn cuts(scene: &Scene, plane: &VirtualPlane) -> Vec<f64> {
    if plane.reflections == 0 || plane.distance > scene.path.length {
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
