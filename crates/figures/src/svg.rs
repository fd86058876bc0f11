//! Writes SVG elements. Figures consist of only a few kinds of these elements.

use crate::sizes::{INK, SOFT, STROKE, TICK_TEXT, TITLE_TEXT};
use crate::text::{escape, fit, lines, plain, spans};
use std::fmt::Write;

/// An axis-aligned rectangle in SVG units, with y increasing downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Area {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Area {
    /// The rectangle with this upper left corner and this width and height.
    pub(crate) fn new([x, y]: [f64; 2], [width, height]: [f64; 2]) -> Self {
        Self {
            x,
            y,
            width,
            height,
        }
    }

    pub(crate) fn right(&self) -> f64 {
        self.x + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.y + self.height
    }

    pub(crate) fn middle(&self) -> [f64; 2] {
        [self.x + 0.5 * self.width, self.y + 0.5 * self.height]
    }
}

/// The anchor of a text.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// Position and style of a text; the position is on the baseline.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TextStyle {
    at: [f64; 2],
    size: f64,
    anchor: Anchor,
    bold: bool,
    fill: &'static str,
    upwards: bool,
}

impl TextStyle {
    pub(crate) fn new(at: [f64; 2], size: f64, anchor: Anchor) -> Self {
        Self {
            at,
            size,
            anchor,
            bold: false,
            fill: INK,
            upwards: false,
        }
    }

    /// The style at another position.
    pub(crate) fn at(self, at: [f64; 2]) -> Self {
        Self { at, ..self }
    }

    /// The style in the largest size, up to its own, in which each text is no wider than its room;
    /// texts beside each other then have one size.
    pub(crate) fn fitting<'a>(self, texts: impl Iterator<Item = (&'a str, f64)>) -> Self {
        let sizes = texts.map(|(text, room)| fit(&plain(text), self.size, self.room(room)).1);
        let size = sizes.fold(self.size, f64::min);
        Self { size, ..self }
    }

    /// The room for regular letters in a room for letters of this style: bold letters are up to
    /// 15 % wider than the estimate for regular ones.
    fn room(&self, room: f64) -> f64 {
        if self.bold { room / 1.15 } else { room }
    }

    pub(crate) fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    pub(crate) fn fill(self, fill: &'static str) -> Self {
        Self { fill, ..self }
    }

    /// The style for text that runs upwards.
    pub(crate) fn upwards(self) -> Self {
        Self {
            upwards: true,
            ..self
        }
    }
}

/// The style of a line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stroke {
    pub(crate) color: &'static str,
    pub(crate) width: f64,
    /// Dash pattern; empty for a solid line.
    pub(crate) dash: &'static str,
}

impl Stroke {
    /// The line style of frames and axes.
    pub(crate) const FRAME: Self = Self::solid(INK, STROKE);

    /// A solid line.
    pub(crate) const fn solid(color: &'static str, width: f64) -> Self {
        Self {
            color,
            width,
            dash: "",
        }
    }

    fn attributes(&self) -> String {
        let mut text = format!(" stroke=\"{}\" stroke-width=\"{}\"", self.color, self.width);
        if !self.dash.is_empty() {
            text += &format!(" stroke-dasharray=\"{}\"", self.dash);
        }
        text
    }
}

/// A drawing in progress.
#[derive(Debug, Default)]
pub(crate) struct Svg {
    body: String,
}

impl Svg {
    /// Adds an SVG element verbatim.
    pub(crate) fn raw(&mut self, element: &str) {
        self.body.push_str(element);
        self.body.push('\n');
    }

    pub(crate) fn line(&mut self, from: [f64; 2], to: [f64; 2], stroke: Stroke) {
        self.polyline(&[from, to], stroke);
    }

    pub(crate) fn polyline(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        let data = if points.iter().copied().all(is_near) {
            path(points)
        } else {
            let pieces = points.windows(2).filter_map(|ends| near(ends[0], ends[1]));
            pieces.map(|piece| path(&piece)).collect()
        };
        self.raw(&format!(
            "<path d=\"{data}\" fill=\"none\"{}/>",
            stroke.attributes()
        ));
    }

    /// Draws a filled polygon; `fill` is a color or a paint server.
    pub(crate) fn polygon(&mut self, points: &[[f64; 2]], fill: &str) {
        let near = points
            .iter()
            .map(|point| point.map(|at| at.clamp(-MAX_COORDINATE, MAX_COORDINATE)));
        let points = &near.collect::<Vec<_>>();
        self.raw(&format!("<path d=\"{}Z\" fill=\"{fill}\"/>", path(points)));
    }

    pub(crate) fn frame(&mut self, area: Area) {
        self.raw(&format!(
            "<rect{} fill=\"none\"{}/>",
            place(area),
            Stroke::FRAME.attributes()
        ));
    }

    pub(crate) fn fill(&mut self, area: Area, fill: &str) {
        self.raw(&format!("<rect{} fill=\"{fill}\"/>", place(area)));
    }

    pub(crate) fn circle(&mut self, center: [f64; 2], radius: f64, fill: &str) {
        let [x, y] = center.map(|at| at.clamp(-MAX_COORDINATE, MAX_COORDINATE));
        self.raw(&format!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{fill}\"/>",
            number(x),
            number(y),
            number(radius)
        ));
    }

    /// Draws an image stretched over `area`, without smoothing between pixels.
    pub(crate) fn image(&mut self, area: Area, href: &str) {
        self.raw(&format!(
            "<image{} preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" href=\"{href}\"/>",
            place(area)
        ));
    }

    /// Text shown verbatim.
    pub(crate) fn text(&mut self, style: TextStyle, text: &str) {
        self.write(style, &escape(text));
    }

    /// Text with markup.
    pub(crate) fn markup(&mut self, style: TextStyle, markup: &str) {
        self.write(style, &spans(markup, style.size));
    }

    /// Writes text with markup so that its width is at most `room`. If necessary, the font size
    /// of the text is reduced. If the text is still too wide at the smallest font size, it is
    /// shortened and written without italics and scripts.
    pub(crate) fn fitted(&mut self, style: TextStyle, markup: &str, room: f64) {
        let plain = plain(markup);
        let (text, size) = fit(&plain, style.size, style.room(room));
        let style = TextStyle { size, ..style };
        if text == plain {
            self.markup(style, markup);
        } else {
            self.text(style, &text);
        }
    }

    fn write(&mut self, style: TextStyle, content: &str) {
        if content.is_empty() {
            return;
        }
        let [x, y] = style.at.map(number);
        let mut attributes = format!(
            " x=\"{x}\" y=\"{y}\" font-size=\"{}\" fill=\"{}\"",
            number(style.size),
            style.fill
        );
        match style.anchor {
            Anchor::Start => {}
            Anchor::Middle => attributes += " text-anchor=\"middle\"",
            Anchor::End => attributes += " text-anchor=\"end\"",
        }
        if style.bold {
            attributes += " font-weight=\"bold\"";
        }
        if style.upwards {
            attributes += &format!(" transform=\"rotate(-90 {x} {y})\"");
        }
        self.raw(&format!("<text{attributes}>{content}</text>"));
    }

    /// Draws by calling `draw`, and clips the result to `area`.
    ///
    /// An inner `<svg>` clips without an id, so several figures can share a page.
    pub(crate) fn clipped(&mut self, area: Area, draw: impl FnOnce(&mut Self)) {
        let [x, y, w, h] = [area.x, area.y, area.width, area.height].map(number);
        self.raw(&format!("<svg{} viewBox=\"{x} {y} {w} {h}\">", place(area)));
        draw(self);
        self.raw("</svg>");
    }

    /// Draws a title and, in a paler color, the lines of a note below it. Both texts are markup and
    /// begin at the left edge `x`. Returns the y coordinate below these lines.
    pub(crate) fn title(&mut self, x: f64, room: f64, title: &str, note: &str) -> f64 {
        let mut y = 8.0;
        if !title.is_empty() {
            y += 18.0;
            let style = TextStyle::new([x, y], TITLE_TEXT, Anchor::Start).bold();
            self.fitted(style, title, room);
        }
        y += 4.0;
        for line in lines(note, TICK_TEXT, room) {
            y += 15.0;
            let style = TextStyle::new([x, y], TICK_TEXT, Anchor::Start).fill(SOFT);
            self.fitted(style, &line, room);
        }
        y + 6.0
    }

    /// The finished SVG document, on a white background.
    pub(crate) fn finish(self, width: f64, height: f64) -> String {
        let (w, h) = (width.ceil(), height.ceil());
        let mut out = String::with_capacity(self.body.len() + 512);
        // Writing to a String does not fail.
        let _ = write!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"DejaVu Sans, Verdana, sans-serif\">\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"white\"/>\n{}</svg>\n",
            self.body
        );
        out
    }
}

/// Maximum coordinate in a drawing, because SVG renderers may fail on larger coordinates.
const MAX_COORDINATE: f64 = 1e4;

fn is_near(point: [f64; 2]) -> bool {
    point.iter().all(|at| at.abs() <= MAX_COORDINATE)
}

/// The part of a line within the coordinate limit (Liang and Barsky 1984, ACM Transactions
/// on Graphics 3(1)).
fn near(from: [f64; 2], to: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let [mut first, mut last] = [0.0_f64, 1.0_f64];
    for axis in 0..2 {
        let along = to[axis] - from[axis];
        // The line parameters at which the line crosses the two borders of the range. If the line
        // runs along a border, the parameters of the crossings are NaN.
        let borders = [-MAX_COORDINATE, MAX_COORDINATE].map(|border| (border - from[axis]) / along);
        if along != 0.0 {
            first = first.max(borders[0].min(borders[1]));
            last = last.min(borders[0].max(borders[1]));
        } else if from[axis].abs() > MAX_COORDINATE {
            return None;
        }
    }
    let at = |share: f64| [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
    let ends =
        [at(first), at(last)].map(|end| end.map(|at| at.clamp(-MAX_COORDINATE, MAX_COORDINATE)));
    (first < last).then_some(ends)
}

/// SVG path data through the given points.
fn path(points: &[[f64; 2]]) -> String {
    let mut data = String::new();
    for (i, [x, y]) in points.iter().enumerate() {
        data += if i == 0 { "M" } else { "L" };
        data += &format!("{} {}", number(*x), number(*y));
    }
    data
}

fn place(area: Area) -> String {
    let [x, y, w, h] = [area.x, area.y, area.width, area.height].map(number);
    format!(" x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"")
}

/// A coordinate rounded to a hundredth of a unit.
fn number(value: f64) -> String {
    let rounded = (value * 100.0).round() / 100.0 + 0.0;
    if rounded.is_finite() {
        rounded.to_string()
    } else {
        "0".to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coordinates reached 10⁹ in the drawing of a micrometre-sized mirror beside a metre-sized
    /// light, and the SVG renderer failed.
    #[test]
    fn lines_far_away_are_cut_and_keep_their_way() {
        assert_eq!(
            near([-1e9, 50.0], [1e9, 50.0]),
            Some([[-MAX_COORDINATE, 50.0], [MAX_COORDINATE, 50.0]])
        );
        let cut = near([0.0, 0.0], [4e9, 2e9]).unwrap_or_default();
        assert!(
            (cut[1][0] - MAX_COORDINATE).abs() < 1e-6
                && (cut[1][1] - 0.5 * MAX_COORDINATE).abs() < 1e-6
        );
        assert_eq!(
            near([2.0 * MAX_COORDINATE, 0.0], [2.0 * MAX_COORDINATE, 1e9]),
            None
        );
        assert_eq!(
            near([-3.0 * MAX_COORDINATE, 0.0], [0.0, 3.0 * MAX_COORDINATE]),
            None
        );
        let mut svg = Svg::default();
        svg.line([1e12, 3.0], [-1e12, 3.0], Stroke::solid("#000", 1.0));
        svg.circle([0.0, -1e15], 2.0, "#000");
        assert!(!svg.finish(10.0, 10.0).contains("00000"));
    }
}
