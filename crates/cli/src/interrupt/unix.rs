//! Handles the signals of Unix.

use crate::exit::code_of;
use etendue_store::{Failure, FailureKind, machine, unfinished};
use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::flag::{register, register_conditional_shutdown};
use signal_hook::iterator::Signals;
use std::io::Write;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, mpsc};
use std::time::Duration;

/// Removes unfinished files and ends the process.
fn end() {
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
        std::process::exit(code_of(FailureKind::CannotRun).into());
    });
}

/// Installs the signal handlers that `interrupt` describes.
pub(super) fn install() -> Result<(), Failure> {
    let install = || {
        let code = code_of(FailureKind::CannotRun).into();
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
