//! Defines the settings by which a user changes the style of a figure.

use crate::color::Palette;
use crate::figure::Figure;
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
    /// Maximum page height in inches, within [`Style::HEIGHTS`]. Pictures become smaller, down to
    /// half of their size, until the page is no higher.
    pub height: f64,
    /// Lower end of the colors of spectra in decibels, below 0; `None` uses the figure's default.
    pub floor: Option<f64>,
    /// Colors of light fields and spectra.
    pub palette: Palette,
    /// The factor by which pictures are smaller than they would be on a page of any height.
    #[serde(skip, default = "unscaled")]
    pub(crate) scale: f64,
}

fn unscaled() -> f64 {
    1.0
}

impl Default for Style {
    /// Two journal columns.
    fn default() -> Self {
        Self {
            titles: true,
            scene: true,
            verdicts: true,
            width: Self::WIDTHS[1],
            height: TEXT_HEIGHT,
            floor: None,
            palette: Palette::Inferno,
            scale: unscaled(),
        }
    }
}

impl Style {
    /// Minimum and maximum page width in inches: one journal column, and two columns.
    pub const WIDTHS: [f64; 2] = [3.3, 7.0];

    /// Minimum and maximum page height in inches.
    pub const HEIGHTS: [f64; 2] = [3.0, 14.0];

    /// Draws a figure whose page is no higher than [`Self::height`], if pictures of half of their
    /// size are small enough.
    ///
    /// # Errors
    /// When `draw` fails.
    pub fn within_height<E>(&self, draw: impl Fn(&Self) -> Result<Figure, E>) -> Result<Figure, E> {
        let mut style = *self;
        loop {
            let figure = draw(&style)?;
            let over = figure.size()[1] / (INCH * self.height);
            if over <= 1.0 || style.scale <= MIN_SCALE {
                return Ok(figure);
            }
            // Texts keep their size, so pictures must shrink by more than the page.
            let next = style.scale * (1.0 - PICTURES * (over - 1.0));
            style.scale = next.min(STEP * style.scale).max(MIN_SCALE);
        }
    }

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

/// The height of the text of a page in inches: 655 points, as in publications of the ACM.
const TEXT_HEIGHT: f64 = 655.0 / 72.0;
/// The smallest factor of pictures, and the largest factor between two attempts.
const MIN_SCALE: f64 = 0.5;
const STEP: f64 = 0.97;
/// Pictures shrink by this multiple of the share by which a page is too high.
const PICTURES: f64 = 1.5;

/// Top margin of a page without a title.
const UNTITLED: f64 = 10.0;
