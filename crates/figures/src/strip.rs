//! Draws the strip: the cut along the central ray and, below each virtual plane, the plane's
//! light field and spectrum.

use crate::axis::AxisQuantity;
use crate::bar;
use crate::color::{Colors, Scale, hex};
use crate::cut::SectionLayout;
use crate::figure::{DrawnPicture, Error, Figure, csv_text, decimal};
use crate::grid::{GAPS, Guide, LEFT, PageGrid, Picture, RIGHT, ends, guide_strokes, inner};
use crate::plate::{OWN_PEAK, feet};
use crate::section::Section;
use crate::sizes::{SOFT, TICK_TEXT};
use crate::style::Style;
use crate::svg::{Anchor, Area, Svg, TextStyle};
use crate::text::width;

/// The pictures below a virtual plane.
#[derive(Clone, Debug)]
pub struct StripColumn<'a> {
    /// The light field in (x, u).
    pub light_field: Picture<'a>,
    /// The light field in (y, v). The row of light fields in (y, v) is drawn if each column has
    /// such a light field.
    pub across: Option<AcrossPictures<'a>>,
    /// The power spectrum in (ρ, ν).
    pub spectrum: Picture<'a>,
    /// The spectrum in finer cells over the same axes, which is drawn instead of `spectrum`. The
    /// table has the values of `spectrum`.
    pub finer: Option<Picture<'a>>,
    /// The predicted spectrum. The row of predicted spectra is drawn if each column has a predicted
    /// spectrum.
    pub predicted: Option<Picture<'a>>,
    /// The full radial spectrum over (|Ωxy|, |Ωuv|), measured and predicted. The two rows of full
    /// radial spectra are drawn if each column has such a spectrum.
    pub full_radial: Option<[Picture<'a>; 2]>,
    /// The difference between the measured spectrum and a first-order chain. It is given in percent
    /// of the largest modulus of the measured spectrum. The row of differences is drawn if each
    /// column has such a difference.
    pub off_chain: Option<Picture<'a>>,
    /// Lines below the pictures, such as "*p* = 0.43, pass", as markup; may be empty.
    pub verdict: Vec<String>,
    /// Predicted lines. Only their ends are drawn, at the edges of the spectrum.
    pub guides: Vec<Guide>,
}

/// The light field in (y, v), and its spectrum at azimuth 90°.
#[derive(Clone, Debug)]
pub struct AcrossPictures<'a> {
    /// The light field in (y, v).
    pub light_field: Picture<'a>,
    /// The power spectrum at azimuth 90°.
    pub spectrum: Picture<'a>,
    /// The power spectrum at azimuth 90° in finer cells, which is drawn instead of `spectrum`.
    pub finer: Option<Picture<'a>>,
    /// Predicted lines, drawn at the edges of the spectrum at azimuth 90°.
    pub guides: Vec<Guide>,
}

/// The path of the light, plane by plane, as in Fig. 1 of Durand et al. 2005.
#[derive(Clone, Debug)]
pub struct Strip<'a> {
    /// Title; markup.
    pub title: &'a str,
    /// A line below the title, as markup; may be empty.
    pub note: &'a str,
    /// The scene; `columns[i]` belongs to the scene's plane i.
    pub section: &'a Section,
    /// A column for each plane.
    pub columns: Vec<StripColumn<'a>>,
    /// The quantity of the light fields. It is shown linearly, relative to the largest value of
    /// each light field.
    pub light_field: AxisQuantity,
    /// The quantity of the spectra. It is shown in decibels below the largest value of each
    /// spectrum.
    pub spectrum: AxisQuantity,
    /// The quantity of the full radial spectra. It is shown in decibels below the largest value of
    /// each spectrum.
    pub full_radial: AxisQuantity,
    /// Lower end of the color scale in decibels, a number below 0.
    pub floor: f64,
}

/// A kind of row of pictures in a strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StripRow {
    LightField,
    Spectrum,
    Across,
    AcrossSpectrum,
    Predicted,
    FullRadial,
    FullPredicted,
    OffChain,
}

impl StripRow {
    /// Returns the rows of a strip.
    fn of(strip: &Strip<'_>) -> Vec<Self> {
        let predicted = strip
            .columns
            .iter()
            .all(|column| column.predicted.is_some());
        let across = strip.columns.iter().all(|column| column.across.is_some());
        let mut rows = vec![Self::LightField, Self::Spectrum];
        if across {
            rows.extend([Self::Across, Self::AcrossSpectrum]);
        }
        rows.extend(predicted.then_some(Self::Predicted));
        let full_radial = |column: &StripColumn<'_>| column.full_radial.is_some();
        if strip.columns.iter().all(full_radial) {
            rows.push(Self::FullRadial);
            rows.extend(predicted.then_some(Self::FullPredicted));
        }
        let off_chain = |column: &StripColumn<'_>| column.off_chain.is_some();
        rows.extend(
            strip
                .columns
                .iter()
                .all(off_chain)
                .then_some(Self::OffChain),
        );
        rows
    }

    fn name(self) -> &'static str {
        match self {
            Self::LightField => "light field",
            Self::Across => "across",
            Self::AcrossSpectrum => "its spectrum",
            Self::Spectrum => "spectrum",
            Self::Predicted => "predicted",
            Self::FullRadial => "full radial",
            Self::FullPredicted => "prediction",
            Self::OffChain => "off the chain",
        }
    }

    /// Returns the picture of this row in a column.
    fn picture<'a, 'b>(self, column: &'b StripColumn<'a>) -> &'b Picture<'a> {
        let (full_radial, across) = (column.full_radial.as_ref(), column.across.as_ref());
        let other = match self {
            Self::Across => across.map(|across| &across.light_field),
            Self::AcrossSpectrum => across.map(|across| &across.spectrum),
            Self::Predicted => column.predicted.as_ref(),
            Self::FullRadial => full_radial.map(|[measured, _]| measured),
            Self::FullPredicted => full_radial.map(|[_, predicted]| predicted),
            Self::OffChain => column.off_chain.as_ref(),
            Self::LightField | Self::Spectrum => None,
        };
        other.unwrap_or(match self {
            Self::LightField | Self::Across => &column.light_field,
            _ => &column.spectrum,
        })
    }

    /// Returns the picture of the row that is drawn: the finer picture if there is one, otherwise
    /// the picture of the table.
    fn drawn<'a, 'b>(self, column: &'b StripColumn<'a>) -> &'b Picture<'a> {
        let finer = match self {
            Self::Spectrum => column.finer.as_ref(),
            Self::AcrossSpectrum => column.across.as_ref().and_then(|a| a.finer.as_ref()),
            _ => None,
        };
        finer.unwrap_or_else(|| self.picture(column))
    }

    /// Returns the quantity of this row's pictures.
    fn quantity(self, strip: &Strip<'_>) -> AxisQuantity {
        match self {
            Self::LightField | Self::Across => strip.light_field.clone(),
            Self::Spectrum | Self::AcrossSpectrum | Self::Predicted => strip.spectrum.clone(),
            Self::FullRadial | Self::FullPredicted => strip.full_radial.clone(),
            Self::OffChain => AxisQuantity::new("off the chain", "% of the peak"),
        }
    }
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
    let grid = grid(strip, style);
    let room = inner + RIGHT - 8.0;
    let top = style.title(&mut svg, LEFT, room, strip.title, strip.note);
    let mut unseen = Svg::default();
    let drawn = if style.scene { &mut svg } else { &mut unseen };
    let area = strip.section.draw_above(drawn, [LEFT, top], [inner, CUT]);
    let cut = SectionLayout::new(strip.section, area);
    cut.draw(drawn);
    let mut bottom = if style.scene { area.bottom() } else { top };
    let verdicts = strip.columns.iter().filter(|_| style.verdicts);
    let verdicts = verdicts.map(|column| column.verdict.clone());
    let verdicts: Vec<Vec<String>> = verdicts.collect();
    for block in 0..grid.blocks() {
        // Lines from the cut to a lower block of columns would cross the columns above it, so
        // lower columns have only numbers.
        let heads = bottom
            + if grid.blocks() == 1 && style.scene {
                LEADERS
            } else {
                14.0
            };
        for (column, middle, room) in grid.columns(block) {
            if grid.blocks() == 1 && style.scene {
                cut.leader(&mut svg, column, [middle, heads]);
            }
            cut.heading(&mut svg, column, [middle, heads], room);
        }
        let rooms = grid.columns(block).map(|(column, _, room)| (column, room));
        bottom = grid.draw(&mut svg, block, heads + cut.heading_height(rooms))?;
        bottom = feet(&mut svg, &verdicts, &grid, block, bottom);
    }
    let bottom = keys(&mut svg, strip, &grid, [LEFT + inner, bottom], style);
    Ok(Figure {
        svg: svg.finish(LEFT + inner + RIGHT, bottom + 14.0),
        csv: numbers(strip)?,
        pictures: pictures(strip),
    })
}

/// Returns the numbers of the pictures.
fn pictures(strip: &Strip<'_>) -> Vec<DrawnPicture> {
    let both = || strip.columns.iter().zip(&strip.section.planes);
    let row = |row: StripRow| {
        let quantity = row.quantity(strip);
        both().map(move |(column, plane)| {
            row.picture(column)
                .numbers(row.name(), &plane.name, &quantity)
        })
    };
    StripRow::of(strip).into_iter().flat_map(row).collect()
}

/// Lays out the pictures below the cut.
fn grid<'b, 'a>(strip: &'b Strip<'a>, style: &Style) -> PageGrid<'b, 'a> {
    let row = |row: StripRow| {
        let cell = |column: &'b StripColumn<'a>| {
            let guides = match row {
                StripRow::Spectrum | StripRow::Predicted => &column.guides[..],
                StripRow::AcrossSpectrum => {
                    let across = column.across.as_ref();
                    across.map_or(&[][..], |across| &across.guides)
                }
                _ => &[],
            };
            (row.drawn(column), guides)
        };
        crate::grid::PictureRow {
            name: row.name(),
            bar: if row == StripRow::OffChain {
                ["|*S* − chain|".to_owned(), "% of the peak".to_owned()]
            } else {
                [OWN_PEAK.to_owned(), String::new()]
            },
            scale: match row {
                StripRow::LightField | StripRow::Across | StripRow::OffChain => Scale::Linear,
                _ => Scale::Decibel { floor: strip.floor },
            },
            shared: row == StripRow::OffChain,
            cells: strip.columns.iter().map(cell).collect(),
        }
    };
    let rows = StripRow::of(strip).into_iter().map(row).collect();
    // Two keys fit side by side on the narrowest page.
    let half = 0.5 * (inner(style) - GAPS[1]);
    PageGrid::new(
        rows,
        strip.columns.len(),
        [MIN_WIDTH.min(half), f64::INFINITY],
        style,
    )
}

/// Draws the keys of predicted lines and of cells without a value; returns the lowest baseline.
fn keys(
    svg: &mut Svg,
    strip: &Strip<'_>,
    grid: &PageGrid<'_, '_>,
    [right, bottom]: [f64; 2],
    style: &Style,
) -> f64 {
    let guided = strip.columns.iter().any(|column| !column.guides.is_empty());
    let gaps = grid.has_gaps();
    let y = bottom + if guided || gaps { 18.0 } else { 0.0 };
    if guided {
        guide_keys(svg, strip, [LEFT, y], style);
    }
    if gaps {
        bar::gap_key(svg, right, y);
    }
    y
}

/// Draws the key of the dashed lines over spectra. If the lines in the plane of incidence and
/// perpendicular to it differ, the key distinguishes the two.
fn guide_keys(svg: &mut Svg, strip: &Strip<'_>, [x, y]: [f64; 2], style: &Style) {
    let mut guides = strip.columns.iter().flat_map(|column| &column.guides);
    let names: &[&str] = if guides.any(|guide| guide.is_across) {
        &["shear in the plane of incidence", "across it"]
    } else {
        &["predicted shear"]
    };
    let mut swatch = Area {
        x,
        y: y - 10.0,
        width: 34.0,
        height: 12.0,
    };
    for (name, is_across) in names.iter().zip([false, true]) {
        svg.fill(swatch, &hex(Colors::Sequential(style.palette).at(0.0)));
        for [from, to] in ends([swatch.x, y - 4.0], [swatch.right(), y - 4.0], 9.0) {
            for stroke in guide_strokes(is_across) {
                svg.line(from, to, stroke);
            }
        }
        let at = [swatch.right() + 7.0, y];
        svg.text(
            TextStyle::new(at, TICK_TEXT, Anchor::Start).fill(SOFT),
            name,
        );
        swatch.x = at[0] + width(name, TICK_TEXT) + 20.0;
    }
}

/// Returns the table of a strip, with a row for each cell of each picture. In the table, pictures
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
    for (index, column) in strip.columns.iter().enumerate() {
        let (name, distance) = match strip.section.planes.get(index) {
            Some(plane) => (plane.name.clone(), decimal(&plane.distance)),
            None => ((index + 1).to_string(), String::new()),
        };
        for row in StripRow::of(strip) {
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
