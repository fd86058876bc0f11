//! Sizes and colors that all figures share, in SVG units (1/96 inch at natural size).

/// Units per inch.
pub(crate) const INCH: f64 = 96.0;
/// Minimum text size: 6 points.
pub(crate) const LEAST_TEXT: f64 = 8.0;
/// Text and frames.
pub(crate) const INK: &str = "#222222";
/// Secondary text.
pub(crate) const SOFT: &str = "#555555";
/// Leader lines.
pub(crate) const FAINT: &str = "#9a9a9a";
/// Lines of theory.
pub(crate) const THEORY_COLOR: &str = "#1f6fb4";
/// Line width of frames, ticks and axis lines.
pub(crate) const STROKE: f64 = 0.8;
/// Length of a tick.
pub(crate) const TICK: f64 = 4.0;

/// Font size of tick texts.
pub(crate) const TICK_TEXT: f64 = 11.0;
/// Font size of texts below narrow pictures.
pub(crate) const SMALL_TEXT: f64 = 9.5;
/// Font size of axis labels.
pub(crate) const LABEL_TEXT: f64 = 12.0;
/// Font size of panel headings.
pub(crate) const HEAD_TEXT: f64 = 12.5;
/// Font size of the title.
pub(crate) const TITLE_TEXT: f64 = 15.0;

/// Distance from the lower edge of a panel to the baseline of its tick texts.
pub(crate) const TICK_BASELINE: f64 = TICK + 13.0;
/// Distance from the lower edge of a panel to the baseline of its axis label.
pub(crate) const LABEL_BASELINE: f64 = TICK_BASELINE + 17.0;
