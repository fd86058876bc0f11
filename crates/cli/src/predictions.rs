//! Predictions as files: `prediction.npz` for each plane.

use crate::failure::Failure;
use crate::npz::Npz;
use crate::results::Results;
use crate::stored::Stored;
use etendue_compare::{Class, PredictedParameter, Prediction, chain, steps};
use etendue_field::{Complex, Projection, ProjectionGrid, Slices, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::PROJECTION_BINS;
use ndarray::{Array0, Array1, Array4, Axis, arr0};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// What `prediction.json` says beside the scene.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Predicted {
    pub(crate) planes: Vec<PredictedPlane>,
}

/// The words of a prediction; its numbers are in the arrays.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct PredictedPlane {
    name: String,
    class: Value,
    chain: Vec<String>,
    /// Names of the parameters, in the order of the arrays.
    parameters: Vec<String>,
}

fn file_of(plane: &VirtualPlane) -> String {
    format!("{}/prediction.npz", plane.name)
}

/// Writes the predictions of the planes of a scene; returns what the index says of them.
pub(crate) fn write(
    results: &mut Results,
    scene: &Scene,
    predictions: &[Prediction],
) -> Result<Predicted, Failure> {
    let mut planes = Vec::new();
    for (plane, prediction) in scene.planes.iter().zip(predictions) {
        // Every field by name: a new one must be stored too.
        let Prediction {
            class,
            chain,
            slices,
            unblocked,
            projection,
            parameters,
        } = prediction;
        let values: Array1<f64> = parameters.iter().map(|p| p.value).collect();
        let [azimuths, rho, nu] = slices.grid.half_shape();
        let mut derivatives = Array4::<Complex>::zeros([parameters.len(), azimuths, rho, nu]);
        for (mut row, parameter) in derivatives.outer_iter_mut().zip(parameters) {
            row.assign(&parameter.derivative.half);
        }
        let bytes = Npz::new()
            .add("slices", &slices.half)?
            .add("projection", &projection.values)?
            .add("unblocked", &arr0(*unblocked))?
            .add("values", &values)?
            .add("derivatives", &derivatives)?
            .add_half_axes(&slices.grid)?
            .bytes()?;
        results.write(&file_of(plane), &bytes)?;
        planes.push(PredictedPlane {
            name: plane.name.clone(),
            class: word(*class),
            chain: steps(chain, &plane.window),
            parameters: parameters.iter().map(|p| p.name.clone()).collect(),
        });
    }
    Ok(Predicted { planes })
}

/// Reads the predictions of the planes of a scene.
pub(crate) fn read(stored: &Stored<Predicted>, scene: &Scene) -> Result<Vec<Prediction>, Failure> {
    let planes = &stored.index.content.planes;
    let predicted: Vec<&str> = planes.iter().map(|plane| plane.name.as_str()).collect();
    let wanted: Vec<&str> = scene
        .planes
        .iter()
        .map(|plane| plane.name.as_str())
        .collect();
    if predicted != wanted {
        let [predicted, wanted] = [predicted, wanted].map(|planes| planes.join(", "));
        return Err(stored.fault(format!("planes [{predicted}]; must be [{wanted}]")));
    }
    let pairs = scene.planes.iter().zip(planes);
    pairs
        .map(|(plane, words)| read_plane(stored, scene, plane, words))
        .collect()
}

fn read_plane(
    stored: &Stored<Predicted>,
    scene: &Scene,
    plane: &VirtualPlane,
    words: &PredictedPlane,
) -> Result<Prediction, Failure> {
    // The chain is a matter of the scene: it is read off it again.
    let chain = chain(scene, plane);
    let class = Class::of(&chain);
    if words.class != word(class) {
        let (name, is, must) = (&plane.name, &words.class, word(class));
        return Err(stored.fault(format!("class of {name} is {is}; must be {must}")));
    }
    let mut file = stored.npz(&file_of(plane))?;
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
    let parameters = words.parameters.iter().enumerate();
    Ok(Prediction {
        class,
        chain,
        slices: slices(half),
        unblocked: unblocked.into_scalar(),
        projection: Projection {
            grid: cells,
            values: file.array("projection", [cells.bins, cells.bins])?,
        },
        parameters: parameters
            .map(|(i, name)| PredictedParameter {
                name: name.clone(),
                value: values[i],
                derivative: slices(derivatives.index_axis(Axis(0), i).to_owned()),
            })
            .collect(),
    })
}

/// A class as written.
fn word(class: Class) -> Value {
    // Cannot fail: it is a word.
    serde_json::to_value(class).unwrap_or_default()
}
