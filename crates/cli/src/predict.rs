use crate::args::PredictArgs;
use crate::failure::Failure;
use crate::results::Results;
use crate::stored::{Index, PREDICTION};
use crate::threads::on_threads;
use crate::{load, predictions, progress, say};
use etendue_compare::Prediction;
use etendue_scene::Scene;

/// `etendue predict`: returns the exit code.
pub(crate) fn predict(args: &PredictArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene, |_| ())?;
    let mut results = Results::create(&args.out, PREDICTION)?;
    let content = on_threads(&args.threads, || {
        let predictions = predicted(&scene, args.quiet);
        results.begin()?;
        predictions::write(&mut results, &scene, &predictions)
    })?;
    let folder = Index::new(&scene, content).finish(results)?;
    if !args.quiet {
        let planes = scene.planes.len();
        say(&format!("{}: predicted {planes} planes", scene.name));
        say(&format!("prediction in {}", folder.display()));
    }
    Ok(0)
}

/// Predicts all planes of a scene.
pub(crate) fn predicted(scene: &Scene, quiet: bool) -> Vec<Prediction> {
    let stage = progress::stage("predicting", quiet);
    let planes = scene.planes.iter();
    let predictions = planes.map(|plane| Prediction::new(scene, plane)).collect();
    stage.finish_and_clear();
    predictions
}
