//! Defines how a run reports its progress.

use std::time::Duration;

/// A receiver of the progress reports of a run: a command prints the reports, and a library may
/// ignore them, as the default methods do. The methods of a reporter are called from any thread.
pub trait Reporter: Sync {
    /// Reports what the run will do next, or what it has found.
    fn note(&self, _text: &str) {}

    /// Reports the next step of a run with several steps, and about how long it takes.
    fn note_step(&self, _text: &str, _time: Duration) {}

    /// Reports a warning that the user should read before trusting the result.
    fn warn(&self, _text: &str) {}

    /// Reports that a piece of work begins.
    fn begin(&self, work: Work) -> Box<dyn Progress + '_>;
}

/// Work whose progress is shown.
#[derive(Clone, Copy, Debug)]
pub enum Work {
    /// A number of photons to trace.
    Photons(u64),
    /// A number of items to process in turn.
    Steps {
        /// The activity on the items, such as "predicting".
        verb: &'static str,
        /// Number of items.
        total: usize,
        /// Name of the items, in the plural.
        things: &'static str,
    },
    /// Work whose length is not known in advance.
    Stage(&'static str),
}

/// Work in progress, which ends when this value is dropped.
///
/// A program that wants to stop may unwind from `advance` and from [`Reporter::begin`]. Both are
/// called often, but not while a result is being written.
pub trait Progress: Send + Sync {
    /// Reports that `steps` further photons or items are done; the number zero only shows that
    /// the work continues.
    fn advance(&self, _steps: u64) {}

    /// Reports that a total of `steps` photons or items are done.
    fn set(&self, _steps: u64) {}

    /// Reports the name of the item that is being processed.
    fn name(&self, _step: &str) {}
}

/// Ignores all reports.
#[derive(Clone, Copy, Debug)]
pub struct Silent;

impl Reporter for Silent {
    fn begin(&self, _work: Work) -> Box<dyn Progress + '_> {
        Box::new(Self)
    }
}

impl Progress for Silent {}
