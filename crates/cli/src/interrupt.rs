//! Interruption of a run by signals and lack of memory.
//!
//! The first SIGINT, SIGTERM or SIGHUP removes the unfinished files of a result and ends the
//! process with exit code 3; a second one ends the process at once. If an allocation fails, Rust
//! prints a message and aborts; the exit code is 3 in this case too. Writing a file beyond the
//! system's size limit is a write error and does not kill the process.

use etendue_store::{CANNOT_RUN, Failure, unfinished};

/// Removes unfinished files and ends the process.
#[cfg(unix)]
fn end() {
    use std::io::Write;
    use std::sync::mpsc;
    use std::time::Duration;
    unfinished::abandon(|message| {
        // The thread prevents a standard error that is closed, or that nobody reads, from blocking
        // the process.
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

/// Installs the signal handlers described above.
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
        // `nohup` makes the process ignore SIGHUP, and the process keeps ignoring it.
        if !machine::ignores(SIGHUP) {
            signals.push(SIGHUP);
        }
        let mut each = Signals::new(&signals)?;
        for signal in signals {
            // In this order, the first signal does not end the process, because it finds the flag
            // clear and then sets it.
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
/// files that it left.
#[cfg(not(unix))]
pub(crate) fn install() -> Result<(), Failure> {
    Ok(())
}
