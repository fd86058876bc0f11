//! Implements `etendue measure`: measures batches of a scene for `etendue compare`.

use crate::args::{MeasureArgs, WorkArgs};
use crate::print::{say, say_replaced};
use crate::progress::Terminal;
use crate::threads::on_threads;
use crate::warnings;
use etendue_field::grouped;
use etendue_pipeline::load::SceneSource;
use etendue_pipeline::{Run, load, measured};
use etendue_spectrum::Measurement;
use etendue_store::batches::{self, Held};
use etendue_store::stored::Index;
use etendue_store::{Failure, MEASUREMENT};
use std::ops::Range;
use std::path::Path;

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
    let stage = MeasureStage {
        run: &run,
        source: &args.scene.source(),
        out: &args.out.folder,
        batches: batches.clone(),
        work: &args.work,
    };
    let photons = stage.write()?.emitted();
    if !args.work.quiet {
        say(&format!(
            "{}: measured batches {}..{} of {}, {} photons, seed {}",
            scene.name,
            batches.start,
            batches.end,
            all.end,
            grouped(photons),
            scene.run.seed
        ));
        say(&format!("measurement in {}", args.out.folder.display()));
    }
    Ok(0)
}

/// What `etendue measure` measures, and the folder that it writes.
pub(crate) struct MeasureStage<'a> {
    pub(crate) run: &'a Run,
    pub(crate) source: &'a SceneSource,
    pub(crate) out: &'a Path,
    pub(crate) batches: Range<u32>,
    pub(crate) work: &'a WorkArgs,
}

impl MeasureStage<'_> {
    /// Measures the batches, and writes the folder.
    pub(crate) fn write(&self) -> Result<Measurement, Failure> {
        let Run { scene, method, .. } = self.run;
        let (results, measurement) = on_threads(&self.work.threads, || {
            warnings::tell(scene, self.work.quiet);
            self.run.check_memory()?;
            let files = batches::names(&scene.planes);
            let force = self.work.force.force;
            let mut results = load::stage(self.out, MEASUREMENT, files, scene, self.source, force)?;
            let terminal = Terminal::new(self.work.quiet);
            let measurement = measured(scene, *method, self.batches.clone(), &terminal)?;
            batches::write(&mut results, &measurement)?;
            Ok((results, measurement))
        })?;
        let held = Held {
            seed: scene.run.seed,
            method: *method,
            photons: measurement.emitted(),
            batches: self.batches.clone(),
        };
        let finished = Index::new(scene, held).finish(results)?;
        say_replaced(&finished, self.work.quiet);
        Ok(measurement)
    }
}
