//! Predicts all planes of a scene.

use crate::judge::Judge;
use crate::method;
use crate::reporter::{Reporter, Work};
use crate::workers::Leader;
use etendue_compare::{Class, Prediction};
use etendue_predict::{Applicability, predict, predict_reference};
use etendue_scene::Scene;
use etendue_store::{Failure, Method, predictions};
use std::collections::BTreeMap;

/// Predicts all planes of a scene for a measurement by `method`. If no theory applies to a plane,
/// a measurement by another method replaces the prediction.
pub(crate) fn predicted(
    scene: &Scene,
    theories: &[Applicability],
    method: Method,
    workers: Option<&Leader<'_>>,
    reporter: &dyn Reporter,
) -> Result<Vec<Prediction>, Failure> {
    let is_referred = |theory: &Applicability| theory.class() == Class::Reference;
    let referred = theories.iter().enumerate();
    let referred = referred.filter(|(_, theory)| is_referred(theory));
    let referred: Vec<usize> = referred.map(|(i, _)| i).collect();
    let told = (0..)
        .zip(theories)
        .filter(|(_, theory)| !is_referred(theory));
    let told: Vec<u32> = told.map(|(i, _)| i).collect();
    let judges = Judge::all(scene, &referred, method, reporter)?;
    let bar = reporter.begin(Work::Steps {
        verb: "predicting",
        total: scene.planes.len(),
        things: "planes",
    });
    let own = |plane: u32| {
        let at = &scene.planes[plane as usize];
        bar.name(&at.name);
        let prediction = predict(scene, at, &theories[plane as usize]);
        bar.advance(1);
        Ok(prediction)
    };
    let mut told: BTreeMap<u32, Prediction> = match workers {
        None => told
            .iter()
            .map(|i| Ok((*i, own(*i)?)))
            .collect::<Result<_, Failure>>()?,
        Some(workers) => workers.predict(scene, &told, &own, &|plane, bytes| {
            bar.advance(1);
            predictions::unpacked(&scene.planes[plane as usize], bytes)
        })?,
    };
    let planes = (0_u32..).zip(theories).map(|(number, theory)| {
        let i = number as usize;
        let Some((judge, at)) = Judge::of(&judges, i) else {
            let missing = || Failure::cannot_run("a plane was not predicted");
            return told.remove(&number).ok_or_else(missing);
        };
        bar.advance(1);
        let reference = predict_reference(scene, i, theory, &judge.measurement, at);
        let mut prediction = reference.map_err(Failure::cannot_run)?;
        prediction.steps.push(method::step(judge.method));
        Ok(prediction)
    });
    let planes = planes.collect();
    drop(bar);
    planes
}
