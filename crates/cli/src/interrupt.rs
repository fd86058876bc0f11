//! Interrupts a run on signals and on lack of memory.
//!
//! On Unix, the first SIGINT, SIGTERM or SIGHUP removes the unfinished files of a result and ends
//! the process with exit code 3; a second signal ends the process at once. If an allocation fails,
//! Rust prints a message and aborts, and the exit code is also 3. If a file would exceed the
//! system's size limit, there is a write error, and the process is not killed.

#[cfg(unix)]
mod unix;

use etendue_store::Failure;

/// Installs the signal handlers. On systems other than Unix there are none: a signal ends the
/// process at once, and the next process removes the unfinished files.
pub(crate) fn install() -> Result<(), Failure> {
    #[cfg(unix)]
    unix::install()?;
    Ok(())
}
