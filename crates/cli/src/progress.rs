use indicatif::{ProgressBar, ProgressStyle};

/// Photons done, rate and time left, on a terminal; nothing elsewhere.
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

/// Things done, the one at hand by its name, and time left: on a terminal, where there are several.
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

/// A stage whose length is not known beforehand.
pub(crate) fn stage(name: &'static str, quiet: bool) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new_spinner().with_message(name);
    bar.enable_steady_tick(std::time::Duration::from_millis(100));
    bar
}
