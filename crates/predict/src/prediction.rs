//! Predicts the light of a plane.

use crate::applicability::Applicability;
use crate::budget::budget;
use crate::depth::depth;
use crate::first_order::first_order;
use crate::off_patches::OffPatches;
use crate::theories::Theory;
use etendue_compare::{Class, FirstOrder, PredictedParameter, Prediction};
use etendue_field::{Projection, ProjectionGrid, Slices, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::estimate::TooFewBatches;
use etendue_spectrum::{Measurement, PROJECTION_BINS};
use etendue_theory::{Model, Over, Parameter, RayBudget};
use ndarray::Array2;

/// The prediction of theory for a plane of a scene: the sum over all lights. Returns
/// darkness where no theory applies and [`predict_reference`] takes its place.
#[must_use]
pub fn predict(scene: &Scene, plane: &VirtualPlane, applicability: &Applicability) -> Prediction {
    let each = predict_lights(scene, plane, applicability).map(|(_, of)| of);
    let mut each: Vec<Prediction> = each.collect();
    if each.len() == 1 {
        return each.remove(0);
    }
    let first_order = Prediction::chain_of_lights(&each);
    let sum = each.into_iter().reduce(Prediction::plus);
    let sum = sum.unwrap_or_else(|| darkness(scene, plane, applicability));
    Prediction { first_order, ..sum }
}

/// The prediction of theory for each light that may reach a plane, with the number of
/// the light, which begins at 1.
pub fn predict_lights<'a>(
    scene: &'a Scene,
    plane: &'a VirtualPlane,
    applicability: &'a Applicability,
) -> impl Iterator<Item = (usize, Prediction)> + 'a {
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
        let found = of_light((of, &seen, theory), budget, among);
        budget.beside = libm::hypot(budget.beside, found.slices.norm());
        (number, found)
    })
}

/// The prediction for one light. `number` is the number of the light if there are
/// others.
fn of_light(
    (scene, plane, applicability): (&Scene, &VirtualPlane, &Applicability),
    budget: RayBudget,
    number: Option<usize>,
) -> Prediction {
    let empty = darkness(scene, plane, applicability);
    if applicability.dark.is_some() {
        return empty;
    }
    let cells = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
    let over = (&plane.window, &plane.grid, &cells);
    match &applicability.theory {
        Theory::Parallel(chain) => by(empty, chain, over, (budget, number), |_| None),
        Theory::None => empty,
        Theory::Path(view) => {
            let found = by(empty, view.as_ref(), over, (budget, number), |exact| {
                first_order(scene, view, over, (exact, budget))
            });
            let size = found.slices.norm();
            let meshes = applicability.off_patches.filter(|_| size > 0.0);
            let error = |off: OffPatches| off.change * found.slices.at_zero() / size;
            Prediction {
                mesh_error: meshes.map(error),
                ..found
            }
        }
    }
}

/// The smallest share of the light by which a rim that moves a metre must change the light. Where
/// it changes less, the derivative is a rounding error.
const MIN_CHANGE: f64 = 1e-6;

/// The prediction of a model, with the first-order chain beside it.
fn by<M: Model>(
    empty: Prediction,
    model: &M,
    over: Over<'_>,
    (budget, number): (RayBudget, Option<usize>),
    first_order: impl FnOnce(&etendue_theory::Predicted) -> Option<FirstOrder>,
) -> Prediction {
    let mut parameters = model.parameters();
    // The central ray begins at the centre of the first light.
    let is_first = number.is_none_or(|number| number == 1);
    parameters.retain(|p| !is_first || !matches!(p, Parameter::SourcePosition(_)));
    model.keep_affordable(&mut parameters, budget);
    let found = model.predict(&parameters, over, budget);
    let first_order = first_order(&found);
    let name = |parameter| match number.filter(|_| is_of_light(parameter, &parameters)) {
        Some(number) => format!("{} (light {number})", model.name(parameter)),
        None => model.name(parameter),
    };
    let norm = found.slices.norm();
    let derivatives = parameters.iter().copied().zip(found.derivatives);
    let parameters = derivatives.filter_map(|(parameter, derivative)| {
        // Most surfaces are larger than the light that they meet.
        if parameter.is_of_rim() && derivative.norm() <= MIN_CHANGE * norm {
            return None;
        }
        Some(PredictedParameter {
            name: name(parameter),
            unit: model.unit(parameter).to_owned(),
            value: model.value(parameter)?,
            derivative,
        })
    });
    Prediction {
        slices: found.slices,
        quadrature_error: found.error,
        first_order,
        replicates: found.replicates,
        unblocked: found.unblocked,
        projection: found.projection,
        parameters: parameters.collect(),
        ..empty
    }
}

/// A prediction in which no light arrives.
fn darkness(scene: &Scene, plane: &VirtualPlane, applicability: &Applicability) -> Prediction {
    let grid = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
    let values = Array2::zeros((grid.bins, grid.bins));
    let class = applicability.class();
    Prediction {
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

/// A prediction that consists of another, independent measurement of plane `index`.
/// Such a prediction is used where no theory applies.
///
/// # Errors
/// Returns an error if that measurement has too few batches.
pub fn predict_reference(
    scene: &Scene,
    index: usize,
    applicability: &Applicability,
    measurement: &Measurement,
    at: usize,
) -> Result<Prediction, TooFewBatches> {
    let plane = &scene.planes[index];
    Ok(Prediction {
        steps: applicability.steps(scene, plane),
        depth: depth(scene, plane),
        cuts: cuts(scene, plane),
        ..Prediction::measured(measurement, at)?
    })
}

/// Whether a parameter belongs to a light, and not to an object that all lights share.
/// `all` are the parameters of a model; the first travel begins at the light.
fn is_of_light(parameter: Parameter, all: &[Parameter]) -> bool {
    match parameter {
        Parameter::SourceSize(_)
        | Parameter::SourcePosition(_)
        | Parameter::SpotExponent
        | Parameter::ImageWidth(_) => true,
        Parameter::Travel(_) => {
            let is_travel = |other: &&Parameter| matches!(other, Parameter::Travel(_));
            all.iter().find(is_travel) == Some(&parameter)
        }
        _ => false,
    }
}

/// Two cuts. The main lobe of the transform of a Hann window ends at the frequency
/// 1/half-width. The first cut is twice this frequency. The second cut is 1.5 times the first, to
/// show whether H depends on the cut. The list is empty where light does not leave a surface.
fn cuts(scene: &Scene, plane: &VirtualPlane) -> Vec<f64> {
    if plane.leg == 0 || scene.path.along(plane) > 0.0 {
        return Vec::new();
    }
    let cut = 2.0 / plane.window.x.half_width();
    vec![cut, 1.5 * cut]
}
