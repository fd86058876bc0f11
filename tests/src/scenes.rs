//! The scenes used for validation, and functions that measure and predict them.

use etendue_compare::{Class, PlaneComparison, Prediction, Test, compare};
use etendue_field::{Crossing, Ledger, PhotonSource};
use etendue_predict::{Applicability, predict, predict_reference, test_of};
use etendue_scene::{RunFile, Sampling, Scene, SceneFile, resolve};
use etendue_spectrum::{Measurement, measure};
use etendue_trace::{AllLights, Backward, Tracer};

/// The names of all scenes of the repository that `suite` judges. The scenes of `shading` and of
/// `table1` are not among them.
pub(crate) const SUITE: &str = "travel fig1 fig3 fig8 fig9a fig9b fig9c fig4_source fig4_point \
    fig4_spot fig7_one fig7_other fig7_two fig14 fig15 grating two_layers iris disc_light \
    two_lights colors mesh_blocker furnace diffuse two_bounces two_glossy";

/// The scene `scenes/NAME.ron`. If no number of photons or no seed is given, the scene
/// keeps the value in its file.
///
/// # Panics
/// Panics if there is no scene of this name, or if the scene is invalid.
pub(crate) fn named(name: &str, photons: Option<u64>, seed: Option<u64>) -> Scene {
    let mut file = read(name, &[]);
    emit(&mut file.run, photons);
    file.run.seed = seed.unwrap_or(file.run.seed);
    sound(name.rsplit('/').next().unwrap_or(name), file)
}

/// The text of `scenes/NAME.ron` after the given replacements, made in the given order.
///
/// # Panics
/// Panics if there is no such scene file, or if it does not contain one of the texts.
pub(crate) fn text(name: &str, edits: &[(&str, &str)]) -> String {
    let path = format!("{}/../scenes/{name}.ron", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("a file of the repository");
    edits.iter().fold(text, |text, (old, new)| {
        assert!(text.contains(old), "{name} has no {old}");
        text.replace(old, new)
    })
}

/// Reads `scenes/NAME.ron`, and sets fields of the file, as `--set` does.
///
/// # Panics
/// Panics if there is no such scene file, or if it has no such field.
pub(crate) fn read(name: &str, fields: &[(&str, String)]) -> SceneFile {
    let text = text(name, &[]);
    let fields = fields
        .iter()
        .map(|(path, value)| ((*path).to_owned(), value.clone()));
    let fields: Vec<_> = fields.collect();
    let file = SceneFile::parse(&text).expect("a scene file");
    file.with_all(&fields).expect("fields of the scene")
}

/// Resolves a scene that needs no other files.
///
/// # Panics
/// Panics if the scene is invalid.
pub(crate) fn sound(name: &str, file: SceneFile) -> Scene {
    resolve(name, file, ".".as_ref(), u64::MAX).expect("a sound scene")
}

/// The scene `fig9b` with the given number of photons and seed.
pub(crate) fn fig9b(photons: u64, seed: u64) -> Scene {
    named("fig9b", Some(photons), Some(seed))
}

/// The scene `fig9b` with only the receiver plane: all photons are aimed at its window.
pub(crate) fn receiver(photons: u64, seed: u64) -> Scene {
    let mut scene = fig9b(photons, seed);
    scene.planes.retain(|plane| plane.name == "receiver");
    scene
}

/// The scene with photons that use the given kind of random numbers.
pub(crate) fn sampled(mut scene: Scene, sampling: Sampling) -> Scene {
    scene.run.sampling = sampling;
    scene
}

/// A description of the photons' random numbers.
pub(crate) fn words(sampling: Sampling) -> &'static str {
    match sampling {
        Sampling::Lattice => "lattices",
        Sampling::Net => "nets",
        Sampling::Random => "random numbers",
    }
}

/// Changes the number of photons of a run. The resolution is scaled by the inverse square root of
/// the number of photons, as noise is.
pub(crate) fn emit(run: &mut RunFile, photons: Option<u64>) {
    let Some(photons) = photons else { return };
    let more_noise = (run.photons as f64 / photons as f64).sqrt();
    run.resolution = (run.resolution * more_noise.max(1.0)).min(1.0);
    run.photons = photons;
}

/// Measures a scene with photons from `source`.
pub(crate) fn measured(scene: &Scene, source: &dyn PhotonSource) -> Measurement {
    measure(source, &scene.planes, 0..scene.run.batches, &|_| ())
}

/// Measures a scene with the photon tracer.
pub(crate) fn traced(scene: &Scene) -> Measurement {
    if scene.other_lights.is_empty() {
        measured(scene, &Tracer::new(scene))
    } else {
        measured(scene, &AllLights::photons(scene))
    }
}

/// Measures two scenes with the same photons.
pub(crate) fn paired(scenes: [&Scene; 2]) -> [Measurement; 2] {
    if scenes[0].other_lights.is_empty() {
        let [a, b] = Tracer::pair(scenes);
        [measured(scenes[0], &a), measured(scenes[1], &b)]
    } else {
        let [a, b] = AllLights::pair(scenes);
        [measured(scenes[0], &a), measured(scenes[1], &b)]
    }
}

/// A tracer that modifies crossings before they are recorded.
struct Tampered<F> {
    tracer: Tracer,
    crossing: F,
}

impl<F: Fn(usize, Crossing) -> Option<Crossing> + Sync> PhotonSource for Tampered<F> {
    fn emitted(&self, batch: u32) -> u64 {
        self.tracer.emitted(batch)
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let mut tampered = |plane: usize, crossings: &[Crossing]| {
            let numbered = crossings.iter().enumerate();
            let kept = numbered.filter_map(|(i, c)| (self.crossing)(i, *c));
            record(plane, &kept.collect::<Vec<_>>());
        };
        self.tracer.emit(batch, &mut tampered, progress)
    }
}

/// Measures a scene with photons whose crossings are modified before they are recorded. The
/// function that modifies a crossing also receives the index of this crossing in its block; it
/// returns `None` for a photon that is lost.
pub(crate) fn tampered(
    scene: &Scene,
    crossing: impl Fn(usize, Crossing) -> Option<Crossing> + Sync,
) -> Measurement {
    let tracer = Tracer::new(scene);
    measured(scene, &Tampered { tracer, crossing })
}

/// Measures a scene with photons that are not aimed.
pub(crate) fn traced_evenly(scene: &Scene) -> Measurement {
    if scene.other_lights.is_empty() {
        measured(scene, &Tracer::with_uniform_emission(scene))
    } else {
        measured(scene, &AllLights::with_uniform_emission(scene))
    }
}

/// Measures a scene with backward rays; returns `None` if no backward tracer exists for the
/// scene.
pub(crate) fn traced_backwards(scene: &Scene) -> Option<Measurement> {
    if !scene.other_lights.is_empty() {
        return Some(measured(scene, &AllLights::backward(scene).ok()?));
    }
    let backward = Backward::new(scene).ok()?;
    Some(measured(scene, &backward))
}

/// A scene whose planes are measured with photons, and compared with predictions and with backward
/// rays.
pub(crate) struct ComparedScene {
    pub(crate) scene: Scene,
    pub(crate) measurement: Measurement,
    pub(crate) planes: Vec<PlaneComparison>,
    /// For each plane, the p-value of the comparison of photons with backward rays; `None` if no
    /// backward rays are traced.
    pub(crate) backward: Vec<Option<f64>>,
}

impl ComparedScene {
    /// Measures and compares all planes, at the given level.
    pub(crate) fn new(scene: Scene, level: f64) -> Self {
        let measurement = traced(&scene);
        let reference = traced_backwards(&scene);
        let predictions = predicted(&scene, reference.as_ref());
        let at = |i: usize| compared(&scene, &measurement, i, &predictions[i], level);
        let against = |i: usize| {
            let reference = referred(&scene, i, reference.as_ref()?);
            let compared = compared(&scene, &measurement, i, &reference, level);
            compared.report.p_value
        };
        let planes = 0..scene.planes.len();
        Self {
            planes: planes.clone().map(at).collect(),
            backward: planes.map(against).collect(),
            measurement,
            scene,
        }
    }
}

/// Predicts all planes of a scene; the measurement `reference` replaces theory at planes where no
/// theory applies.
///
/// # Panics
/// Panics if a plane needs a reference and there is none.
pub(crate) fn predicted(scene: &Scene, reference: Option<&Measurement>) -> Vec<Prediction> {
    let planes = scene.planes.iter().enumerate();
    planes
        .map(|(i, plane)| {
            let theory = Applicability::new(scene, plane);
            match theory.class() {
                Class::Exact | Class::FirstOrder => predict(scene, plane, &theory),
                Class::Reference => referred(scene, i, reference.expect("a reference")),
            }
        })
        .collect()
}

/// The prediction that a reference measurement gives for the plane with index `index`.
///
/// # Panics
/// Panics if the reference measurement has too few batches.
pub(crate) fn referred(scene: &Scene, index: usize, reference: &Measurement) -> Prediction {
    let theory = Applicability::new(scene, &scene.planes[index]);
    let reference = predict_reference(scene, index, &theory, reference, index);
    reference.expect("a scene has 32 batches")
}

/// Compares a plane with a prediction.
///
/// # Panics
/// Panics if the measurement has too few batches.
pub(crate) fn compared(
    scene: &Scene,
    measurement: &Measurement,
    index: usize,
    prediction: &Prediction,
    level: f64,
) -> PlaneComparison {
    let test = Test {
        level,
        ..test_of(scene)
    };
    compare(measurement, index, prediction, &test).expect("a scene has 32 batches")
}
