use crate::args::PredictArgs;
use crate::crew::Led;
use crate::judge::Judge;
use crate::say_replaced;
use crate::threads::on_threads;
use crate::{limits, load, method, progress, say, warnings};
use etendue_compare::{Applicability, Class, Prediction};
use etendue_scene::Scene;
use etendue_store::Failure;
use etendue_store::Method;
use etendue_store::PREDICTION;
use etendue_store::predictions;
use etendue_store::stored::Index;
use std::collections::BTreeMap;

/// `etendue predict`: returns the exit code.
pub(crate) fn predict(args: &PredictArgs) -> Result<u8, Failure> {
    predict_with(args, None)
}

/// The same, with other processes that predict as well.
pub(crate) fn predict_with(args: &PredictArgs, crew: Option<&Led<'_>>) -> Result<u8, Failure> {
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
        let predictions = predicted(&scene, &theories, method, crew, args.quiet)?;
        let content = predictions::write(&mut results, &scene, method, &predictions)?;
        Ok((results, content))
    })?;
    let finished = Index::new(&scene, content).finish(results)?;
    say_replaced(&finished, args.quiet);
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
    crew: Option<&Led<'_>>,
    quiet: bool,
) -> Result<Vec<Prediction>, Failure> {
    let is_referred = |theory: &Applicability| theory.class() == Class::Reference;
    let referred = theories.iter().enumerate();
    let referred = referred.filter(|(_, theory)| is_referred(theory));
    let referred: Vec<usize> = referred.map(|(i, _)| i).collect();
    let told = (0..)
        .zip(theories)
        .filter(|(_, theory)| !is_referred(theory));
    let told: Vec<u32> = told.map(|(i, _)| i).collect();
    let judges = Judge::all(scene, &referred, method, quiet)?;
    let bar = progress::steps("predicting", scene.planes.len(), "planes", quiet);
    let own = |plane: u32| {
        let at = &scene.planes[plane as usize];
        bar.set_message(at.name.clone());
        let prediction = Prediction::new(scene, at, &theories[plane as usize]);
        bar.inc(1);
        Ok(prediction)
    };
    let mut told: BTreeMap<u32, Prediction> = match crew {
        None => told
            .iter()
            .map(|i| Ok((*i, own(*i)?)))
            .collect::<Result<_, Failure>>()?,
        Some(crew) => crew.predict(scene, &told, &own, &|plane, bytes| {
            bar.inc(1);
            predictions::unpacked(&scene.planes[plane as usize], bytes)
        })?,
    };
    let planes = (0_u32..).zip(theories).map(|(number, theory)| {
        let i = number as usize;
        let Some((judge, at)) = Judge::of(&judges, i) else {
            let missing = || Failure::cannot_run("a plane was not predicted");
            return told.remove(&number).ok_or_else(missing);
        };
        bar.inc(1);
        let reference = Prediction::reference(scene, i, theory, &judge.measurement, at);
        let mut prediction = reference.map_err(Failure::cannot_run)?;
        prediction.steps.push(method::step(judge.method));
        Ok(prediction)
    });
    let planes = planes.collect();
    bar.finish_and_clear();
    planes
}
