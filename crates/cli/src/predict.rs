//! Implements `etendue predict`: predicts a scene for `etendue compare`.

use crate::args::PredictArgs;
use crate::print::{say, say_replaced};
use crate::progress::Terminal;
use crate::threads::on_threads;
use crate::warnings;
use etendue_pipeline::{Leader, load};
use etendue_store::stored::Index;
use etendue_store::{Failure, PREDICTION, predictions, theory};

/// Runs `etendue predict`; returns the exit code.
pub(crate) fn predict(args: &PredictArgs) -> Result<u8, Failure> {
    predict_with(args, None)
}

/// Runs [`predict()`], and shares the work with other processes.
pub(crate) fn predict_with(
    args: &PredictArgs,
    workers: Option<&Leader<'_>>,
) -> Result<u8, Failure> {
    let run = args.photons.run(&args.scene)?;
    let scene = &run.scene;
    let (results, content) = on_threads(&args.work.threads, || {
        warnings::tell(scene, args.work.quiet);
        run.check_limits()?;
        let mut files = predictions::names(&scene.planes);
        files.extend(args.npz.then(|| theory::FILE.to_owned()));
        let mut results = load::stage(
            &args.out.folder,
            PREDICTION,
            files,
            scene,
            &args.scene.source(),
            args.work.force.force,
        )?;
        let predictions = run.predictions(workers, &Terminal::new(args.work.quiet))?;
        let content = predictions::write(&mut results, scene, run.method, &predictions)?;
        if args.npz {
            results.write(theory::FILE, &theory::bytes(&scene.planes, &predictions)?)?;
        }
        Ok((results, content))
    })?;
    let finished = Index::new(scene, content).finish(results)?;
    say_replaced(&finished, args.work.quiet);
    if !args.work.quiet {
        let planes = scene.planes.len();
        say(&format!("{}: predicted {planes} planes", scene.name));
        say(&format!("prediction in {}", finished.folder.display()));
    }
    Ok(0)
}
