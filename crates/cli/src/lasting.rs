//! A measurement that outlives its process: its batches are kept as they are done.

use crate::crew::Led;
use crate::failure::Failure;
use crate::job::Job;
use crate::method::{Method, source};
use crate::results::kept::Kept;
use crate::warnings::warn;
use crate::{interrupt, progress};
use etendue_scene::Scene;
use etendue_spectrum::{Batch, Measurement, Watch, measure_watched};
use indicatif::ProgressBar;
use std::hash::{BuildHasher, RandomState};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Batches done before this are not kept: they are soon made again.
const SHORT: Duration = Duration::from_secs(5);

/// How long a measurement may take, and whether others have a part in it.
#[derive(Clone, Copy)]
pub(crate) struct Lasting<'a> {
    /// Goes on from what is kept, and shares the work with others that do.
    pub(crate) resume: bool,
    /// When no more batches are begun.
    pub(crate) until: Option<Instant>,
    /// Other processes that measure as well.
    pub(crate) crew: Option<&'a Led<'a>>,
}

/// Measures all batches of a scene; `None` where another process that shares the work has ended it, which `is_done` tells. Where time is up
/// first, those that are done are kept, and that is said.
pub(crate) fn measured(
    scene: &Scene,
    method: Method,
    (kept, is_done): (&Kept, &(dyn Fn() -> bool + Sync)),
    lasting: Lasting<'_>,
    quiet: bool,
) -> Result<Option<Measurement>, Failure> {
    let source = source(scene, method)?;
    let emitted = |batch: u32| source.emitted(batch);
    let lit: Vec<u32> = (0..scene.run.batches).filter(|b| emitted(*b) > 0).collect();
    let bar = progress::photons(lit.iter().map(|b| emitted(*b)).sum(), quiet);
    let keeper = Keeper {
        kept,
        is_done,
        lasting,
        bar: &bar,
        begun: Instant::now(),
        is_late: AtomicBool::default(),
        is_full: AtomicBool::default(),
    };
    let mut all = Measurement::new(scene.planes.clone());
    if !lasting.resume {
        kept.remove();
    }
    loop {
        if lasting.resume {
            // Then the batches are gone.
            if is_done() {
                bar.finish_and_clear();
                return Ok(None);
            }
            for path in kept.read(&mut all, &emitted)? {
                let path = path.display();
                bar.suspend(|| warn(&format!("{path} is damaged: the batch is measured again")));
            }
            bar.set_position(all.emitted());
        }
        let mut missing: Vec<u32> = lit.iter().copied().filter(|b| !all.contains(*b)).collect();
        if missing.is_empty() {
            break;
        }
        if lasting.resume {
            // Processes that share the work begin at different batches.
            let begin = RandomState::new().hash_one(0) % missing.len() as u64;
            missing.rotate_left(usize::try_from(begin).unwrap_or(0));
        }
        let found = match lasting.crew {
            Some(crew) => {
                let job = Job::of(scene.clone(), method, Vec::new())?;
                crew.measure(&job, &*source, &missing, &keeper)?
            }
            None => measure_watched(&*source, &scene.planes, &missing, &keeper),
        };
        all = all.merge(found).map_err(Failure::cannot_run)?;
        if keeper.is_late.load(Ordering::Relaxed) {
            bar.finish_and_clear();
            let done = kept.count();
            return Err(Failure::cannot_run(format!(
                "time is up: {done} of {} batches are kept in {}; the same command with --resume goes on from them",
                lit.len(),
                kept.folder().display()
            )));
        }
    }
    bar.finish_and_clear();
    Ok(Some(all))
}

/// Keeps batches as they are done.
struct Keeper<'a> {
    kept: &'a Kept,
    is_done: &'a (dyn Fn() -> bool + Sync),
    lasting: Lasting<'a>,
    bar: &'a ProgressBar,
    begun: Instant,
    is_late: AtomicBool,
    /// Whether no more can be kept.
    is_full: AtomicBool,
}

impl Keeper<'_> {
    /// Writes a batch. Where that fails the run goes on without it.
    fn keep(&self, batch: &Batch) {
        if self.is_full.load(Ordering::Relaxed) {
            return;
        }
        if let Err(failure) = self.kept.write(batch) {
            if !self.is_full.swap(true, Ordering::Relaxed) {
                let message = failure.message;
                self.bar.suspend(|| {
                    warn(&format!("{message}: a run that ends early cannot go on"));
                });
            }
            return;
        }
        interrupt::keeps(
            "interrupted: the batches that are done are kept, and the same command with --resume goes on from them",
        );
    }
}

impl Watch for Keeper<'_> {
    fn traced(&self, photons: u64) {
        self.bar.inc(photons);
    }

    fn wants(&self, batch: u32) -> bool {
        if self
            .lasting
            .until
            .is_some_and(|until| Instant::now() >= until)
        {
            self.is_late.store(true, Ordering::Relaxed);
            return false;
        }
        !(self.lasting.resume && (self.kept.has(batch) || (self.is_done)()))
    }

    fn done(&self, batch: &Batch) {
        let Lasting {
            resume,
            until,
            crew,
        } = self.lasting;
        let is_eager = resume || until.is_some() || crew.is_some();
        if is_eager || self.begun.elapsed() > SHORT {
            self.keep(batch);
        }
    }
}
