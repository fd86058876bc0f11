use crate::args::ThreadArgs;
use crate::failure::{CANNOT_RUN, Failure};
use std::num::NonZero;
use std::thread::available_parallelism;

/// How many threads that is.
pub(crate) fn count(threads: Option<u16>) -> usize {
    let cores = || available_parallelism().map_or(1, NonZero::get);
    threads.map_or_else(cores, usize::from)
}

/// Does `work` on so many threads, one for each core unless said, and lets the user interrupt it.
pub(crate) fn on_threads<T: Send>(
    threads: &ThreadArgs,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    ctrlc::set_handler(interrupted).map_err(Failure::cannot_run)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.count.unwrap_or(0).into())
        .build()
        .map_err(Failure::cannot_run)?;
    pool.install(work)
}

/// Ends the process wherever it is: files are renamed into place whole, and the one that would make the
/// folder a result comes last.
#[expect(clippy::print_stderr, clippy::exit, reason = "the user asked to stop")]
fn interrupted() {
    eprintln!("\ninterrupted: no result was written");
    std::process::exit(i32::from(CANNOT_RUN));
}
