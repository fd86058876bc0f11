//! How a run ends before its time.
//!
//! The first SIGINT, SIGTERM or SIGHUP removes the files that wait to become a result and ends the process
//! with exit code 3; a second one ends it at once, whatever it is doing. Where memory cannot be had, Rust says
//! so and aborts: that is exit code 3 too. A file that the system allows no further growth is an error of the
//! write, not the death of the process.

use etendue_store::{CANNOT_RUN, Failure, unfinished};

/// Ends the process in good order.
#[cfg(unix)]
fn end() {
    use std::io::Write;
    use std::sync::mpsc;
    use std::time::Duration;
    unfinished::abandon(|message| {
        // A reader that has gone, or that reads no more, must not keep the process.
        let (told, wait) = mpsc::channel();
        std::thread::spawn(move || {
            let _ = writeln!(std::io::stderr(), "\n{message}");
            let _ = told.send(());
        });
        let _ = wait.recv_timeout(Duration::from_secs(1));
        #[expect(clippy::exit, reason = "the user asked to stop")]
        std::process::exit(CANNOT_RUN.into());
    });
}

/// Lets signals end the process as said above.
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
