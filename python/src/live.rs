//! Runs long work with progress reports to Python, which can stop the work.

use crate::raised::raised;
use etendue_pipeline::{Progress, Reporter, Work};
use etendue_spectrum::Watch;
use etendue_store::Failure;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Interval at which Python checks for Ctrl-C and reports progress.
const TICK: Duration = Duration::from_millis(50);

/// The time that stopped work has to remove its files. After this time, the caller continues even
/// if the work has not ended.
const GRACE: Duration = Duration::from_millis(500);

/// State that the working thread shares with the thread that waits for it.
#[derive(Default)]
pub(crate) struct Live {
    is_stopped: AtomicBool,
    works: Mutex<Works>,
}

/// The work in progress, and the last finished work.
#[derive(Default)]
struct Works {
    begun: u64,
    /// The nested works in progress. The innermost work is the last.
    in_hand: Vec<Arc<Counted>>,
    ended: Option<Arc<Counted>>,
}

/// The progress of some work.
struct Counted {
    number: u64,
    verb: &'static str,
    things: &'static str,
    total: u64,
    done: AtomicU64,
}

/// The payload that unwinds a thread that must stop.
struct Stopped;

impl Live {
    fn works(&self) -> MutexGuard<'_, Works> {
        self.works.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Unwinds the thread if the work must stop. The unwinding is not a panic, and prints nothing.
    fn check(&self) {
        if self.is_stopped.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Stopped));
        }
    }

    /// Begins work that traces `total` items, whose progress is reported.
    pub(crate) fn trace(&self, total: u64, things: &'static str) -> Tracing<'_> {
        let work = Work::Steps {
            verb: "tracing",
            total: usize::try_from(total).unwrap_or(usize::MAX),
            things,
        };
        Tracing {
            live: self,
            bar: self.begin(work),
        }
    }

    /// Reports the progress of the innermost work to `progress`. If no work is in progress, the
    /// last finished work is reported.
    fn report(&self, progress: &Bound<'_, PyAny>) -> PyResult<()> {
        let works = self.works();
        let counted = works.in_hand.last().or(works.ended.as_ref()).cloned();
        drop(works);
        let Some(counted) = counted else {
            return Ok(());
        };
        let Counted {
            number,
            verb,
            things,
            total,
            done,
        } = &*counted;
        let done = done.load(Ordering::Relaxed);
        progress
            .call1((number, verb, things, total, done))
            .map(drop)
    }
}

impl Reporter for Live {
    fn begin(&self, work: Work) -> Box<dyn Progress + '_> {
        self.check();
        let (verb, things, total) = match work {
            Work::Photons(total) => ("tracing", "photons", total),
            Work::Steps {
                verb,
                total,
                things,
            } => (verb, things, total as u64),
            // A stage has no number of items to count.
            Work::Stage(_) => return Box::new(Bar(self, None)),
        };
        let mut works = self.works();
        works.begun += 1;
        let counted = Arc::new(Counted {
            number: works.begun,
            verb,
            things,
            total,
            done: AtomicU64::new(0),
        });
        works.in_hand.push(Arc::clone(&counted));
        Box::new(Bar(self, Some(counted)))
    }
}

/// The progress of counted work, or of a stage without a count.
struct Bar<'a>(&'a Live, Option<Arc<Counted>>);

impl Progress for Bar<'_> {
    fn advance(&self, steps: u64) {
        if let Some(counted) = &self.1 {
            counted.done.fetch_add(steps, Ordering::Relaxed);
        }
        self.0.check();
    }

    fn set(&self, steps: u64) {
        if let Some(counted) = &self.1 {
            counted.done.store(steps, Ordering::Relaxed);
        }
    }
}

impl Drop for Bar<'_> {
    fn drop(&mut self) {
        if let Some(counted) = self.1.take() {
            let mut works = self.0.works();
            works.in_hand.retain(|other| !Arc::ptr_eq(other, &counted));
            works.ended = Some(counted);
        }
    }
}

/// Tracing of rays, batch by batch.
pub(crate) struct Tracing<'a> {
    live: &'a Live,
    bar: Box<dyn Progress + 'a>,
}

impl Watch for Tracing<'_> {
    fn traced(&self, photons: u64) {
        self.bar.advance(photons);
    }

    fn should_continue(&self, _batch: u32, _part: u32) -> bool {
        !self.live.is_stopped.load(Ordering::Relaxed)
    }
}

/// Runs work on the given number of threads, by default one for each core. Meanwhile other Python
/// threads continue, `progress` receives the progress, and Ctrl-C is detected. After Ctrl-C, the
/// work stops at the next block of photons or at the next step. After Ctrl-C, the function waits
/// until the work has ended, but only for a short time. If the work is not counted, the function
/// does not wait.
pub(crate) fn alive<T: Send + 'static>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Live) -> Result<T, Failure> + Send + 'static,
) -> PyResult<T> {
    let live = Arc::new(Live::default());
    let (tell, told) = channel();
    let of_thread = Arc::clone(&live);
    thread::spawn(move || {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
        let found = match pool.build() {
            Ok(pool) => pool.install(|| work(&of_thread)),
            Err(error) => Err(Failure::cannot_run(error)),
        };
        // Sending fails if the caller no longer waits, because the user has pressed Ctrl-C.
        let _ = tell.send(found);
    });
    let mut told = told;
    loop {
        let (found, back) = py.detach(move || (told.recv_timeout(TICK), told));
        told = back;
        let report = |progress: &Bound<'_, PyAny>| live.report(progress);
        match found {
            Ok(found) => {
                progress.map_or(Ok(()), report)?;
                return found.map_err(|failure| raised(py, failure));
            }
            Err(RecvTimeoutError::Timeout) => {
                let goes_on = py.check_signals();
                let goes_on = goes_on.and_then(|()| progress.map_or(Ok(()), report));
                if let Err(error) = goes_on {
                    live.is_stopped.store(true, Ordering::Relaxed);
                    if live.works().begun > 0 {
                        py.detach(move || drop(told.recv_timeout(GRACE)));
                    }
                    return Err(error);
                }
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err(
                    "a bug in Étendue ended the work: its message is on standard error",
                ));
            }
        }
    }
}
