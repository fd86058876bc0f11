//! A plane with its results, and pictures of both.

use super::DECIBEL;
use super::words::{
    across_axes, full_radial_axes, full_radial_quantity, light_field_axes, light_field_quantity,
    spectrum_axes, spectrum_quantity,
};
use etendue_compare::PlaneComparison;
use etendue_field::VirtualPlane;
use etendue_figures::{Picture, PlateRow, Scale};
use ndarray::ArrayView2;

/// A plane of a scene with its results.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// The plane.
    pub plane: &'a VirtualPlane,
    /// Its results.
    pub found: &'a PlaneComparison,
}

impl<'a> Seen<'a> {
    /// The measured light field in (x, u).
    pub fn light_field(&self) -> Picture<'a> {
        let field = &self.found.projection.mean;
        Picture::new(
            light_field_axes(self.plane, &field.grid),
            field.values.view(),
        )
    }

    /// A light field in (y, v) in cells that fill the same half-widths.
    pub fn across<'b>(&self, values: ArrayView2<'b, f64>) -> Picture<'b> {
        Picture::new(
            across_axes(self.plane, &self.found.projection.mean.grid),
            values,
        )
    }

    /// A spectrum at the frequencies of the plane.
    pub fn spectrum<'b>(&self, values: ArrayView2<'b, f64>) -> Picture<'b> {
        Picture::new(spectrum_axes(self.plane), values)
    }

    /// The full radial spectrum, measured and predicted, if there is one.
    fn full_radial(&self) -> Option<[Picture<'a>; 2]> {
        let full = self.found.full_radial.as_ref()?;
        let axes = || full_radial_axes(self.plane, &full.measured);
        Some(
            [&full.measured.power, &full.predicted].map(|power| Picture::new(axes(), power.view())),
        )
    }
}

/// A row of light fields.
pub fn light_fields<'a>(
    name: &'a str,
    shared: bool,
    pictures: impl Iterator<Item = Picture<'a>>,
) -> PlateRow<'a> {
    let pictures = pictures.collect();
    PlateRow::new(
        name,
        light_field_quantity(),
        Scale::Linear,
        shared,
        pictures,
    )
}

/// A row of spectra.
pub fn spectra<'a>(
    name: &'a str,
    shared: bool,
    pictures: impl Iterator<Item = Picture<'a>>,
) -> PlateRow<'a> {
    PlateRow::new(
        name,
        spectrum_quantity(),
        DECIBEL,
        shared,
        pictures.collect(),
    )
}

/// The rows of full radial spectra, measured and predicted, if each plane has such a
/// spectrum.
pub fn full_radials<'a>(
    seen: impl Iterator<Item = Seen<'a>>,
    shared: bool,
) -> Option<[PlateRow<'a>; 2]> {
    let each: Option<Vec<_>> = seen.map(|seen| seen.full_radial()).collect();
    let (measured, predicted) = each?.into_iter().map(Into::into).unzip();
    let row =
        |name, pictures| PlateRow::new(name, full_radial_quantity(), DECIBEL, shared, pictures);
    Some([row("full radial", measured), row("prediction", predicted)])
}
