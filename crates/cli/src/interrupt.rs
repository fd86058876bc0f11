//! How a run ends before its time.
//!
//! The first SIGINT, SIGTERM or SIGHUP removes the files that wait to become a result and ends the process
//! with exit code 3; a second one ends it at once, whatever it is doing. Where memory cannot be had, Rust says
//! so and aborts: that is exit code 3 too. A file that the system allows no further growth is an error of the
//! write, not the death of the process.

use crate::failure::{CANNOT_RUN, Failure};
use std::fs;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What waits to become a result, and the lock on its folder. Global as signals are.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// What to say at the end instead, where something is kept.
static KEPT: Mutex<Option<&str>> = Mutex::new(None);

/// From now on an interrupted command says this.
pub(crate) fn keeps(message: &'static str) {
    *KEPT.lock().unwrap_or_else(PoisonError::into_inner) = Some(message);
}

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes what waits to become a result, and names all that is to be removed when the user asks to stop. A first
/// signal waits for both.
pub(crate) fn begin<T, E>(
    paths: Vec<PathBuf>,
    make: impl FnOnce() -> Result<T, E>,
) -> Result<T, E> {
    let mut unfinished = unfinished();
    let made = make()?;
    *unfinished = paths;
    Ok(made)
}

/// Releases what waited; from now on nothing waits. A first signal waits for both.
pub(crate) fn ended(release: impl FnOnce()) {
    let mut unfinished = unfinished();
    release();
    unfinished.clear();
}

/// Does short work that a first signal waits for.
pub(crate) fn undisturbed<T>(work: impl FnOnce() -> T) -> T {
    let _held = unfinished();
    work()
}

/// Ends the process in good order.
#[cfg(unix)]
fn end() -> ! {
    use std::io::Write;
    use std::sync::mpsc;
    use std::time::Duration;
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
    // A reader that has gone, or that reads no more, must not keep the process.
    let (told, wait) = mpsc::channel();
    std::thread::spawn(move || {
        let _ = writeln!(std::io::stderr(), "\n{message}");
        let _ = told.send(());
    });
    let _ = wait.recv_timeout(Duration::from_secs(1));
    #[expect(clippy::exit, reason = "the user asked to stop")]
    std::process::exit(CANNOT_RUN.into());
}

/// Lets signals end the process as said above.
#[cfg(unix)]
pub(crate) fn install() -> Result<(), Failure> {
    use crate::machine;
    use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::flag::{register, register_conditional_shutdown};
    use signal_hook::iterator::Signals;
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;
    let install = || {
        let code = CANNOT_RUN.into();
        let asked = Arc::new(AtomicBool::new(false));
        let mut signals = vec![SIGINT, SIGTERM];
        // `nohup` has it ignored: so it stays.
        if !machine::ignores(SIGHUP) {
            signals.push(SIGHUP);
        }
        let mut each = Signals::new(&signals)?;
        for signal in signals {
            // In this order the first signal finds the flag down, and puts it up.
            register_conditional_shutdown(signal, code, Arc::clone(&asked))?;
            register(signal, Arc::clone(&asked))?;
        }
        register_conditional_shutdown(SIGABRT, code, Arc::new(AtomicBool::new(true)))?;
        register(SIGXFSZ, Arc::default())?;
        std::thread::Builder::new().spawn(move || {
            if each.forever().next().is_some() {
                end();
            }
        })
    };
    install().map(drop).map_err(Failure::cannot_run)
}

/// Elsewhere the system ends the process, and the next one removes what it left.
#[cfg(not(unix))]
pub(crate) fn install() -> Result<(), Failure> {
    Ok(())
}
