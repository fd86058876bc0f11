use crate::args::PredictArgs;
use crate::failure::Failure;
use crate::measure::measured;
use crate::method::Method;
use crate::results::PREDICTION;
use crate::stored::Index;
use crate::threads::on_threads;
use crate::{limits, load, method, predictions, progress, say, warnings};
use etendue_compare::{Applicability, Class, Prediction};
use etendue_scene::Scene;

/// `etendue predict`: returns the exit code.
pub(crate) fn predict(args: &PredictArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene, |run| args.photons.set(run))?;
    let theories = Applicability::of_planes(&scene);
    method::check(&scene, &theories, args.photons.method)?;
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

/// Predicts all planes of a scene for a measurement by `method`; where theory has no word, the other method's
/// measurement takes its place.
pub(crate) fn predicted(
    scene: &Scene,
    theories: &[Applicability],
    method: Method,
    quiet: bool,
) -> Result<Vec<Prediction>, Failure> {
    let mut referred = scene.clone();
    let mut classes = theories.iter().map(Applicability::class);
    referred
        .planes
        .retain(|_| classes.next() == Some(Class::Reference));
    let reference = if referred.planes.is_empty() {
        None
    } else {
        let all = 0..scene.run.batches;
        Some(measured(&referred, method.other(), all, quiet)?)
    };
    let bar = progress::steps("predicting", scene.planes.len(), "planes", quiet);
    let mut at = 0..;
    let planes = scene.planes.iter().zip(theories).enumerate();
    let predictions = planes.map(|(i, (plane, theory))| {
        bar.set_message(plane.name.clone());
        let prediction = match (theory.class(), &reference) {
            (Class::Reference, Some(reference)) => {
                let at = at.next().unwrap_or_default();
                Prediction::reference(scene, i, theory, reference, at).map_err(Failure::cannot_run)
            }
            _ => Ok(Prediction::new(scene, plane, theory)),
        };
        bar.inc(1);
        prediction
    });
    let predictions = predictions.collect();
    bar.finish_and_clear();
    predictions
}
