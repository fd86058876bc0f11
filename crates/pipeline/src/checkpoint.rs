//! Stores a measurement on disk, so that a later process can continue it. A batch is stored when it
//! is finished, and every few seconds until then.

use crate::method::source;
use crate::reporter::{Progress, Reporter, Work};
use crate::workers::{Leader, Packing};
use etendue_field::PhotonSource;
use etendue_scene::Scene;
use etendue_spectrum::{Batch, Measurement, PartialBatch, Watch, measure_watched};
use etendue_store::checkpoints::{BatchProgress, CheckpointStore};
use etendue_store::stored::summary_of;
use etendue_store::{Failure, Method, unfinished};
use std::collections::BTreeMap;
use std::hash::{BuildHasher, RandomState};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The minimum duration of a batch that is stored; a faster batch is not stored, because
/// measuring it again is quick.
const MIN_AGE: Duration = Duration::from_secs(5);
/// The interval at which an unfinished batch is stored.
const PARTIAL_INTERVAL: Duration = Duration::from_secs(2);

/// The result folder of a run, its time limit, and the other processes that take part.
#[derive(Clone, Copy, Debug)]
pub struct Checkpointing<'a> {
    /// The folder of the results, in which batches are stored.
    pub folder: &'a Path,
    /// Whether to continue from stored batches, and to share the work with all processes that
    /// continue from these batches.
    pub resume: bool,
    /// The time after which no further part of a batch is begun.
    pub until: Option<Instant>,
    /// The other processes that also measure batches.
    pub workers: Option<&'a Leader<'a>>,
}

/// Measures all batches of a scene. Returns `None` if another process that shares the work has
/// finished the run and written the result. If the time limit is reached before all batches are
/// finished, stores the finished batches and returns a failure with a message.
pub(crate) fn measured(
    scene: &Scene,
    method: Method,
    checkpointing: Checkpointing<'_>,
    reporter: &dyn Reporter,
) -> Result<Option<Measurement>, Failure> {
    let kept = &CheckpointStore::of(checkpointing.folder, scene, method);
    let is_done = &|| summary_of(checkpointing.folder, scene, method).is_some();
    let source = source(scene, method)?;
    let emitted = |batch: u32| source.emitted(batch);
    let lit: Vec<u32> = (0..scene.run.batches).filter(|b| emitted(*b) > 0).collect();
    let bar = reporter.begin(Work::Photons(lit.iter().map(|b| emitted(*b)).sum()));
    let keeper = Keeper {
        kept,
        is_done,
        checkpointing,
        bar: &*bar,
        reporter,
        begun: Instant::now(),
        partial: Mutex::default(),
        is_late: AtomicBool::default(),
        is_full: AtomicBool::default(),
    };
    let planes = method.recorded_planes(scene);
    let mut all = Measurement::new(planes.to_vec());
    // Batches of an earlier run must not be taken for those of this run.
    if !checkpointing.resume {
        kept.remove();
    }
    unfinished::keeps(
        "interrupted: no result was written, and the measurement was too short to be kept",
    );
    loop {
        // If another process has finished the run, this process has deleted the stored batches.
        if checkpointing.resume && is_done() {
            drop(bar);
            return Ok(None);
        }
        // Another process may have left batches unfinished, so what is missing is looked up again.
        let missing = keeper.missing(&mut all, &*source, &lit)?;
        if missing.is_empty() {
            break;
        }
        let (found, left) = match checkpointing.workers {
            Some(workers) => {
                let packing = Packing { scene, method };
                workers.measure(packing, &*source, missing, &keeper)?
            }
            None => measure_watched(&*source, &planes, &mut missing.into_iter(), &keeper),
        };
        all = all.merge(found).map_err(Failure::cannot_run)?;
        if keeper.is_late.load(Ordering::Relaxed) {
            left.iter()
                .try_for_each(|batch| kept.write_partial(batch))?;
            drop(bar);
            return Err(time_is_up(kept, lit.len()));
        }
    }
    drop(bar);
    Ok(Some(all))
}

/// The error of a run that exceeded its time limit; the error states which batches are
/// stored.
fn time_is_up(kept: &CheckpointStore, batches: usize) -> Failure {
    let [done, begun] = kept.count();
    let begun = match begun {
        0 => String::new(),
        begun => format!(" and parts of {begun} other batches"),
    };
    Failure::cannot_run(format!(
        "time is up: {done} of {batches} batches{begun} are kept in {}; the same command with --resume continues from them",
        kept.folder().display()
    ))
}

/// A watcher of a measurement that stores finished batches, and at intervals also unfinished
/// batches.
struct Keeper<'a> {
    kept: &'a CheckpointStore,
    is_done: &'a (dyn Fn() -> bool + Sync),
    checkpointing: Checkpointing<'a>,
    bar: &'a dyn Progress,
    reporter: &'a dyn Reporter,
    begun: Instant,
    /// The time at which each unfinished batch was last stored.
    partial: Mutex<BTreeMap<u32, Instant>>,
    is_late: AtomicBool,
    /// Whether storing a batch has failed; after a failure, no more batches are stored.
    is_full: AtomicBool,
}

impl Keeper<'_> {
    /// Reads the stored batches, if the run continues from stored batches. Returns the batches
    /// that remain to be measured, each with its finished parts.
    fn missing(
        &self,
        all: &mut Measurement,
        source: &dyn PhotonSource,
        lit: &[u32],
    ) -> Result<Vec<PartialBatch>, Failure> {
        let mut begun = BTreeMap::new();
        if self.checkpointing.resume {
            let damaged;
            (begun, damaged) = self.kept.read(all, &|batch| source.emitted(batch))?;
            for path in damaged {
                self.reporter.warn(&format!(
                    "{} is damaged: the batch is measured again",
                    path.display()
                ));
            }
            // The number of photons in the finished parts of a batch is approximate.
            let photons = begun.values().map(|batch| {
                let parts = u64::from(source.parts(batch.index));
                source.emitted(batch.index) / parts * u64::from(batch.parts)
            });
            self.bar.set(all.emitted() + photons.sum::<u64>());
        }
        let mut missing: Vec<PartialBatch> = lit
            .iter()
            .filter(|b| !all.contains(**b))
            .map(|b| begun.remove(b).unwrap_or_else(|| PartialBatch::new(*b)))
            .collect();
        if self.checkpointing.resume && !missing.is_empty() {
            // Processes that share the work begin at different batches.
            let begin = RandomState::new().hash_one(0) % missing.len() as u64;
            missing.rotate_left(usize::try_from(begin).unwrap_or(0));
        }
        Ok(missing)
    }

    /// Checks whether the run has lasted long enough for batches to be worth storing.
    fn keeps(&self) -> bool {
        let Checkpointing {
            resume,
            until,
            workers,
            ..
        } = self.checkpointing;
        let is_eager = resume || until.is_some() || workers.is_some();
        is_eager || self.begun.elapsed() > MIN_AGE
    }

    /// Calls `write` to store a batch. If storing a batch fails, the run continues without the
    /// stored batch.
    fn keep(&self, write: impl FnOnce() -> Result<(), Failure>) {
        if self.is_full.load(Ordering::Relaxed) {
            return;
        }
        if let Err(failure) = write() {
            if !self.is_full.swap(true, Ordering::Relaxed) {
                let message = failure.message;
                self.reporter.warn(&format!(
                    "{message}: a run that ends early cannot be resumed"
                ));
            }
            return;
        }
        unfinished::keeps(
            "interrupted: the measurement is kept, except for the last few seconds; the same command with --resume continues it",
        );
    }

    /// Checks whether an unfinished batch has not been stored for a while; if so, marks the batch
    /// as stored now.
    fn is_due(&self, batch: u32) -> bool {
        let mut partial = self.partial.lock().unwrap_or_else(PoisonError::into_inner);
        let last = partial.entry(batch).or_insert(self.begun);
        let is_due = last.elapsed() > PARTIAL_INTERVAL;
        if is_due {
            *last = Instant::now();
        }
        is_due
    }
}

impl Watch for Keeper<'_> {
    fn traced(&self, photons: u64) {
        self.bar.advance(photons);
    }

    fn should_continue(&self, batch: u32, part: u32) -> bool {
        let until = self.checkpointing.until;
        if until.is_some_and(|until| Instant::now() >= until) {
            self.is_late.store(true, Ordering::Relaxed);
            return false;
        }
        if !self.checkpointing.resume {
            return true;
        }
        // If another process has done more parts of a batch, the batch is left to that process.
        !(self.is_done)()
            && match self.kept.progress(batch) {
                None => true,
                Some(BatchProgress::Parts(parts)) => parts <= part,
                Some(BatchProgress::Done) => false,
            }
    }

    fn begun(&self, batch: &PartialBatch) {
        if self.keeps() && self.is_due(batch.index) {
            self.keep(|| self.kept.write_partial(batch));
        }
    }

    fn done(&self, batch: &Batch) {
        if self.keeps() {
            self.keep(|| self.kept.write(batch));
        }
    }
}
