//! Keeps a list of files that are not yet part of a result. If the process is asked to stop, these
//! files are removed.

use std::fs;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant};

/// The unfinished files, and the locks on their folders. The list is global, because signals are
/// global.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// The message that an interrupted command prints if its batches are stored.
static KEPT: Mutex<Option<&str>> = Mutex::new(None);

/// The time for which a signal waits until files are made, moved or released. On a disk that does
/// not answer, these steps may never end.
const MAX_WAIT: Duration = Duration::from_secs(5);

/// Sets the message of a command that is interrupted from now on.
pub fn keeps(message: &'static str) {
    *KEPT.lock().unwrap_or_else(PoisonError::into_inner) = Some(message);
}

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes unfinished files, and registers the paths that are removed when the user asks to stop. A
/// first signal to stop takes effect only after these two steps.
pub fn begin<T, E>(paths: Vec<PathBuf>, make: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
    let mut unfinished = unfinished();
    let made = make()?;
    *unfinished = paths;
    Ok(made)
}

/// Releases the unfinished files and clears the register. A first signal to stop takes effect only
/// after these two steps.
pub fn ended(release: impl FnOnce()) {
    let mut unfinished = unfinished();
    release();
    unfinished.clear();
}

/// Calls `work`, which must be short. A first signal to stop takes effect only after this call.
pub fn undisturbed<T>(work: impl FnOnce() -> T) -> T {
    let _held = unfinished();
    work()
}

/// Locks the list, unless another thread holds it for longer than [`MAX_WAIT`].
fn unfinished_soon() -> Option<MutexGuard<'static, Vec<PathBuf>>> {
    let begun = Instant::now();
    while begun.elapsed() < MAX_WAIT {
        match UNFINISHED.try_lock() {
            Ok(unfinished) => return Some(unfinished),
            Err(TryLockError::Poisoned(error)) => return Some(error.into_inner()),
            Err(TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(1)),
        }
    }
    None
}

/// Removes the unfinished files, and calls `last` with the message for the user. After this call,
/// no other thread can make or release files, so the process must end in `last`. If another thread
/// has long been making or releasing files, they are left to the next command.
pub fn abandon(last: impl FnOnce(&'static str)) {
    let Some(unfinished) = unfinished_soon() else {
        return last("interrupted");
    };
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn a_signal_does_not_wait_for_work_that_never_ends() {
        let (begun, has_begun) = channel();
        let (end, ends) = channel::<()>();
        let stuck = std::thread::spawn(move || {
            undisturbed(|| {
                begun.send(()).unwrap();
                let _ = ends.recv();
            });
        });
        has_begun.recv().unwrap();
        let (told, wait) = channel();
        std::thread::spawn(move || abandon(|message| told.send(message).unwrap()));
        // The margin is for a busy machine.
        let message = wait.recv_timeout(MAX_WAIT + Duration::from_secs(20));
        assert_eq!(message, Ok("interrupted"));
        end.send(()).unwrap();
        stuck.join().unwrap();
    }
}
