//! Scenes, measurements and comparisons that several tests need.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

pub(crate) use crate::scenes::{measured, text, traced as photons};
use etendue_compare::{Verdict, compare};
use etendue_predict::{Applicability, predict, test_of};
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_spectrum::Measurement;

/// The folder of the scenes of the repository.
pub(crate) const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes");

/// Resolves the text of a scene. Its other files are in the folder of the scene `name`.
pub(crate) fn resolved(name: &str, text: &str) -> Scene {
    let file = SceneFile::parse(text).unwrap();
    let path = format!("{SCENES}/{name}");
    let (folder, name) = path.rsplit_once('/').unwrap();
    resolve(name, file, folder.as_ref(), u64::MAX).unwrap()
}

/// A scene of the repository, with parts of its text replaced.
pub(crate) fn edited(name: &str, edits: &[(&str, &str)]) -> Scene {
    resolved(name, &text(name, edits))
}

/// Compares a measurement of the scene `traced` with predictions for the scene `predicted`; returns
/// the verdict on each plane.
pub(crate) fn verdicts(
    traced: &Scene,
    measurement: &Measurement,
    predicted: &Scene,
) -> Vec<Verdict> {
    let test = test_of(traced);
    let planes = predicted.planes.iter().enumerate();
    let verdicts = planes.map(|(i, plane)| {
        let theory = Applicability::new(predicted, plane);
        let prediction = predict(predicted, plane, &theory);
        let compared = compare(measurement, i, &prediction, &test).unwrap();
        compared.report.verdict
    });
    verdicts.collect()
}
