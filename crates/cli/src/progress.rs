//! Progress bars, which are shown only on a terminal.

use crate::print::{say, tell};
use crate::warnings;
use etendue_field::grouped;
use etendue_pipeline::{Progress, Reporter, Work};
use indicatif::{HumanDuration, MultiProgress, ProgressBar, ProgressStyle};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

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

    fn note_step(&self, text: &str, time: Duration) {
        self.note(&format!("{text} in about {}", HumanDuration(time)));
    }

    fn warn(&self, text: &str) {
        self.bars.suspend(|| warnings::warn(text));
    }

    fn begin(&self, work: Work) -> Box<dyn Progress + '_> {
        let quiet = self.quiet;
        let (bar, what) = match work {
            Work::Photons(total) => (
                photons(total, quiet),
                format!("tracing {} photons", grouped(total)),
            ),
            Work::Steps {
                verb,
                total,
                things,
            } => (
                steps(verb, total, things, quiet),
                format!("{verb} {total} {things}"),
            ),
            Work::Stage(name) => (stage(name, quiet), String::new()),
        };
        Box::new(Bar {
            terminal: self,
            bar: self.bars.add(bar),
            what,
            begun: OnceLock::new(),
            announced: OnceLock::new(),
        })
    }
}

/// A progress bar that disappears when the work it shows ends. Where work takes long, one line
/// announces the remaining time.
struct Bar<'a> {
    terminal: &'a Terminal,
    bar: ProgressBar,
    what: String,
    /// The time of the first progress, and the number of steps at this time. It is not 0 if the
    /// work was resumed.
    begun: OnceLock<(Instant, u64)>,
    announced: OnceLock<()>,
}

/// The time after which the remaining time is estimated, and the shortest time that is announced.
const KNOWN_AFTER: Duration = Duration::from_secs(2);
const LONG: Duration = Duration::from_secs(10);

impl Bar<'_> {
    fn announce(&self) {
        let done = self.bar.position();
        let (begun, before) = *self.begun.get_or_init(|| (Instant::now(), done));
        let elapsed = begun.elapsed();
        if self.terminal.quiet || self.announced.get().is_some() || elapsed < KNOWN_AFTER {
            return;
        }
        let total = self.bar.length().unwrap_or(done);
        let Some(left) = remaining(elapsed, [before, done, total]) else {
            return;
        };
        if self.announced.set(()).is_ok() && left >= LONG {
            let line = format!("{}: about {} left", self.what, HumanDuration(left));
            self.terminal.bars.suspend(|| tell(&line));
        }
    }
}

/// The time that the remaining steps take, if they take as long as those since the first
/// progress. `steps` are the steps at the first progress, now, and in all.
fn remaining(elapsed: Duration, [before, done, total]: [u64; 3]) -> Option<Duration> {
    let [since, left] = [done.checked_sub(before)?, total.checked_sub(done)?];
    Duration::try_from_secs_f64(elapsed.as_secs_f64() * left as f64 / since as f64).ok()
}

impl Drop for Bar<'_> {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bar<'_> {
    fn advance(&self, steps: u64) {
        self.bar.inc(steps);
        self.announce();
    }

    fn set(&self, steps: u64) {
        self.bar.set_position(steps);
        self.announce();
    }

    fn name(&self, step: &str) {
        self.bar.set_message(step.to_owned());
    }
}

/// A progress bar with the number of traced photons, their rate and the remaining time.
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

/// A progress bar with the number of finished steps, the name of the current step and the
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
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// The progress display of a stage whose length is not known beforehand.
pub(crate) fn stage(name: &'static str, quiet: bool) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new_spinner().with_message(name);
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

#[cfg(test)]
mod tests {
    use super::remaining;
    use std::time::Duration;

    /// The rate is that of the steps since the first progress, not of steps of an earlier run.
    #[test]
    fn the_remaining_time_follows_the_rate_of_this_run() {
        let seconds = Duration::from_secs;
        let elapsed = seconds(3);
        assert_eq!(remaining(elapsed, [0, 10, 40]), Some(seconds(9)));
        assert_eq!(remaining(elapsed, [60, 70, 100]), Some(seconds(9)));
        // Without progress, nothing is known.
        assert_eq!(remaining(elapsed, [60, 60, 100]), None);
    }
}
