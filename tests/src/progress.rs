//! Display of the progress of long work. If the output is a terminal, it shows a bar; otherwise a
//! line is written after each twentieth of the work.

use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use std::time::Duration;

/// Number of progress lines where there is no terminal.
const LINES: u64 = 20;

/// The progress of work on a known number of items.
#[derive(Clone)]
pub(crate) struct CountedProgress {
    bar: ProgressBar,
    things: &'static str,
}

/// Begins work on `count` items.
pub(crate) fn progress(count: u64, things: &'static str) -> CountedProgress {
    let bar = ProgressBar::new(count);
    let style = format!("{{bar:40}} {{human_pos}} of {{human_len}} {things}  {{eta}} left");
    if let Ok(style) = ProgressStyle::with_template(&style) {
        bar.set_style(style);
    }
    CountedProgress { bar, things }
}

/// The results of work on some items, in order, computed in parallel. A bar counts the
/// items.
pub(crate) fn in_parallel<N: Send, T: Send>(
    items: impl IntoIterator<Item = N>,
    things: &'static str,
    of: impl Fn(N) -> T + Sync,
) -> Vec<T> {
    let items: Vec<N> = items.into_iter().collect();
    let bar = progress(items.len() as u64, things);
    let found = items.into_par_iter().map(&of).inspect(|_| bar.one());
    let found = found.collect();
    bar.end();
    found
}

impl CountedProgress {
    /// Counts one finished item.
    #[expect(clippy::print_stderr, reason = "the report goes to standard output")]
    pub(crate) fn one(&self) {
        self.bar.inc(1);
        if !self.bar.is_hidden() {
            return;
        }
        let (done, count) = (self.bar.position(), self.bar.length().unwrap_or(0));
        let lines = |done: u64| done * LINES / count.max(1);
        if lines(done) > lines(done - 1) {
            let left = self.bar.elapsed().as_secs_f64() * (count - done) as f64 / done as f64;
            let left = indicatif::HumanDuration(Duration::from_secs_f64(left));
            eprintln!("{done} of {count} {}, {left:#} left", self.things);
        }
    }

    /// Hides the bar while `tell` writes to the terminal.
    pub(crate) fn suspend(&self, tell: impl FnOnce()) {
        self.bar.suspend(tell);
    }

    /// Ends the progress display.
    pub(crate) fn end(&self) {
        self.bar.finish_and_clear();
    }
}
