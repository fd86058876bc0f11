//! The path: the cut along the central ray and, under each virtual plane, its light field and spectrum.

mod draw;

use crate::axis::{Axis, Quantity};
use crate::cut::Cut;
use crate::figure::{Error, Figure, csv_text, decimal};
use crate::section::Section;
use crate::style::LABEL_BASELINE;
use crate::svg::{Area, Svg};
use draw::{LEFT, Layout, ROW_GAP, draw_row, footer};
use ndarray::ArrayView2;

/// Values on a grid, [x, y], both axes ascending. NaN: no value.
#[derive(Clone, Debug)]
pub struct Picture<'a> {
    /// The first axis of the array.
    pub x: Axis,
    /// The second.
    pub y: Axis,
    /// The values.
    pub values: ArrayView2<'a, f64>,
}

/// A line over a spectrum, ν = ν₀ + slope · (ρ − ρ₀): where the theory puts its content.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guide {
    /// The point (ρ₀, ν₀): the origin, or the centre of a replica.
    pub through: [f64; 2],
    /// dν/dρ, in metres; −d for light that has travelled d.
    pub slope: f64,
}

/// What is shown under a virtual plane.
#[derive(Clone, Debug)]
pub struct Column<'a> {
    /// The light field in (x, u).
    pub light_field: Picture<'a>,
    /// The power spectrum in (ρ, ν).
    pub spectrum: Picture<'a>,
    /// The predicted one. There is a row of them if each column has one.
    pub predicted: Option<Picture<'a>>,
    /// A line below, such as "*p* = 0.43, pass", markup; may be empty.
    pub verdict: String,
    /// Dashed lines over the spectrum.
    pub guides: Vec<Guide>,
}

/// The path of the light, plane by plane, as in Fig. 1 of Durand et al. 2005.
#[derive(Clone, Debug)]
pub struct Strip<'a> {
    /// What is shown; markup.
    pub title: &'a str,
    /// A line below the title, markup; may be empty.
    pub note: &'a str,
    /// The scene; `columns[i]` belongs to its plane i.
    pub section: &'a Section,
    /// One for each plane.
    pub columns: Vec<Column<'a>>,
    /// What the light fields hold; shown linearly, each relative to its own largest value.
    pub light_field: Quantity,
    /// What the spectra hold; shown in decibels below each one's own largest value.
    pub spectrum: Quantity,
    /// Lower end of the decibels, below 0.
    pub floor: f64,
}

/// A row of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Row {
    LightField,
    Spectrum,
    Predicted,
}

impl Row {
    /// Those of a strip.
    fn of(strip: &Strip<'_>) -> Vec<Self> {
        let predicted = strip
            .columns
            .iter()
            .all(|column| column.predicted.is_some());
        let mut rows = vec![Self::LightField, Self::Spectrum];
        rows.extend(predicted.then_some(Self::Predicted));
        rows
    }

    fn name(self) -> &'static str {
        match self {
            Self::LightField => "light field",
            Self::Spectrum => "spectrum",
            Self::Predicted => "predicted",
        }
    }

    /// Its picture in a column.
    fn picture<'a, 'b>(self, column: &'b Column<'a>) -> &'b Picture<'a> {
        match (self, &column.predicted) {
            (Self::LightField, _) => &column.light_field,
            (Self::Predicted, Some(predicted)) => predicted,
            (Self::Spectrum | Self::Predicted, _) => &column.spectrum,
        }
    }

    /// What its pictures hold.
    fn quantity<'b>(self, strip: &'b Strip<'_>) -> &'b Quantity {
        match self {
            Self::LightField => &strip.light_field,
            Self::Spectrum | Self::Predicted => &strip.spectrum,
        }
    }
}

/// Width to the right of the last picture, for the color bars.
const RIGHT: f64 = 90.0;
/// Height of the cut.
const CUT: f64 = 236.0;
/// Height of the lines from the cut to the columns.
const LEADERS: f64 = 40.0;
/// Draws a strip of one to about eight planes.
///
/// The CSV has a row for each cell of each picture; the numbers of the cut are those of [`section`](crate::section()).
///
/// # Errors
/// When a heat map or the numbers cannot be written.
pub fn strip(strip: &Strip<'_>) -> Result<Figure, Error> {
    let mut svg = Svg::default();
    let layout = Layout::new(strip);
    let top = svg.title(LEFT, layout.inner, strip.title, strip.note);
    let area = Area {
        x: LEFT,
        y: top + Cut::AXIS,
        width: layout.inner,
        height: CUT,
    };
    let cut = Cut::new(strip.section, area);
    cut.draw(&mut svg);
    let heads = area.bottom() + LEADERS;
    for column in 0..strip.columns.len() {
        let point = [layout.middle(column), heads];
        cut.leader(&mut svg, column, point);
        cut.heading(&mut svg, column, point, layout.panel + layout.gap - 8.0);
    }
    let first = heads + Cut::HEADING;
    let rows = Row::of(strip);
    for (index, row) in rows.iter().copied().enumerate() {
        let y = first + index as f64 * (layout.panel + ROW_GAP);
        draw_row(&mut svg, strip, &layout, row, y)?;
    }
    let bottom = first + rows.len() as f64 * (layout.panel + ROW_GAP) - ROW_GAP + LABEL_BASELINE;
    let bottom = footer(&mut svg, strip, &layout, bottom);
    Ok(Figure {
        svg: svg.finish(LEFT + layout.inner + RIGHT, bottom),
        csv: numbers(strip)?,
    })
}

/// The table: a row for each cell of each picture, the pictures in order, x slowest.
fn numbers(strip: &Strip<'_>) -> Result<String, Error> {
    let header = [
        "plane",
        "distance [m]",
        "picture",
        "x axis",
        "x",
        "y axis",
        "y",
        "quantity",
        "value",
    ];
    let mut rows = Vec::new();
    for (index, column) in strip.columns.iter().enumerate() {
        let (name, distance) = match strip.section.planes.get(index) {
            Some(plane) => (plane.name.clone(), decimal(&plane.distance)),
            None => ((index + 1).to_string(), String::new()),
        };
        for row in Row::of(strip) {
            let Picture { x, y, values } = row.picture(column);
            let (columns, lines) = values.dim();
            let heads = [x, y].map(|axis| axis.quantity.heading());
            for ((i, j), value) in values.indexed_iter() {
                rows.push(vec![
                    name.clone(),
                    distance.clone(),
                    row.name().to_owned(),
                    heads[0].clone(),
                    decimal(&x.center(i, columns)),
                    heads[1].clone(),
                    decimal(&y.center(j, lines)),
                    row.quantity(strip).heading(),
                    decimal(value),
                ]);
            }
        }
    }
    csv_text(&header.map(str::to_owned), rows)
}
