//! Draws the strip: the cut along the central ray and, below each virtual plane, the plane's
//! light field and spectrum.

use crate::bar;
use crate::color::{Colors, hex};
use crate::cut::SectionLayout;
use crate::figure::{Error, Figure, csv_text, decimal};
use crate::grid::{GAPS, LEFT, PageGrid, RIGHT, ends, guide_strokes, inner};
use crate::picture::{Guide, PlateRow, drawn_pictures};
use crate::plate::feet;
use crate::section::Section;
use crate::sizes::{SOFT, TICK_TEXT};
use crate::style::Style;
use crate::svg::{Anchor, Area, Svg, TextStyle};
use crate::text::width;

/// The path of the light, plane by plane, as in Fig. 1 of Durand et al. 2005.
#[derive(Clone, Debug)]
pub struct Strip<'a> {
    /// Title; markup.
    pub title: &'a str,
    /// A line below the title, as markup; may be empty.
    pub note: &'a str,
    /// The scene.
    pub section: &'a Section,
    /// The rows of pictures below the section. Each row has a picture for each plane of the scene.
    pub rows: Vec<PlateRow<'a>>,
    /// Lines below the pictures of each plane, such as "*p* = 0.43, pass", as markup; may be empty.
    pub verdicts: Vec<Vec<String>>,
}

/// Height of the cut.
const CUT: f64 = 150.0;
/// Height of the lines from the cut to the columns.
const LEADERS: f64 = 34.0;
/// Minimum width of a picture in a strip. Columns that do not fit at the minimum width are placed
/// below the first columns.
const MIN_WIDTH: f64 = 48.0;

/// Draws a strip, as wide as the page.
///
/// The CSV has a row for each cell of each picture. The numbers of the cut are in the CSV of
/// [`section`](crate::section()).
///
/// # Errors
/// If a heat map or the numbers cannot be written.
pub fn strip(strip: &Strip<'_>, style: &Style) -> Result<Figure, Error> {
    let mut svg = Svg::default();
    let inner = inner(style);
    // Two keys fit side by side on the narrowest page.
    let least = MIN_WIDTH.min(0.5 * (inner - GAPS[1]));
    let planes = &strip.section.planes;
    let grid = PageGrid::new(&strip.rows, planes.len(), [least, f64::INFINITY], style);
    let room = inner + RIGHT - 8.0;
    let top = style.title(&mut svg, LEFT, room, strip.title, strip.note);
    let mut unseen = Svg::default();
    let drawn = if style.scene { &mut svg } else { &mut unseen };
    let section = strip.section;
    let area = section.draw_above(drawn, [LEFT, top], [inner, CUT], (false, style.scale));
    let cut = SectionLayout::new(section, area);
    cut.draw(drawn);
    let mut bottom = if style.scene { cut.bottom() } else { top };
    let verdicts: &[Vec<String>] = if style.verdicts { &strip.verdicts } else { &[] };
    // Lines from the cut to a lower block of columns would cross the columns above it, so columns in
    // several blocks have only numbers.
    let has_leaders = grid.blocks() == 1 && style.scene;
    for block in 0..grid.blocks() {
        let heads = bottom + if has_leaders { LEADERS } else { 14.0 };
        if has_leaders {
            for (column, middle, _) in grid.columns(block) {
                cut.leader(&mut svg, column, [middle, heads]);
            }
        }
        cut.headings(&mut svg, heads, grid.columns(block));
        let rooms = grid.columns(block).map(|(column, _, room)| (column, room));
        bottom = grid.draw(&mut svg, block, heads + cut.heading_height(rooms))?;
        bottom = feet(&mut svg, verdicts, &grid, block, bottom);
    }
    let bottom = keys(&mut svg, strip, &grid, [LEFT + inner, bottom], style);
    Ok(Figure {
        svg: svg.finish(LEFT + inner + RIGHT, bottom + 14.0),
        csv: numbers(strip)?,
        pictures: drawn_pictures(&strip.rows, planes.iter().map(|plane| &plane.name)),
    })
}

/// Height of a line of keys, and distance between a swatch and its name.
const KEY_LINE: f64 = 18.0;
const KEY_GAP: f64 = 7.0;

/// Draws the keys of predicted lines and of cells without a value; returns the lowest baseline.
fn keys(
    svg: &mut Svg,
    strip: &Strip<'_>,
    grid: &PageGrid<'_, '_>,
    [right, bottom]: [f64; 2],
    style: &Style,
) -> f64 {
    let guides = guides(&strip.rows);
    let gaps = grid.has_gaps();
    let is_drawn = gaps || !guides.is_empty();
    let y = bottom + if is_drawn { KEY_LINE } else { 0.0 };
    if gaps {
        bar::gap_key(svg, right, y);
    }
    match guides.is_empty() {
        true => y,
        false => guide_keys(svg, &guides, [LEFT, y], right + RIGHT, style),
    }
}

/// The lines over the first row of pictures that has lines.
fn guides<'a>(rows: &'a [PlateRow<'_>]) -> Vec<&'a Guide> {
    let mut each = rows.iter().map(|row| {
        let guides = row.pictures.iter().flat_map(|picture| &picture.guides);
        guides.collect::<Vec<_>>()
    });
    each.find(|guides| !guides.is_empty()).unwrap_or_default()
}

/// Draws the key of the dashed lines over spectra. If the lines in the plane of incidence and
/// perpendicular to it differ, the key distinguishes the two; their names are below each other where
/// `right` leaves no room. Returns the lowest baseline.
fn guide_keys(
    svg: &mut Svg,
    guides: &[&Guide],
    [x, mut y]: [f64; 2],
    right: f64,
    style: &Style,
) -> f64 {
    let names: &[&str] = if guides.iter().any(|guide| guide.is_across) {
        &["shear in the plane of incidence", "across it"]
    } else {
        &["predicted shear"]
    };
    let mut swatch = Area::new([x, y - 10.0], [34.0, 12.0]);
    for (name, is_across) in names.iter().zip([false, true]) {
        let end = swatch.right() + KEY_GAP + width(name, TICK_TEXT);
        if swatch.x > x && end > right {
            y += KEY_LINE;
            swatch = Area::new([x, y - 10.0], [34.0, 12.0]);
        }
        svg.fill(swatch, &hex(Colors::Sequential(style.palette).at(0.0)));
        for [from, to] in ends([swatch.x, y - 4.0], [swatch.right(), y - 4.0], 9.0) {
            for stroke in guide_strokes(is_across) {
                svg.line(from, to, stroke);
            }
        }
        let at = [swatch.right() + KEY_GAP, y];
        svg.text(
            TextStyle::new(at, TICK_TEXT, Anchor::Start).fill(SOFT),
            name,
        );
        swatch.x = end + 20.0;
    }
    y
}

/// The table of a strip, with a row for each cell of each picture. In the table, pictures
/// are in the order of the strip, and x varies slowest.
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
    for (index, plane) in strip.section.planes.iter().enumerate() {
        for row in &strip.rows {
            let [x_axis, y_axis] = row.pictures[index].headings();
            for [x, y, value] in row.pictures[index].cells() {
                rows.push(vec![
                    plane.name.clone(),
                    decimal(&plane.distance),
                    row.name.to_owned(),
                    x_axis.clone(),
                    x,
                    y_axis.clone(),
                    y,
                    row.quantity.heading(),
                    value,
                ]);
            }
        }
    }
    csv_text(&header.map(str::to_owned), rows)
}
