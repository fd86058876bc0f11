//! Defines the settings by which a user changes the style of a figure.

use crate::color::Palette;
use crate::sizes::INCH;
use crate::svg::Svg;
use serde::{Deserialize, Serialize};

/// Settings by which a user changes the style of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Style {
    /// Whether titles, and the notes below them, are drawn. Figures in papers have captions
    /// instead of titles.
    pub titles: bool,
    /// Whether the scene is drawn above the scene's planes.
    pub scene: bool,
    /// Whether verdicts are written below the planes.
    pub verdicts: bool,
    /// Maximum page width in inches, within [`Style::WIDTHS`]; the width determines the number of
    /// pictures side by side.
    pub width: f64,
    /// Lower end of the colors of spectra in decibels, below 0; `None` uses the figure's default.
    pub floor: Option<f64>,
    /// Colors of light fields and spectra.
    pub palette: Palette,
}

impl Default for Style {
    /// Two journal columns.
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
    /// Minimum and maximum page width in inches: one journal column, and two columns.
    pub const WIDTHS: [f64; 2] = [3.3, 7.0];

    /// The width of the page in SVG units.
    pub(crate) fn page(&self) -> f64 {
        INCH * self.width
    }

    /// Draws the title and the note, if titles are enabled; returns the lower edge of these
    /// texts.
    pub(crate) fn title(&self, svg: &mut Svg, x: f64, room: f64, title: &str, note: &str) -> f64 {
        if self.titles {
            svg.title(x, room, title, note)
        } else {
            UNTITLED
        }
    }
}

/// Top margin of a page without a title.
const UNTITLED: f64 = 10.0;
