//! Progress bars, which are shown only on a terminal.

use crate::print::say;
use crate::warnings;
use etendue_pipeline::{Progress, Reporter, Work};
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

/// A reporter that prints the messages of a run, and shows the run's progress.
#[derive(Debug)]
pub(crate) struct Terminal {
    quiet: bool,
    bars: MultiProgress,
}

impl Terminal {
    /// If `quiet` is set, only the warnings of a run are printed.
    pub(crate) fn new(quiet: bool) -> Self {
        let bars = MultiProgress::new();
        Self { quiet, bars }
    }
}

impl Reporter for Terminal {
    fn note(&self, text: &str) {
        if !self.quiet {
            self.bars.suspend(|| say(text));
        }
    }

    fn warn(&self, text: &str) {
        self.bars.suspend(|| warnings::warn(text));
    }

    fn begin(&self, work: Work) -> Box<dyn Progress + '_> {
        let quiet = self.quiet;
        let bar = match work {
            Work::Photons(total) => photons(total, quiet),
            Work::Steps {
                verb,
                total,
                things,
            } => steps(verb, total, things, quiet),
            Work::Stage(name) => stage(name, quiet),
        };
        Box::new(Bar(self.bars.add(bar)))
    }
}

/// A progress bar that disappears when the work it shows ends.
struct Bar(ProgressBar);

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

impl Progress for Bar {
    fn advance(&self, steps: u64) {
        self.0.inc(steps);
    }

    fn set(&self, steps: u64) {
        self.0.set_position(steps);
    }

    fn name(&self, step: &str) {
        self.0.set_message(step.to_owned());
    }
}

/// Returns a progress bar with the number of traced photons, their rate and the remaining time.
/// The bar is shown only on a terminal.
pub(crate) fn photons(total: u64, quiet: bool) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(total);
    let style = "tracing {bar:40} {human_pos} of {human_len} photons  {per_sec}  {eta} left";
    if let Ok(style) = ProgressStyle::with_template(style) {
        bar.set_style(style.with_key(
            "per_sec",
            |state: &indicatif::ProgressState, w: &mut dyn std::fmt::Write| {
                let _ = write!(w, "{:.2} M/s", state.per_sec() / 1e6);
            },
        ));
    }
    bar
}

/// Returns a progress bar with the number of finished steps, the name of the current step and the
/// remaining time. The bar is shown on a terminal if there are several steps.
pub(crate) fn steps(
    verb: &'static str,
    total: usize,
    things: &'static str,
    quiet: bool,
) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(total as u64).with_prefix(verb);
    let style = format!(
        "{{spinner}} {{prefix}} {{msg}}  {{bar:40}} {{pos}} of {{len}} {things}  {{eta}} left"
    );
    if let Ok(style) = ProgressStyle::with_template(&style) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(std::time::Duration::from_millis(100));
    bar
}

/// Returns the progress display of a stage whose length is not known beforehand.
pub(crate) fn stage(name: &'static str, quiet: bool) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new_spinner().with_message(name);
    bar.enable_steady_tick(std::time::Duration::from_millis(100));
    bar
}
