//! Implements `etendue measure`: measures batches of a scene for `etendue compare`.

use crate::args::MeasureArgs;
use crate::print::{say, say_replaced};
use crate::progress::Terminal;
use crate::threads::on_threads;
use crate::warnings;
use etendue_field::grouped;
use etendue_pipeline::{load, measured};
use etendue_store::batches::{self, Held};
use etendue_store::stored::Index;
use etendue_store::{Failure, MEASUREMENT};

/// Runs `etendue measure`; returns the exit code.
pub(crate) fn measure(args: &MeasureArgs) -> Result<u8, Failure> {
    let run = args.photons.run(&args.scene)?;
    let scene = &run.scene;
    let all = 0..scene.run.batches;
    let batches = args.batches.clone().unwrap_or(all.clone());
    if batches.end > all.end {
        return Err(Failure::bad_input(format!(
            "--batches {}..{}: the scene has batches 0..{}",
            batches.start, batches.end, all.end
        )));
    }
    let (results, held) = on_threads(&args.work.threads, || {
        warnings::tell(scene, args.work.quiet);
        run.check_memory()?;
        let files = batches::names(&scene.planes);
        let mut results = load::stage(
            &args.out.folder,
            MEASUREMENT,
            files,
            scene,
            &args.scene.source(),
            args.work.force.force,
        )?;
        let measurement = measured(
            scene,
            run.method,
            batches.clone(),
            &Terminal::new(args.work.quiet),
        )?;
        batches::write(&mut results, &measurement)?;
        let held = Held {
            seed: scene.run.seed,
            method: run.method,
            photons: measurement.emitted(),
            batches,
        };
        Ok((results, held))
    })?;
    let index = Index::new(scene, held.clone());
    let finished = index.finish(results)?;
    say_replaced(&finished, args.work.quiet);
    if !args.work.quiet {
        say(&format!(
            "{}: measured batches {}..{} of {}, {} photons, seed {}",
            scene.name,
            held.batches.start,
            held.batches.end,
            all.end,
            grouped(held.photons),
            held.seed
        ));
        say(&format!("measurement in {}", finished.folder.display()));
    }
    Ok(0)
}
