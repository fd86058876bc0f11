//! Draws a plate of pictures in rows and columns, such as several scenes side by side.

use crate::axis::{Axis, AxisQuantity, minus};
use crate::bar;
use crate::figure::{Error, Figure, csv_text, decimal};
use crate::grid::{LEFT, PageGrid, RIGHT, inner};
use crate::panel::Panel;
use crate::picture::{PlateRow, drawn_pictures};
use crate::sizes::{FAINT, HEAD_TEXT, INK, LEAST_TEXT, SMALL_TEXT, SOFT, THEORY_COLOR, TICK_TEXT};
use crate::style::Style;
use crate::svg::{Anchor, Area, Stroke, Svg, TextStyle};
use crate::text::{lines, plain, width};
use etendue_field::uncertain;

/// A plate of pictures in rows and columns.
#[derive(Clone, Debug, Default)]
pub struct Plate<'a> {
    /// Title; markup.
    pub title: &'a str,
    /// A line below the title, as markup; may be empty.
    pub note: &'a str,
    /// Headings of the columns. Text after a line break becomes a second line of the heading,
    /// which may contain markup.
    pub heads: Vec<String>,
    /// The rows, from top to bottom.
    pub rows: Vec<PlateRow<'a>>,
    /// Lines below each column, as markup.
    pub feet: Vec<Vec<String>>,
    /// Bars with a number for each column, at the bottom.
    pub bars: Option<Bars>,
    /// Maximum width of a picture; if it is `None`, pictures are as wide as the page allows.
    pub side: Option<f64>,
}

/// A measured number for each column, with its standard error and its prediction.
#[derive(Clone, Debug)]
pub struct Bars {
    /// The quantity of the bars.
    pub quantity: AxisQuantity,
    /// A description of the quantity, as markup.
    pub about: String,
    /// Heights of the bars.
    pub measured: Vec<Option<f64>>,
    /// Their standard errors.
    pub errors: Vec<Option<f64>>,
    /// Predicted values, drawn as lines across the bars.
    pub predicted: Vec<Option<f64>>,
}

/// Height of the bar panel, and width of each bar.
const BARS: f64 = 110.0;
const BAR: f64 = 60.0;
/// Minimum width of a picture in a plate. Columns that do not fit at the minimum width are placed
/// below the first columns.
const MIN_WIDTH: f64 = 58.0;
/// Minimum page width below a title, if the page is wide enough.
const TITLE: f64 = 300.0;

/// Draws a plate, at most as wide as the page.
///
/// The CSV has the numbers of the bars, and is empty if there are no bars.
///
/// # Errors
/// If a heat map or the numbers cannot be written.
///
/// # Panics
/// If a row does not have a picture for each head.
pub fn plate(plate: &Plate<'_>, style: &Style) -> Result<Figure, Error> {
    let most = plate.side.unwrap_or(f64::INFINITY);
    let widths = [MIN_WIDTH.min(most), most];
    let grid = PageGrid::new(&plate.rows, plate.heads.len(), widths, style);
    let mut svg = Svg::default();
    let inner = grid.width().max(TITLE.min(inner(style)));
    let room = inner + 0.8 * RIGHT;
    let mut bottom = style.title(&mut svg, LEFT, room, plate.title, plate.note);
    for block in 0..grid.blocks() {
        let top = bottom + if block == 0 { 26.0 } else { 40.0 };
        let top = heads(&mut svg, &plate.heads, &grid, block, top);
        bottom = grid.draw(&mut svg, block, top)?;
        let verdicts: &[Vec<String>] = if style.verdicts { &plate.feet } else { &[] };
        bottom = feet(&mut svg, verdicts, &grid, block, bottom);
    }
    if let Some(bars) = &plate.bars {
        let area = Area::new([LEFT, bottom + 26.0], [inner, style.scale * BARS]);
        let count = plate.heads.len();
        let evenly = |column| (column as f64 + 0.5) / count as f64;
        let middles: Vec<f64> = (0..count)
            .map(|column| LEFT + inner * evenly(column))
            .collect();
        bottom = draw_bars(&mut svg, bars, area, &middles);
    }
    if grid.has_gaps() {
        bottom += 20.0;
        bar::gap_key(&mut svg, LEFT + inner, bottom);
    }
    Ok(Figure {
        svg: svg.finish(LEFT + inner + RIGHT, bottom + 14.0),
        csv: numbers(plate)?,
        pictures: drawn_pictures(&plate.rows, plate.heads.iter()),
    })
}

/// Draws the first line of a block's headings above `top` and the second line, if any, below it.
/// Returns the top of the pictures.
fn heads(svg: &mut Svg, heads: &[String], grid: &PageGrid<'_, '_>, block: usize, top: f64) -> f64 {
    let parts = |column: usize| {
        heads[column]
            .split_once('\n')
            .unwrap_or((&heads[column], ""))
    };
    let columns = || grid.columns(block);
    let formulas = columns().any(|(column, ..)| !parts(column).1.is_empty());
    let bold = TextStyle::new([0.0; 2], HEAD_TEXT, Anchor::Middle).bold();
    let bold = bold.fitting(columns().map(|(column, _, room)| (parts(column).0, room)));
    let second = TextStyle::new([0.0; 2], TICK_TEXT, Anchor::Middle);
    let second = second.fitting(columns().map(|(column, _, room)| (parts(column).1, room)));
    for (column, middle, room) in columns() {
        let (name, formula) = parts(column);
        svg.fitted(bold.at([middle, top - 9.0]), name, room);
        svg.fitted(second.at([middle, top - 9.0 + FORMULA]), formula, room);
    }
    top + if formulas { FORMULA + DESCENT } else { 0.0 }
}

/// Distance between a heading and its second line.
const FORMULA: f64 = 17.0;
/// Distance that letters of a second line need below it.
const DESCENT: f64 = 4.0;

/// Draws the lines below each column of a block; returns the lower edge of the last line.
pub(crate) fn feet(
    svg: &mut Svg,
    feet: &[Vec<String>],
    grid: &PageGrid<'_, '_>,
    block: usize,
    baseline: f64,
) -> f64 {
    let with_lines = |(column, middle, room): (usize, f64, f64)| {
        let texts = feet.get(column).into_iter().flatten();
        let lines: Vec<String> = texts.flat_map(|text| broken(text, room)).collect();
        (lines, middle, room)
    };
    let columns: Vec<_> = grid.columns(block).map(with_lines).collect();
    let all = columns
        .iter()
        .flat_map(|(lines, _, room)| lines.iter().map(|text| (&**text, *room)));
    let style = TextStyle::new([0.0; 2], TICK_TEXT, Anchor::Middle).fitting(all);
    for (lines, middle, room) in &columns {
        for (line, text) in lines.iter().enumerate() {
            let at = [*middle, baseline + 21.0 + 16.0 * line as f64];
            svg.fitted(style.at(at), text, *room);
        }
    }
    let most = columns.iter().map(|(lines, ..)| lines.len()).max();
    baseline + 6.0 + 16.0 * most.unwrap_or(0) as f64
}

/// Breaks a line at spaces if it is wider than `room` even in small letters.
fn broken(text: &str, room: f64) -> Vec<String> {
    if width(&plain(text), LEAST_TEXT) > room {
        lines(text, SMALL_TEXT, room)
    } else {
        vec![text.to_owned()]
    }
}

/// Draws bars from 0 with a key below them; returns the lower edge of the key.
fn draw_bars(svg: &mut Svg, bars: &Bars, area: Area, middles: &[f64]) -> f64 {
    let measured = bars.measured.iter().zip(&bars.errors);
    let ends = measured.map(|(m, e)| m.unwrap_or(0.0) + e.unwrap_or(0.0));
    let highest = ends
        .chain(bars.predicted.iter().flatten().copied())
        .fold(0.0, f64::max);
    let top = if highest > 0.0 { 1.25 * highest } else { 1.0 };
    let x = Axis::edges("", "", [0.0, 1.0]);
    let y = Axis::of(&bars.quantity, [0.0, top]);
    let panel = Panel::new(area, &x, &y);
    let at = |value: f64| panel.point(0.0, value)[1];
    for (column, value) in bars.measured.iter().enumerate() {
        let x = middles[column];
        if let Some(value) = value {
            // A fraction may be below 0 after noise removal.
            let y = at(value.max(0.0));
            let filled = Area::new([x - 0.5 * BAR, y], [BAR, area.bottom() - y]);
            svg.fill(filled, FAINT);
        }
        if let (Some(value), Some(error)) = (value, bars.errors[column]) {
            let above = [x, at(value + error) - 5.0];
            let text = minus(&uncertain(*value, error));
            svg.text(TextStyle::new(above, TICK_TEXT, Anchor::Middle), &text);
            svg.line(
                [x, at((value - error).max(0.0))],
                [x, at((value + error).max(0.0))],
                Stroke::solid(INK, 1.4),
            );
        }
        if let Some(predicted) = bars.predicted[column] {
            let ends = [x - 0.7 * BAR, x + 0.7 * BAR].map(|x| [x, at(predicted)]);
            svg.line(ends[0], ends[1], Stroke::solid(THEORY_COLOR, 1.8));
        }
    }
    panel.frame(svg);
    let key = format!(
        "Bars: {}, as measured, with standard errors. Lines: predictions.",
        bars.about
    );
    let mut y = area.bottom();
    for line in lines(&key, TICK_TEXT, area.width + 0.8 * RIGHT) {
        y += 15.0;
        svg.markup(
            TextStyle::new([area.x, y], TICK_TEXT, Anchor::Start).fill(SOFT),
            &line,
        );
    }
    y + 5.0
}

/// The table of the numbers that the bars show.
fn numbers(plate: &Plate<'_>) -> Result<String, Error> {
    let Some(bars) = &plate.bars else {
        return Ok(String::new());
    };
    let quantity = bars.quantity.heading();
    let header = [
        "column".to_owned(),
        format!("measured {quantity}"),
        "standard error".to_owned(),
        "predicted".to_owned(),
    ];
    let rows = plate.heads.iter().enumerate().map(|(i, head)| {
        let numbers = [bars.measured[i], bars.errors[i], bars.predicted[i]];
        let cells = numbers.map(|x| x.as_ref().map_or(String::new(), decimal));
        std::iter::once(plain(head)).chain(cells).collect()
    });
    csv_text(&header, rows)
}
