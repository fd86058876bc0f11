//! What a run tells while it goes on.

/// Takes what a run tells while it goes on: a command prints it, a library may drop it. It is called from any thread.
pub trait Reporter: Sync {
    /// Says what happens next, or what was found.
    fn note(&self, text: &str);

    /// Says what the user should know before trusting the result.
    fn warn(&self, text: &str);

    /// Work begins.
    fn begin(&self, work: Work) -> Box<dyn Progress + '_>;
}

/// Work that takes a while.
#[derive(Clone, Copy, Debug)]
pub enum Work {
    /// So many photons to trace.
    Photons(u64),
    /// So many things, one after the other.
    Steps {
        /// What is done to them, such as "predicting".
        verb: &'static str,
        /// How many there are.
        total: usize,
        /// What they are, in the plural.
        things: &'static str,
    },
    /// Something whose length is not known beforehand.
    Stage(&'static str),
}

/// Work that goes on. It ends when this is dropped.
///
/// A program that is to stop may unwind from `advance` and from [`Reporter::begin`]: both are called often, and no result is half written
/// then.
pub trait Progress: Send + Sync {
    /// So many photons or things more are done; zero says only that work goes on.
    fn advance(&self, steps: u64);

    /// So many are done in all.
    fn set(&self, steps: u64);

    /// The thing at hand has this name.
    fn name(&self, step: &str);
}

/// Drops everything.
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
