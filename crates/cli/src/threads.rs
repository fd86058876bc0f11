//! Sets the number of threads of a command.

use crate::args::ThreadArgs;
use etendue_store::Failure;

/// Runs `work` on the given number of threads, by default one for each core.
pub(crate) fn on_threads<T: Send>(
    threads: &ThreadArgs,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.count.unwrap_or(0).into())
        .build()
        .map_err(Failure::cannot_run)?;
    pool.install(work)
}
