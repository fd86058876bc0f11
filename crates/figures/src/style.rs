//! What a user may choose of a figure, and sizes and colors shared by all, in SVG units (1/96 inch at natural size).

use crate::color::Palette;
use crate::svg::Svg;
use serde::{Deserialize, Serialize};

/// How figures look, where a user may want it otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Style {
    /// Whether titles, and the notes below them, are drawn. A paper has captions instead.
    pub titles: bool,
    /// Whether the scene is drawn above its planes.
    pub scene: bool,
    /// Whether verdicts stand below their planes.
    pub verdicts: bool,
    /// Largest width of the page, inches, [`Style::WIDTHS`]; as many pictures stand side by side as fit.
    pub width: f64,
    /// Lower end of the colors of spectra, in decibels, below 0; `None`: that of the figure.
    pub floor: Option<f64>,
    /// Colors of light fields and spectra.
    pub palette: Palette,
}

impl Default for Style {
    /// Two columns of a journal.
    fn default() -> Self {
        Self {
            titles: true,
            scene: true,
            verdicts: true,
            width: Self::WIDTHS[1],
            floor: None,
            palette: Palette::Inferno,
        }
    }
}

impl Style {
    /// The least and the largest width of a page, inches: one column of a journal, and two.
    pub const WIDTHS: [f64; 2] = [3.3, 7.0];

    /// Width of the page.
    pub(crate) fn page(&self) -> f64 {
        INCH * self.width
    }

    /// Draws title and note, if they are wanted; returns the lower edge.
    pub(crate) fn title(&self, svg: &mut Svg, x: f64, room: f64, title: &str, note: &str) -> f64 {
        if self.titles {
            svg.title(x, room, title, note)
        } else {
            UNTITLED
        }
    }
}

const INCH: f64 = 96.0;
/// From the upper edge of a page without a title to what is below it.
const UNTITLED: f64 = 10.0;
/// No text is smaller: 6 points.
pub(crate) const LEAST_TEXT: f64 = 8.0;
/// Text and frames.
pub(crate) const INK: &str = "#222222";
/// Secondary text.
pub(crate) const SOFT: &str = "#555555";
/// Leader lines.
pub(crate) const FAINT: &str = "#9a9a9a";
/// Lines of theory.
pub(crate) const THEORY_COLOR: &str = "#1f6fb4";
/// Frames, ticks and axis lines.
pub(crate) const STROKE: f64 = 0.8;
/// Length of a tick.
pub(crate) const TICK: f64 = 4.0;

/// Font size of tick texts.
pub(crate) const TICK_TEXT: f64 = 11.0;
/// Font size of axis labels.
pub(crate) const LABEL_TEXT: f64 = 12.0;
/// Font size of panel headings.
pub(crate) const HEAD_TEXT: f64 = 12.5;
/// Font size of the title.
pub(crate) const TITLE_TEXT: f64 = 15.0;

/// From the lower edge of a panel to the baseline of its tick texts.
pub(crate) const TICK_BASELINE: f64 = TICK + 13.0;
/// From the lower edge of a panel to the baseline of its axis label.
pub(crate) const LABEL_BASELINE: f64 = TICK_BASELINE + 17.0;
