use crate::args::PredictArgs;
use crate::failure::Failure;
use crate::judge::Judge;
use crate::method::Method;
use crate::results::PREDICTION;
use crate::results::predictions;
use crate::results::stored::Index;
use crate::threads::on_threads;
use crate::{limits, load, method, progress, say, warnings};
use etendue_compare::{Applicability, Class, Prediction};
use etendue_scene::Scene;

/// `etendue predict`: returns the exit code.
pub(crate) fn predict(args: &PredictArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene, |run| args.photons.set(run))?;
    let theories = Applicability::of_planes(&scene);
    method::check(&scene, args.photons.method)?;
    let (results, content) = on_threads(&args.threads, || {
        warnings::tell(&scene, args.quiet);
        limits::check(&scene, &theories, rayon::current_num_threads())?;
        let files = predictions::names(&scene.planes);
        let mut results = load::stage(
            &args.out,
            PREDICTION,
            files,
            &scene,
            &args.scene,
            args.force.force,
        )?;
        let method = args.photons.method;
        let predictions = predicted(&scene, &theories, method, args.quiet)?;
        let content = predictions::write(&mut results, &scene, method, &predictions)?;
        Ok((results, content))
    })?;
    let finished = Index::new(&scene, content).finish(results)?;
    finished.tell_replaced(args.quiet);
    if !args.quiet {
        let planes = scene.planes.len();
        say(&format!("{}: predicted {planes} planes", scene.name));
        say(&format!("prediction in {}", finished.folder.display()));
    }
    Ok(0)
}

/// Predicts all planes of a scene for a measurement by `method`; where theory has no word, another
/// method's measurement takes its place.
pub(crate) fn predicted(
    scene: &Scene,
    theories: &[Applicability],
    method: Method,
    quiet: bool,
) -> Result<Vec<Prediction>, Failure> {
    let classes = theories.iter().map(Applicability::class).enumerate();
    let referred = classes.filter(|(_, class)| *class == Class::Reference);
    let referred: Vec<usize> = referred.map(|(i, _)| i).collect();
    let judges = Judge::all(scene, &referred, method, quiet)?;
    let bar = progress::steps("predicting", scene.planes.len(), "planes", quiet);
    let planes = scene.planes.iter().zip(theories).enumerate();
    let predictions = planes.map(|(i, (plane, theory))| {
        bar.set_message(plane.name.clone());
        let prediction = match Judge::of(&judges, i) {
            Some((judge, at)) => {
                let reference = Prediction::reference(scene, i, theory, &judge.measurement, at);
                let reference = reference.map(|mut prediction| {
                    prediction.steps.push(judge.method.step());
                    prediction
                });
                reference.map_err(Failure::cannot_run)
            }
            None => Ok(Prediction::new(scene, plane, theory)),
        };
        bar.inc(1);
        prediction
    });
    let predictions = predictions.collect();
    bar.finish_and_clear();
    predictions
}
