//! Long work that Python can follow and stop.

use crate::raised::raised;
use etendue_spectrum::Watch;
use etendue_store::Failure;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// How long Python waits before it looks for Ctrl-C, and tells progress.
const TICK: Duration = Duration::from_millis(50);

/// What the thread that works and the one that waits tell each other.
#[derive(Default)]
pub(crate) struct Live {
    photons: AtomicU64,
    is_stopped: AtomicBool,
}

/// What unwinds a thread that is to stop.
struct Stopped;

impl Watch for Live {
    fn traced(&self, photons: u64) {
        self.photons.fetch_add(photons, Ordering::Relaxed);
        if self.is_stopped.load(Ordering::Relaxed) {
            // A block of photons takes a millisecond and a part of a batch a second: it ends in the midst of it. This is no panic, and
            // prints nothing.
            resume_unwind(Box::new(Stopped));
        }
    }

    fn goes_on(&self, _batch: u32, _part: u32) -> bool {
        !self.is_stopped.load(Ordering::Relaxed)
    }
}

/// Does work on so many threads, one for each core unless said. Meanwhile other threads of Python go on, `progress` is told the photons
/// that are traced, and Ctrl-C is seen: then this returns at once, and the work ends at the next block of photons, or by itself.
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
        // Nobody listens where Ctrl-C came.
        let _ = tell.send(found);
    });
    let mut told = told;
    loop {
        let (found, back) = py.detach(move || (told.recv_timeout(TICK), told));
        told = back;
        let report = |progress: &Bound<'_, PyAny>| {
            let photons = live.photons.load(Ordering::Relaxed);
            progress.call1((photons,)).map(drop)
        };
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
                    return Err(error);
                }
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err(
                    "a fault of Étendue ended the work: what it said is on standard error",
                ));
            }
        }
    }
}
