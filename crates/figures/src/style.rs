//! What a user may choose of a figure.

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
