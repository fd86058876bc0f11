//! Defines pictures and rows of pictures, with the lines over them.

use crate::axis::{Axis, AxisQuantity};
use crate::color::{Colors, Scale, Shading};
use crate::figure::{DrawnPicture, decimal};
use crate::style::Style;
use crate::text::plain;
use ndarray::ArrayView2;

/// Values on a grid [x, y], with both axes ascending. A cell without a value is NaN.
#[derive(Clone, Debug)]
pub struct Picture<'a> {
    /// The axis of the array's first index.
    pub x: Axis,
    /// The axis of the array's second index.
    pub y: Axis,
    /// The values, which tables have.
    pub values: ArrayView2<'a, f64>,
    /// The values in finer cells over the same axes, which are drawn instead of `values`.
    pub finer: Option<ArrayView2<'a, f64>>,
    /// Predicted lines. Only their ends are drawn, at the edges of the picture.
    pub guides: Vec<Guide>,
}

impl<'a> Picture<'a> {
    /// The picture of values, without lines over it.
    #[must_use]
    pub fn new([x, y]: [Axis; 2], values: ArrayView2<'a, f64>) -> Self {
        Self {
            x,
            y,
            values,
            finer: None,
            guides: Vec::new(),
        }
    }

    /// The values that are drawn.
    pub(crate) fn drawn(&self) -> ArrayView2<'a, f64> {
        self.finer.unwrap_or(self.values)
    }

    /// The table headings of both axes.
    pub(crate) fn headings(&self) -> [String; 2] {
        [&self.x, &self.y].map(|axis| axis.quantity.heading())
    }

    /// The centre and the value of each cell as text, with x varying slowest.
    pub(crate) fn cells(&self) -> Vec<[String; 3]> {
        let (columns, rows) = self.values.dim();
        let cell = |((i, j), value): ((usize, usize), &f64)| {
            let at = [self.x.center(i, columns), self.y.center(j, rows)];
            [at[0], at[1], *value].map(|number| decimal(&number))
        };
        self.values.indexed_iter().map(cell).collect()
    }

    /// The ratio of the picture's height to its width. The ratio is 1 unless both axes
    /// count pixels, which are drawn square.
    pub(crate) fn shape(&self) -> f64 {
        let (columns, rows) = self.values.dim();
        match self.counts_pixels() {
            true => rows as f64 / columns as f64,
            false => 1.0,
        }
    }

    /// Checks whether both axes count pixels.
    fn counts_pixels(&self) -> bool {
        let counts_pixels = |axis: &Axis| axis.quantity.unit == "pixels";
        counts_pixels(&self.x) && counts_pixels(&self.y)
    }

    /// The numbers of this picture, which shows `of` in a row and a column.
    pub(crate) fn numbers(&self, row: &str, column: &str, of: &AxisQuantity) -> DrawnPicture {
        let (columns, rows) = self.values.dim();
        let axis = |axis: &Axis, count| {
            let centers = (0..count).map(|i| axis.center(i, count));
            (axis.quantity.heading(), centers.collect())
        };
        DrawnPicture {
            row: plain(if row.is_empty() { &of.name } else { row }),
            column: plain(column),
            unit: plain(&of.unit),
            axes: [axis(&self.x, columns), axis(&self.y, rows)],
            values: self.values.to_owned(),
            sigma: None,
        }
    }
}

/// The numbers of the pictures of rows whose columns have these names.
pub(crate) fn drawn_pictures<'b>(
    rows: &[PlateRow<'_>],
    columns: impl Iterator<Item = &'b String> + Clone,
) -> Vec<DrawnPicture> {
    let each = rows.iter().flat_map(|row| {
        let both = row.pictures.iter().zip(columns.clone());
        both.map(|(picture, column)| picture.numbers(row.name, column, &row.quantity))
    });
    each.collect()
}

/// A line over a spectrum, ν = ν₀ + slope · (ρ − ρ₀), along which theory predicts power. Only the
/// two ends of the line are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guide {
    /// The point (ρ₀, ν₀) of the line, which is the origin or the centre of a replica.
    pub through: [f64; 2],
    /// The slope dν/dρ in metres, which is −d for light that has travelled the distance d.
    pub slope: f64,
    /// Whether the line belongs to directions perpendicular to the plane of incidence.
    pub is_across: bool,
}

/// A row of pictures that share a color scale.
#[derive(Clone, Debug)]
pub struct PlateRow<'a> {
    /// Name of the row.
    pub name: &'a str,
    /// The quantity that the pictures show.
    pub quantity: AxisQuantity,
    /// Name of the quantity beside the colors, as markup, if it is not the name of the quantity.
    pub bar: Option<&'a str>,
    /// The mapping of values to colors.
    pub scale: Scale,
    /// Whether all pictures of the row have the same range of colors. If the range is not shared,
    /// the colors of each picture are relative to the largest value of that picture.
    pub shared: bool,
    /// A picture for each column.
    pub pictures: Vec<Picture<'a>>,
}

impl<'a> PlateRow<'a> {
    /// A row whose quantity has its own name beside the colors.
    #[must_use]
    pub fn new(
        name: &'a str,
        quantity: AxisQuantity,
        scale: Scale,
        shared: bool,
        pictures: Vec<Picture<'a>>,
    ) -> Self {
        Self {
            name,
            quantity,
            bar: None,
            scale,
            shared,
            pictures,
        }
    }

    /// Checks whether a picture of the row counts pixels along both axes.
    pub(crate) fn counts_pixels(&self) -> bool {
        self.pictures.iter().any(Picture::counts_pixels)
    }

    /// The quantity beside the colors.
    fn bar(&self) -> AxisQuantity {
        if self.shared {
            AxisQuantity::new(self.bar.unwrap_or(&self.quantity.name), &self.quantity.unit)
        } else {
            AxisQuantity::new("relative to its peak", "")
        }
    }

    /// Checks whether this row and another row share a color bar.
    pub(crate) fn has_bar_of(&self, other: &Self) -> bool {
        self.bar() == other.bar() && self.scale == other.scale && self.shared == other.shared
    }

    pub(crate) fn shading(&self, peak: f64, style: &Style) -> Shading {
        let scale = match (self.scale, style.floor) {
            (Scale::Decibel { .. }, Some(floor)) => Scale::Decibel { floor },
            (scale, _) => scale,
        };
        let bar = self.bar();
        scale.shading(Colors::Sequential(style.palette), &bar, peak, &bar.name)
    }
}
