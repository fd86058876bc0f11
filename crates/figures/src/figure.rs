//! Writes a figure as SVG, PNG, PDF and CSV.

use crate::raster::encoded;
use crate::sizes::INCH;
use crate::svg::Svg;
use krilla::Document;
use krilla::geom::Size;
use krilla::page::PageSettings;
use krilla_svg::{SurfaceExt, SvgSettings};
use ndarray::Array2;
use resvg::{tiny_skia, usvg};
use std::sync::Arc;

/// Pixels of the PNG per unit of the SVG.
const PNG_SCALE: f32 = 2.0;

/// A drawing with the numbers that it shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The drawing as SVG. Texts are stored as text, and heat maps are embedded PNGs with one pixel
    /// per cell.
    pub svg: String,
    /// The numbers that the drawing shows, as CSV. A header states names and units, and a row for
    /// each cell or line follows.
    pub csv: String,
    /// The pictures in a plate or a strip, row by row.
    pub pictures: Vec<DrawnPicture>,
}

/// The numbers of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnPicture {
    /// The name of the picture's row, or the name of its quantity if the row has no name.
    pub row: String,
    /// The heading of the picture's column.
    pub column: String,
    /// The unit of the values.
    pub unit: String,
    /// The name and unit of each axis, and the centres of its cells.
    pub axes: [(String, Vec<f64>); 2],
    /// The values, [x, y].
    pub values: Array2<f64>,
    /// The standard error of each value, if it is known.
    pub sigma: Option<Array2<f64>>,
}

/// The reason why a figure could not be made. The reason lies in the drawing of the figure, not in
/// the values that the figure shows.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The SVG of the drawing could not be read back.
    #[error("the figure's SVG cannot be rasterized: {0}")]
    Svg(#[from] usvg::Error),
    /// A heat map or the raster could not be written.
    #[error("an image cannot be written as PNG: {0}")]
    Image(#[from] png::EncodingError),
    /// The PNG would have no pixels or too many pixels.
    #[error("a figure of {0} × {1} pixels cannot be drawn")]
    Size(u32, u32),
    /// The PDF page could not be written.
    #[error("the figure cannot be written as PDF: {0}")]
    Page(String),
    /// The CSV of the numbers could not be written.
    #[error("the figure's numbers cannot be written as CSV: {0}")]
    Csv(String),
}

impl Figure {
    /// A drawing without pictures.
    pub(crate) fn new(svg: String, csv: String) -> Self {
        let pictures = Vec::new();
        Self { svg, csv, pictures }
    }

    /// The width and the height of the drawing, in SVG units of 1/96 inch.
    #[must_use]
    pub fn size(&self) -> [f64; 2] {
        svg_size(&self.svg)
    }

    /// The drawing as a PNG, with two pixels to an SVG unit and with text in DejaVu Sans.
    /// The PNG states its resolution, 192 pixels per inch.
    ///
    /// # Errors
    /// If the SVG cannot be read back or the raster cannot be written.
    pub fn png(&self) -> Result<Vec<u8>, Error> {
        let tree = usvg::Tree::from_str(&self.svg, &options())?;
        let size = tree
            .size()
            .to_int_size()
            .scale_by(PNG_SCALE)
            .unwrap_or_else(|| tree.size().to_int_size());
        let (width, height) = (size.width(), size.height());
        let mut pixels = tiny_skia::Pixmap::new(width, height).ok_or(Error::Size(width, height))?;
        let scale = tiny_skia::Transform::from_scale(PNG_SCALE, PNG_SCALE);
        resvg::render(&tree, scale, &mut pixels.as_mut());
        let per_inch = f64::from(PNG_SCALE) * INCH;
        let pixels = pixels.take_demultiplied();
        let color = png::ColorType::Rgba;
        Ok(encoded([width, height], color, Some(per_inch), &pixels)?)
    }
}

/// Maximum page width in points: the text width of two columns, 7 inches.
const PAGE: f32 = 504.0;
/// Points per SVG unit.
const POINT: f32 = 0.75;

impl Figure {
    /// The drawing as a PDF page at natural size, at most as wide as two columns of a
    /// journal. Texts on the page are stored as text.
    ///
    /// # Errors
    /// If the SVG cannot be read back or the page cannot be written.
    pub fn pdf(&self) -> Result<Vec<u8>, Error> {
        let tree = usvg::Tree::from_str(&self.svg, &options())?;
        let [width, height] = [tree.size().width(), tree.size().height()];
        let scale = POINT.min(PAGE / width);
        let too_large = || Error::Page(format!("a page of {width} × {height} units"));
        let page = Size::from_wh(scale * width, scale * height).ok_or_else(too_large)?;
        let mut document = Document::new();
        let mut sheet = document.start_page_with(PageSettings::new(page));
        let mut surface = sheet.surface();
        let drawn = surface.draw_svg(&tree, page, SvgSettings::default());
        surface.finish();
        sheet.finish();
        drawn.ok_or_else(|| Error::Page("the drawing cannot be converted to PDF".to_owned()))?;
        document
            .finish()
            .map_err(|error| Error::Page(format!("{error:?}")))
    }
}

/// The width and the height of a drawing of this crate, in SVG units of 1/96 inch.
#[must_use]
pub fn svg_size(svg: &str) -> [f64; 2] {
    ["width", "height"].map(|name| {
        let after = svg.split_once(&format!(" {name}=\""));
        let text = after.and_then(|(_, rest)| rest.split('"').next());
        text.and_then(|text| text.parse().ok()).unwrap_or(0.0)
    })
}

/// Stacks figures on one page, and joins their tables and pictures.
#[must_use]
pub fn stacked(figures: &[Figure]) -> Figure {
    let mut svg = Svg::default();
    let mut y = 0.0;
    for figure in figures {
        svg.raw(&figure.svg.replacen("<svg", &format!("<svg y=\"{y}\""), 1));
        y += figure.size()[1];
    }
    let width = figures.iter().map(|figure| figure.size()[0]);
    let tables = figures.iter().map(|figure| figure.csv.as_str());
    let tables: Vec<&str> = tables.filter(|table| !table.is_empty()).collect();
    Figure {
        svg: svg.finish(width.fold(0.0, f64::max), y),
        csv: tables.join("\n"),
        pictures: figures.iter().flat_map(|f| f.pictures.clone()).collect(),
    }
}

/// SVG reading options that use only the built-in fonts.
pub(crate) fn options() -> usvg::Options<'static> {
    let mut fonts = usvg::fontdb::Database::new();
    for face in [
        dejavu::sans::regular(),
        dejavu::sans::bold(),
        dejavu::sans::oblique(),
        dejavu::sans::bold_oblique(),
    ] {
        fonts.load_font_source(usvg::fontdb::Source::Binary(Arc::new(face)));
    }
    usvg::Options {
        font_family: "DejaVu Sans".to_owned(),
        fontdb: Arc::new(fonts),
        ..usvg::Options::default()
    }
}

/// The CSV text of a header and of rows of the same length.
///
/// # Errors
/// If a row has another length.
pub fn csv_text(
    header: &[String],
    rows: impl IntoIterator<Item = Vec<String>>,
) -> Result<String, Error> {
    let fault = |error: csv::Error| Error::Csv(error.to_string());
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header).map_err(fault)?;
    for row in rows {
        writer.write_record(row).map_err(fault)?;
    }
    let bytes = writer.into_inner();
    let bytes = bytes.map_err(|error| Error::Csv(error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| Error::Csv(error.to_string()))
}

/// A number as text, with as many digits as are needed to read the number back exactly.
pub(crate) fn decimal(value: &f64) -> String {
    format!("{value:?}")
}
