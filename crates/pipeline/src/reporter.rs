//! Progress reports of a run.

/// Receives the progress reports of a run: a command prints them, a library may ignore them. The
/// methods are called from any thread.
pub trait Reporter: Sync {
    /// Reports what happens next, or what was found.
    fn note(&self, text: &str);

    /// Reports a warning that the user should read before trusting the result.
    fn warn(&self, text: &str);

    /// Reports that work begins.
    fn begin(&self, work: Work) -> Box<dyn Progress + '_>;
}

/// Work that takes a while.
#[derive(Clone, Copy, Debug)]
pub enum Work {
    /// A number of photons to trace.
    Photons(u64),
    /// A number of items to process in turn.
    Steps {
        /// The activity, such as "predicting".
        verb: &'static str,
        /// Number of items.
        total: usize,
        /// Name of the items, in the plural.
        things: &'static str,
    },
    /// Work whose length is not known in advance.
    Stage(&'static str),
}

/// Work in progress. The work ends when this value is dropped.
///
/// A program that wants to stop may unwind from `advance` and from [`Reporter::begin`]: both are
/// called often, and never while a result is half written.
pub trait Progress: Send + Sync {
    /// Reports that this many further photons or items are done; zero only shows that work goes on.
    fn advance(&self, steps: u64);

    /// Reports the total number done.
    fn set(&self, steps: u64);

    /// Reports the name of the current item.
    fn name(&self, step: &str);
}

/// Ignores all reports.
#[derive(Clone, Copy, Debug)]
pub struct Silent;

impl Reporter for Silent {
    fn note(&self, _text: &str) {}

    fn warn(&self, _text: &str) {}

    fn begin(&self, _work: Work) -> Box<dyn Progress + '_> {
        Box::new(Self)
    }
}

impl Progress for Silent {
    fn advance(&self, _steps: u64) {}

    fn set(&self, _steps: u64) {}

    fn name(&self, _step: &str) {}
}
