//! Scenes, measurements and comparisons that several tests need.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_compare::{Verdict, compare};
use etendue_field::PhotonSource;
use etendue_predict::{Applicability, predict, test_of};
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_spectrum::{Measurement, measure};
use etendue_trace::Tracer;

/// The folder of the scenes of the repository.
pub(crate) const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes");

/// Returns the text of a scene of the repository, with parts of it replaced.
pub(crate) fn text(name: &str, edits: &[(&str, &str)]) -> String {
    let mut text = std::fs::read_to_string(format!("{SCENES}/{name}.ron")).unwrap();
    for (from, to) in edits {
        assert!(text.contains(from), "{from} is not in {name}");
        text = text.replace(from, to);
    }
    text
}

/// Resolves the text of a scene. Its other files are in the folder of the scene `name`.
pub(crate) fn resolved(name: &str, text: &str) -> Scene {
    let file = SceneFile::parse(text).unwrap();
    let path = format!("{SCENES}/{name}");
    let (folder, name) = path.rsplit_once('/').unwrap();
    resolve(name, file, folder.as_ref(), u64::MAX).unwrap()
}

/// Returns a scene of the repository, with parts of its text replaced.
pub(crate) fn edited(name: &str, edits: &[(&str, &str)]) -> Scene {
    resolved(name, &text(name, edits))
}

pub(crate) fn measured(scene: &Scene, source: &dyn PhotonSource) -> Measurement {
    measure(source, &scene.planes, 0..scene.run.batches, &|_| ())
}

pub(crate) fn photons(scene: &Scene) -> Measurement {
    measured(scene, &Tracer::new(scene))
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
