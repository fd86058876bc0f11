//! Pictures in rows and columns, such as several scenes side by side.

use crate::axis::{Axis, Quantity, minus};
use crate::bar;
use crate::color::{Colors, Scale, Shading, has_gaps, largest};
use crate::figure::{Error, Figure, csv_text, decimal};
use crate::panel::Panel;
use crate::strip::Picture;
use crate::style::{FAINT, HEAD_TEXT, INK, LABEL_BASELINE, SOFT, THEORY_COLOR, TICK_TEXT};
use crate::svg::{Anchor, Area, Stroke, Svg, Text};
use crate::text::plain;
use etendue_field::uncertain;

/// A row of pictures that share colors.
#[derive(Clone, Debug)]
pub struct PlateRow<'a> {
    /// Its name.
    pub name: &'a str,
    /// What the pictures hold.
    pub quantity: Quantity,
    /// How values are laid on the colors.
    pub scale: Scale,
    /// Whether one range of colors is for all of the row. Otherwise each picture is relative to its own largest value.
    pub shared: bool,
    /// One for each column.
    pub pictures: Vec<Picture<'a>>,
}

/// Pictures in rows and columns.
#[derive(Clone, Debug)]
pub struct Plate<'a> {
    /// What is shown; markup.
    pub title: &'a str,
    /// A line below the title, markup; may be empty.
    pub note: &'a str,
    /// Over each column.
    pub heads: Vec<String>,
    /// From top to bottom.
    pub rows: Vec<PlateRow<'a>>,
    /// Lines below each column, markup.
    pub feet: Vec<Vec<String>>,
    /// A number for each column, below all else.
    pub bars: Option<Bars>,
}

/// A measured number for each column, with its standard error and what is predicted.
#[derive(Clone, Debug)]
pub struct Bars {
    /// What it is.
    pub quantity: Quantity,
    /// The same in words, markup.
    pub about: String,
    /// Heights of the bars.
    pub measured: Vec<Option<f64>>,
    /// Their standard errors.
    pub errors: Vec<Option<f64>>,
    /// Drawn as lines across the bars.
    pub predicted: Vec<Option<f64>>,
}

/// Left edge of the first picture: row name, axis label, tick texts.
const LEFT: f64 = 92.0;
/// Width to the right of the last picture, for the color bars.
const RIGHT: f64 = 90.0;
/// Between pictures side by side that share an axis, or do not.
const GAPS: [f64; 2] = [34.0, 76.0];
/// Between the lower edge of a picture and the upper edge of the one below.
const ROW_GAP: f64 = LABEL_BASELINE + 24.0;
/// Width of all pictures: at the 7 inches of two columns the texts are 6 points high.
const INNER: f64 = 740.0;
/// Height of the panel of bars, and width of each.
const BARS: f64 = 110.0;
const BAR: f64 = 60.0;

/// Draws a plate of one to about six columns.
///
/// The CSV has the numbers of the bars; it is empty without bars.
///
/// # Errors
/// When a heat map or the numbers cannot be written.
///
/// # Panics
/// When a row has not a picture for each head.
pub fn plate(plate: &Plate<'_>) -> Result<Figure, Error> {
    let count = plate.heads.len();
    let ys = |row: &PlateRow<'_>| row.pictures.windows(2).all(|pair| pair[0].y == pair[1].y);
    let gap = GAPS[usize::from(!plate.rows.iter().all(ys))];
    let columns = count.max(1) as f64;
    let side = ((INNER - gap * (columns - 1.0)) / columns)
        .clamp(80.0, 240.0)
        .floor();
    let mut svg = Svg::default();
    let inner = (columns * (side + gap) - gap).max(480.0);
    let top = svg.title(LEFT, inner, plate.title, plate.note) + 28.0;
    let area_of = |column: usize, row: usize| Area {
        x: LEFT + column as f64 * (side + gap),
        y: top + row as f64 * (side + ROW_GAP),
        width: side,
        height: side,
    };
    for (column, head) in plate.heads.iter().enumerate() {
        let at = [area_of(column, 0).middle()[0], top - 9.0];
        let style = Text::new(at, HEAD_TEXT, Anchor::Middle).bold();
        svg.fitted(style, head, side + gap - 8.0);
    }
    for (index, row) in plate.rows.iter().enumerate() {
        assert_eq!(row.pictures.len(), count, "pictures of {}", row.name);
        draw_row(&mut svg, row, &|column| area_of(column, index))?;
    }
    let mut bottom = top + plate.rows.len() as f64 * (side + ROW_GAP) - ROW_GAP + LABEL_BASELINE;
    let lines = plate.feet.iter().map(Vec::len).max().unwrap_or(0);
    for (column, feet) in plate.feet.iter().enumerate() {
        for (line, text) in feet.iter().enumerate() {
            let y = bottom + 21.0 + 16.0 * line as f64;
            let at = [area_of(column, 0).middle()[0], y];
            svg.fitted(
                Text::new(at, TICK_TEXT, Anchor::Middle),
                text,
                side + gap - 6.0,
            );
        }
    }
    bottom += 5.0 + 16.0 * lines as f64;
    if let Some(bars) = &plate.bars {
        let area = Area {
            x: LEFT,
            y: bottom + 26.0,
            width: inner,
            height: BARS,
        };
        draw_bars(&mut svg, bars, area, &|column| {
            area_of(column, 0).middle()[0]
        });
        bottom = area.bottom() + 20.0;
    }
    let mut pictures = plate.rows.iter().flat_map(|row| &row.pictures);
    if pictures.any(|picture| has_gaps(picture.values)) {
        bottom += 20.0;
        bar::gap_key(&mut svg, LEFT + inner, bottom);
    }
    Ok(Figure {
        svg: svg.finish(LEFT + inner + RIGHT, bottom + 14.0),
        csv: numbers(plate)?,
    })
}

/// The pictures of a row, its name and their color bar.
fn draw_row(svg: &mut Svg, row: &PlateRow<'_>, area: &dyn Fn(usize) -> Area) -> Result<(), Error> {
    let peaks = row.pictures.iter().map(|picture| largest(picture.values));
    let highest = peaks.fold(0.0, f64::max);
    let mut bar = if row.shared {
        shading(row, &row.quantity.name, highest)
    } else {
        shading(row, &format!("{} / peak", row.quantity.name), 1.0)
    };
    for (column, picture) in row.pictures.iter().enumerate() {
        let panel = Panel {
            area: area(column),
            x: &picture.x,
            y: &picture.y,
            label_y: column == 0 || picture.y != row.pictures[0].y,
        };
        let peak = if row.shared {
            highest
        } else {
            largest(picture.values)
        };
        let shading = shading(row, "", peak).showing(picture.values);
        bar.beyond = [0, 1].map(|end| bar.beyond[end] || shading.beyond[end]);
        panel.heat_map(svg, picture.values, &shading)?;
        panel.axes(svg);
    }
    let Some(last) = row.pictures.len().checked_sub(1) else {
        return Ok(());
    };
    let at = [LEFT - 68.0, area(0).middle()[1]];
    let style = Text::new(at, HEAD_TEXT, Anchor::Middle).bold().upwards();
    svg.fitted(style, row.name, area(0).height + 40.0);
    bar::draw(svg, &bar, area(last).right() + 12.0, area(last))
}

/// Bars from 0, a key below them.
fn draw_bars(svg: &mut Svg, bars: &Bars, area: Area, middle: &dyn Fn(usize) -> f64) {
    let measured = bars.measured.iter().zip(&bars.errors);
    let ends = measured.map(|(m, e)| m.unwrap_or(0.0) + e.unwrap_or(0.0));
    let highest = ends
        .chain(bars.predicted.iter().flatten().copied())
        .fold(0.0, f64::max);
    let top = if highest > 0.0 { 1.25 * highest } else { 1.0 };
    let panel = Panel {
        area,
        x: &Axis::edges("", "", [0.0, 1.0]),
        y: &Axis {
            quantity: bars.quantity.clone(),
            min: 0.0,
            max: top,
        },
        label_y: true,
    };
    let at = |value: f64| panel.point(0.0, value)[1];
    for (column, value) in bars.measured.iter().enumerate() {
        let x = middle(column);
        if let Some(value) = value {
            // A share whose noise has been taken off may be below 0.
            let y = at(value.max(0.0));
            let filled = Area {
                x: x - 0.5 * BAR,
                y,
                width: BAR,
                height: area.bottom() - y,
            };
            svg.fill(filled, FAINT);
        }
        if let (Some(value), Some(error)) = (value, bars.errors[column]) {
            let above = [x, at(value + error) - 5.0];
            let text = minus(&uncertain(*value, error));
            svg.text(Text::new(above, TICK_TEXT, Anchor::Middle), &text);
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
    let at = [area.x, area.bottom() + 15.0];
    let key = format!(
        "Bars: {}, measured, with standard errors. Lines: predicted.",
        bars.about
    );
    svg.fitted(
        Text::new(at, TICK_TEXT, Anchor::Start).fill(SOFT),
        &key,
        area.width,
    );
}

/// The colors of a picture whose largest value is `peak`.
fn shading(row: &PlateRow<'_>, name: &str, peak: f64) -> Shading {
    let unit = if row.shared {
        row.quantity.unit.as_str()
    } else {
        ""
    };
    match row.scale {
        Scale::Linear => {
            let top = if peak > 0.0 { peak } else { 1.0 };
            Shading::linear(Colors::Sequential, Axis::edges(name, unit, [0.0, top]))
        }
        Scale::Decibel { floor } => Shading::decibel(name, floor, peak),
        Scale::Phase => Shading::phase(&row.quantity.name),
    }
}

/// The table: what the bars show.
fn numbers(plate: &Plate<'_>) -> Result<String, Error> {
    let Some(bars) = &plate.bars else {
        return Ok(String::new());
    };
    let quantity = bars.quantity.heading();
    let header = [
        "column".to_owned(),
        format!("measured {quantity}"),
        "error".to_owned(),
        "predicted".to_owned(),
    ];
    let rows = plate.heads.iter().enumerate().map(|(i, head)| {
        let numbers = [bars.measured[i], bars.errors[i], bars.predicted[i]];
        let cells = numbers.map(|x| x.as_ref().map_or(String::new(), decimal));
        std::iter::once(plain(head)).chain(cells).collect()
    });
    csv_text(&header, rows)
}
