//! Stores predictions as files, which are named `prediction.npz` for each plane.

use crate::framing::{joined, split};
use crate::npz::{Npz, NpzFile};
use crate::stored::Stored;
use crate::{Failure, Method, Results};
use etendue_compare::{Class, FirstOrder, FirstOrderChain, PredictedParameter, Prediction};
use etendue_field::{Complex, Projection, ProjectionGrid, SliceGrid, Slices, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::PROJECTION_BINS;
use ndarray::{Array0, Array1, Array4, Axis, arr0};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The content of `prediction.json`, beside the scene.
#[derive(Debug, Serialize, Deserialize)]
pub struct StoredPrediction {
    /// Method of the measurement with which the prediction is to be compared. At a plane without a
    /// theory, a measurement by another method takes the place of the prediction.
    method: Method,
    /// A prediction for each plane of the scene.
    pub planes: Vec<PredictedPlane>,
}

/// The part of a prediction that is stored in the index. The numbers of the prediction are in the
/// arrays.
#[derive(Debug, Serialize, Deserialize)]
pub struct PredictedPlane {
    name: String,
    class: Class,
    chain: Vec<String>,
    quadrature_error: Option<f64>,
    mesh_error: Option<f64>,
    /// The error of lights without replicates, if other lights have replicates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rule_error: Option<f64>,
    /// Numbers of the chain of affine maps, whose slices are in the arrays.
    first_order: Option<FirstOrderChain>,
    /// Names and units of the parameters, in the order of the arrays.
    parameters: Vec<[String; 2]>,
    cuts: Vec<f64>,
    depth: Option<[f64; 2]>,
    /// Two numbers of independent replicates: of the slices, and of the slices by the chain of
    /// affine maps. A number is zero if its slices have no statistical error.
    replicates: [usize; 2],
}

fn file_of(plane: &VirtualPlane) -> String {
    format!("{}/prediction.npz", plane.name)
}

/// The names of the files of a prediction.
pub fn names(planes: &[VirtualPlane]) -> Vec<String> {
    planes.iter().map(file_of).collect()
}

/// Writes the predictions of the planes of a scene for a measurement by `method`. Returns the
/// content of the index.
pub fn write(
    results: &mut Results,
    scene: &Scene,
    method: Method,
    predictions: &[Prediction],
) -> Result<StoredPrediction, Failure> {
    let mut planes = Vec::new();
    for (plane, prediction) in scene.planes.iter().zip(predictions) {
        let (words, bytes) = stored(plane, prediction)?;
        results.write(&file_of(plane), &bytes)?;
        planes.push(words);
    }
    Ok(StoredPrediction { method, planes })
}

/// A prediction as bytes, for another process.
pub fn packed(plane: &VirtualPlane, prediction: &Prediction) -> Result<Vec<u8>, Failure> {
    let (words, bytes) = stored(plane, prediction)?;
    Ok(joined(&words, &bytes))
}

/// The prediction of a plane from bytes of [`packed`].
pub fn unpacked(plane: &VirtualPlane, bytes: &[u8]) -> Result<Prediction, Failure> {
    let (words, bytes): (PredictedPlane, _) = split(bytes).map_err(Failure::cannot_run)?;
    let file = NpzFile::new(PathBuf::from(file_of(plane)), bytes.to_vec())?;
    read_plane(file, plane, &words)
}

/// The text of a prediction, and the bytes of its file of arrays.
fn stored(
    plane: &VirtualPlane,
    prediction: &Prediction,
) -> Result<(PredictedPlane, Vec<u8>), Failure> {
    // Every field is listed by name, so that a new field cannot be forgotten.
    let Prediction {
        class,
        steps,
        slices,
        quadrature_error,
        mesh_error,
        rule_error,
        first_order,
        replicates,
        unblocked,
        projection,
        parameters,
        cuts,
        depth,
    } = prediction;
    let values: Array1<f64> = parameters.iter().map(|p| p.value).collect();
    let grid = &slices.grid;
    let linear_replicates = first_order
        .as_ref()
        .map_or(&[][..], |chain| &chain.replicates);
    let bytes = Npz::default()
        .add("slices", &slices.half)?
        .add(
            "first_order",
            &stacked(grid, first_order.iter().map(|chain| &chain.slices)),
        )?
        .add("projection", &projection.values)?
        .add("unblocked", &arr0(*unblocked))?
        .add("values", &values)?
        .add(
            "derivatives",
            &stacked(grid, parameters.iter().map(|p| &p.derivative)),
        )?
        .add("replicates", &stacked(grid, replicates))?
        .add("first_order_replicates", &stacked(grid, linear_replicates))?
        .add_half_axes(grid)?
        .bytes()?;
    let words = PredictedPlane {
        name: plane.name.clone(),
        class: *class,
        chain: steps.clone(),
        quadrature_error: *quadrature_error,
        mesh_error: *mesh_error,
        rule_error: *rule_error,
        first_order: first_order.as_ref().map(|f| f.chain.clone()),
        parameters: parameters
            .iter()
            .map(|p| [p.name.clone(), p.unit.clone()])
            .collect(),
        cuts: cuts.clone(),
        depth: *depth,
        replicates: [replicates.len(), linear_replicates.len()],
    };
    Ok((words, bytes))
}

/// Slices as one array, [slices, azimuth, ρ ≥ 0, ν].
pub(super) fn stacked<'a>(
    grid: &SliceGrid,
    all: impl IntoIterator<Item = &'a Slices, IntoIter: ExactSizeIterator>,
) -> Array4<Complex> {
    let all = all.into_iter();
    let [azimuths, rho, nu] = grid.half_shape();
    let mut stacked = Array4::zeros([all.len(), azimuths, rho, nu]);
    for (mut row, slices) in stacked.outer_iter_mut().zip(all) {
        row.assign(&slices.half);
    }
    stacked
}

/// Reads the predictions of the planes of a scene for a measurement by `method`. `classes` are the
/// classes that the planes have today.
pub fn read(
    stored: &Stored<StoredPrediction>,
    scene: &Scene,
    classes: &[Class],
    method: Method,
) -> Result<Vec<Prediction>, Failure> {
    let StoredPrediction {
        method: predicted_for,
        planes,
    } = &stored.index.content;
    // Without this check, a reference would be compared with a measurement by the same method.
    if planes.iter().any(|plane| plane.class == Class::Reference) && *predicted_for != method {
        let what = format!(
            "the prediction is for method {predicted_for:?}, but the method of the measurement is {method:?}"
        );
        return Err(stored.fault(what));
    }
    let predicted: Vec<&str> = planes.iter().map(|plane| plane.name.as_str()).collect();
    let wanted: Vec<&str> = scene
        .planes
        .iter()
        .map(|plane| plane.name.as_str())
        .collect();
    if predicted != wanted {
        let [predicted, wanted] = [predicted, wanted].map(|planes| planes.join(", "));
        return Err(stored.fault(format!("the planes are [{predicted}]; must be [{wanted}]")));
    }
    let planes = scene.planes.iter().zip(classes).zip(planes);
    planes
        .map(|((plane, class), words)| {
            if words.class != *class {
                let (name, is) = (&plane.name, words.class);
                return Err(stored.fault(format!(
                    "the class of plane {name} is {is:?}; must be {class:?}"
                )));
            }
            read_plane(stored.npz(&file_of(plane))?, plane, words)
        })
        .collect()
}

fn read_plane(
    mut file: NpzFile,
    plane: &VirtualPlane,
    words: &PredictedPlane,
) -> Result<Prediction, Failure> {
    file.check_half_axes(&plane.grid)?;
    let slices = |half| Slices {
        grid: plane.grid,
        half,
    };
    let cells = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
    let count = words.parameters.len();
    let [azimuths, rho, nu] = plane.grid.half_shape();
    let half = file.array("slices", [azimuths, rho, nu])?;
    let unblocked: Array0<f64> = file.array("unblocked", ())?;
    let values: Array1<f64> = file.array("values", [count])?;
    let derivatives: Array4<Complex> = file.array("derivatives", [count, azimuths, rho, nu])?;
    let mut stack = |name: &str, count: usize| -> Result<Vec<Slices>, Failure> {
        let all: Array4<Complex> = file.array(name, [count, azimuths, rho, nu])?;
        Ok(all
            .outer_iter()
            .map(|half| slices(half.to_owned()))
            .collect())
    };
    let linear = stack("first_order", usize::from(words.first_order.is_some()))?;
    let [replicates, linear_replicates] = words.replicates;
    let replicates = stack("replicates", replicates)?;
    let linear_replicates = stack("first_order_replicates", linear_replicates)?;
    let first_order = linear.into_iter().zip(&words.first_order).next();
    let parameters = words.parameters.iter().enumerate();
    Ok(Prediction {
        class: words.class,
        steps: words.chain.clone(),
        slices: slices(half),
        quadrature_error: words.quadrature_error,
        mesh_error: words.mesh_error,
        rule_error: words.rule_error,
        first_order: first_order.map(|(slices, chain)| FirstOrder {
            slices,
            replicates: linear_replicates,
            chain: chain.clone(),
        }),
        replicates,
        cuts: words.cuts.clone(),
        depth: words.depth,
        unblocked: unblocked.into_scalar(),
        projection: Projection {
            grid: cells,
            values: file.array("projection", [cells.bins, cells.bins])?,
        },
        parameters: parameters
            .map(|(i, [name, unit])| PredictedParameter {
                name: name.clone(),
                unit: unit.clone(),
                value: values[i],
                derivative: slices(derivatives.index_axis(Axis(0), i).to_owned()),
            })
            .collect(),
    })
}
