//! Plans a fit: how many photons each free field needs at each plane.

use crate::fit::data::FitData;
use crate::fit::model::{FitModel, first_steps, size};
use crate::fit::request::FitRequest;
use crate::fit::result::{Degeneracy, degeneracy_of, is_determined, spread};
use crate::fit::search::FitStarts;
use etendue_field::{brief, grouped};
use etendue_pipeline::{Reporter, measured};
use etendue_report::table::aligned;
use etendue_store::{Failure, Method};
use serde::Serialize;
use std::ops::Range;

/// The error at which a field is told, as a share of its value.
const TOLD: f64 = 0.01;

/// A plane does not depend on a field if the information about relative changes is smaller: a change
/// of a million times the value would be within the noise.
const SEEN: f64 = 1e-12;

/// How well a plane, or all planes together, tell the free fields.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlannedPlane {
    /// The name of the plane, or `all planes`.
    pub name: String,
    /// The number of photons at which the error of each field is 1 % of its value; `None` if the
    /// plane does not tell the field.
    pub photons: Vec<Option<f64>>,
    /// Fields that the plane tells badly from each other.
    pub degeneracy: Option<Degeneracy>,
}

/// The plan of a fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FitPlan {
    /// Name of the scene.
    pub scene: String,
    /// The free fields.
    pub fields: Vec<String>,
    /// The values of the fields in the scene.
    pub values: Vec<f64>,
    /// Number of photons from which the noise is known.
    pub pilot: u64,
    /// All planes together, and then each plane.
    pub planes: Vec<PlannedPlane>,
}

/// Plans a fit from the noise of `pilot` photons, which falls as the root of their number.
pub fn plan(request: &FitRequest, pilot: u64, reporter: &dyn Reporter) -> Result<FitPlan, Failure> {
    let (scene, FitStarts { values, .. }) = request.read()?;
    let few = request.scene_at(&values, pilot)?;
    let batches = 0..few.run.batches;
    let measurement = measured(&few, Method::Photons, batches, reporter)?;
    let data = FitData::of_measurement(&measurement, &scene)?
        .at(&request.planes, request.scene.arguments)?;
    let model = FitModel {
        scene_at: &|values| request.scene_at(values, pilot),
        fields: &request.free,
        planes: &data.planes,
    };
    let here = model.predict(&values, 1.0)?;
    let at = model.linearised(&values, here, &first_steps(&values), 1.0)?;
    let residuals = model.residuals(&at);
    let planned = |name: String, planes: Range<usize>| {
        let equations = model.each(&at, &residuals, planes);
        let is_seen = |i: &usize| {
            let size = size(values[*i]);
            equations.information[[*i, *i]] * size * size > SEEN
        };
        let seen: Vec<usize> = (0..values.len()).filter(is_seen).collect();
        let equations = equations.only(&seen);
        let pick = |i: &usize| (request.free[*i].clone(), values[*i]);
        let (names, of): (Vec<String>, Vec<f64>) = seen.iter().map(pick).unzip();
        let degeneracy = degeneracy_of(&names, &of, &equations.information);
        let steps = equations
            .steps()
            .filter(|_| is_determined(degeneracy.as_ref()));
        let mut photons = vec![None; values.len()];
        if let Some(covariance) = steps.as_ref().map(spread) {
            for (place, i) in seen.iter().enumerate() {
                let told = TOLD * size(values[*i]);
                let variance = covariance[[place, place]];
                photons[*i] = Some(pilot as f64 * variance / (told * told));
            }
        }
        PlannedPlane {
            name,
            photons,
            degeneracy,
        }
    };
    let single = data.planes.iter().enumerate();
    let single = single.map(|(i, of)| planned(of.plane.name.clone(), i..i + 1));
    let mut planes: Vec<PlannedPlane> = single.collect();
    if planes.len() > 1 {
        planes.insert(0, planned("all planes".to_owned(), 0..planes.len()));
    }
    Ok(FitPlan {
        scene: scene.name,
        fields: request.free.clone(),
        values,
        pilot,
        planes,
    })
}

impl FitPlan {
    /// The plan as text, for a terminal.
    #[must_use]
    pub fn text(&self) -> String {
        let header = ["field", "scene"].map(str::to_owned).into_iter();
        let header = header
            .chain(self.planes.iter().map(|planned| planned.name.clone()))
            .collect();
        let rows = self
            .fields
            .iter()
            .zip(&self.values)
            .enumerate()
            .map(|(i, (field, value))| {
                let cells = self.planes.iter().map(|planned| match planned.photons[i] {
                    Some(photons) => format!("{photons:.1e}"),
                    None => "–".to_owned(),
                });
                [field.clone(), brief(*value)]
                    .into_iter()
                    .chain(cells)
                    .collect()
            });
        let mut lines = vec![
            format!(
                "{}: photons at which the error of each field is {} % of its value (or 0.01, if it is 0)",
                self.scene,
                100.0 * TOLD
            ),
            String::new(),
        ];
        lines.extend(aligned(std::iter::once(header).chain(rows).collect()));
        lines.push(String::new());
        for planned in &self.planes {
            if let Some(degeneracy) = &planned.degeneracy {
                let name = &planned.name;
                lines.push(format!("{name}: hard to tell apart: {}", degeneracy.words));
            }
        }
        lines.push(format!(
            "the noise is that of {} photons, scaled with their root: photons of lattices, the default, may need fewer",
            grouped(self.pilot)
        ));
        lines.join("\n")
    }
}
