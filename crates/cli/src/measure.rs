use crate::args::MeasureArgs;
use crate::batches::{self, Held};
use crate::failure::Failure;
use crate::method::{Method, source};
use crate::results::Results;
use crate::stored::{Index, MEASUREMENT};
use crate::table::grouped;
use crate::threads::{self, on_threads};
use crate::{limits, load, method, progress, say};
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use std::ops::Range;

/// `etendue measure`: returns the exit code.
pub(crate) fn measure(args: &MeasureArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene, |run| args.photons.set(run))?;
    method::check(&scene, args.photons.method)?;
    let all = 0..scene.run.batches;
    let batches = args.batches.clone().unwrap_or(all.clone());
    if batches.end > all.end {
        return Err(Failure::bad_input(format!(
            "--batches {}..{}: the scene has batches 0..{}",
            batches.start, batches.end, all.end
        )));
    }
    limits::check_memory(&scene, threads::count(args.threads.count))?;
    let mut results = Results::create(&args.out, MEASUREMENT)?;
    let method = args.photons.method;
    let held = on_threads(&args.threads, || {
        let measurement = measured(&scene, method, batches.clone(), args.quiet)?;
        results.begin()?;
        batches::write(&mut results, &measurement)?;
        load::copy_files(&mut results, &scene, &args.scene)?;
        Ok(Held {
            seed: scene.run.seed,
            method,
            photons: measurement.emitted(),
            batches,
        })
    })?;
    let index = Index::new(&scene, held.clone());
    let folder = index.finish(results)?;
    if !args.quiet {
        say(&format!(
            "{}: measured batches {}..{} of {}, {} photons, seed {}",
            scene.name,
            held.batches.start,
            held.batches.end,
            all.end,
            grouped(held.photons),
            held.seed
        ));
        say(&format!("measurement in {}", folder.display()));
    }
    Ok(0)
}

/// Measures some batches of a scene at all its planes.
pub(crate) fn measured(
    scene: &Scene,
    method: Method,
    batches: Range<u32>,
    quiet: bool,
) -> Result<Measurement, Failure> {
    let source = source(scene, method)?;
    let photons = batches.clone().map(|batch| source.emitted(batch)).sum();
    let bar = progress::photons(photons, quiet);
    let measurement = etendue_spectrum::measure(&*source, &scene.planes, batches, &|photons| {
        bar.inc(photons);
    });
    bar.finish_and_clear();
    Ok(measurement)
}
