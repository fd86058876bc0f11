//! Files that wait to become a result, and what becomes of them when the process is asked to stop.

use std::fs;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What waits to become a result, and the lock on its folder. Global as signals are.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// What to say at the end instead, where batches are kept.
static KEPT: Mutex<Option<&str>> = Mutex::new(None);

/// From now on an interrupted command says this.
pub fn keeps(message: &'static str) {
    *KEPT.lock().unwrap_or_else(PoisonError::into_inner) = Some(message);
}

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes what waits to become a result, and names all that is to be removed when the user asks to stop. A first
/// signal waits for both.
pub fn begin<T, E>(paths: Vec<PathBuf>, make: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
    let mut unfinished = unfinished();
    let made = make()?;
    *unfinished = paths;
    Ok(made)
}

/// Releases what waited; from now on nothing waits. A first signal waits for both.
pub fn ended(release: impl FnOnce()) {
    let mut unfinished = unfinished();
    release();
    unfinished.clear();
}

/// Does short work that a first signal waits for.
pub fn undisturbed<T>(work: impl FnOnce() -> T) -> T {
    let _held = unfinished();
    work()
}

/// Removes what waits, and does `last` with the words for the user. Nothing begins or ends meanwhile: the process is to
/// end in `last`.
pub fn abandon(last: impl FnOnce(&'static str)) {
    let unfinished = unfinished();
    let kept = *KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    let message = if let Some(kept) = kept {
        kept
    } else if unfinished.first().is_some_and(|first| first.exists()) {
        "interrupted: no result was written"
    } else {
        "interrupted"
    };
    for path in unfinished.iter() {
        let _ = fs::remove_dir_all(path).or_else(|_| fs::remove_file(path));
    }
    last(message);
}
