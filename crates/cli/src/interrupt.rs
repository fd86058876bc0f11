//! Interrupts a run on signals and on lack of memory.
//!
//! The first SIGINT, SIGTERM or SIGHUP removes the unfinished files of a result and ends the
//! process with exit code 3; a second signal ends the process at once. If an allocation fails, Rust
//! prints a message and aborts, and the exit code is also 3. If a file would exceed the system's
//! size limit, there is a write error, and the process is not killed.

use etendue_store::{CANNOT_RUN, Failure, unfinished};

/// Removes unfinished files and ends the process.
#[cfg(unix)]
fn end() {
    use std::io::Write;
    use std::sync::mpsc;
    use std::time::Duration;
    unfinished::abandon(|message| {
        // A separate thread prints the message, so that the process does not block if standard
        // error is closed or full.
        let (told, wait) = mpsc::channel();
        std::thread::spawn(move || {
            let _ = writeln!(std::io::stderr(), "\n{message}");
            let _ = told.send(());
        });
        let _ = wait.recv_timeout(Duration::from_secs(1));
        #[expect(clippy::exit, reason = "the user asked the process to stop")]
        std::process::exit(CANNOT_RUN.into());
    });
}

/// Installs the signal handlers that this module describes.
#[cfg(unix)]
pub(crate) fn install() -> Result<(), Failure> {
    use etendue_store::machine;
    use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::flag::{register, register_conditional_shutdown};
    use signal_hook::iterator::Signals;
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;
    let install = || {
        let code = CANNOT_RUN.into();
        let asked = Arc::new(AtomicBool::new(false));
        let mut signals = vec![SIGINT, SIGTERM];
        // If `nohup` makes the process ignore SIGHUP, the process continues to ignore it.
        if !machine::ignores(SIGHUP) {
            signals.push(SIGHUP);
        }
        let mut each = Signals::new(&signals)?;
        for signal in signals {
            // The handlers run in this order. At the first signal, the flag is not set, so the
            // first handler does not end the process, and the second handler sets the flag.
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

/// On systems other than Unix a signal ends the process at once, and the next process removes the
/// unfinished files.
#[cfg(not(unix))]
pub(crate) fn install() -> Result<(), Failure> {
    Ok(())
}
