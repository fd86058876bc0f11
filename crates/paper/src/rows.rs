//! Collects the pictures of the planes of a figure's scenes, row by row.

use crate::scene_run::Shot;
use etendue_compare::PlaneComparison;
use etendue_field::{Complex, Slices, VirtualPlane};
use etendue_figures::{AxisQuantity, CurvePanel, Picture, PlateRow, Scale};
use etendue_report::pictures::{
    full_radial, full_radial_quantity, light_field_axes, light_field_quantity, spectrum_axes,
    spectrum_quantity, verdict_lines,
};
use etendue_store::Failure;
use ndarray::{Array2, ArrayView2, Axis as Along};

/// Lowest level of a spectrum's colors, in decibels below its peak.
pub(crate) const DECIBEL: Scale = Scale::Decibel { floor: -50.0 };
/// The phase is not shown where the power is below this share of the largest power.
pub(crate) const MIN_POWER: f64 = 1e-5;

/// A plane of a scene with its results.
#[derive(Clone, Copy)]
pub(crate) struct Seen<'a> {
    pub(crate) plane: &'a VirtualPlane,
    pub(crate) found: &'a PlaneComparison,
}

impl<'a> Seen<'a> {
    pub(crate) fn all(shot: &'a Shot) -> impl Iterator<Item = Self> {
        let both = shot.scene.planes.iter().zip(&shot.planes);
        both.map(|(plane, found)| Self { plane, found })
    }

    /// Returns the plane with the given name.
    pub(crate) fn at(shot: &'a Shot, name: &str) -> Result<Self, Failure> {
        let missing = || Failure::cannot_run(format!("{} has no plane {name}", shot.scene.name));
        Self::all(shot)
            .find(|seen| seen.plane.name == name)
            .ok_or_else(missing)
    }

    pub(crate) fn light_field(&self) -> Picture<'a> {
        let values = self.found.projection.mean.values.view();
        let [x, y] = light_field_axes(self.plane, &self.found.projection.mean.grid);
        Picture { x, y, values }
    }

    pub(crate) fn spectrum<'b>(&self, values: ArrayView2<'b, f64>) -> Picture<'b> {
        let [x, y] = spectrum_axes(self.plane);
        Picture { x, y, values }
    }
}

/// Returns the power, or the phase, of the slice of a spectrum at azimuth 0, [ρ, ν].
pub(crate) fn slice(slices: &Slices, of: &dyn Fn(Complex, f64) -> f64) -> Array2<f64> {
    let full = slices.full();
    let slice = full.index_axis(Along(0), 0);
    let most = slice.iter().map(|s| s.norm_sqr()).fold(0.0, f64::max);
    slice.map(|s| of(*s, most))
}

pub(crate) fn power(slices: &Slices) -> Array2<f64> {
    slice(slices, &|s, _| s.norm_sqr())
}

/// Returns the phase in degrees.
pub(crate) fn phase(slices: &Slices) -> Array2<f64> {
    slice(slices, &|s, most| {
        if s.norm_sqr() > MIN_POWER * most {
            libm::atan2(s.im, s.re).to_degrees()
        } else {
            f64::NAN
        }
    })
}

pub(crate) fn row<'a>(
    name: &'a str,
    quantity: AxisQuantity,
    scale: Scale,
    shared: bool,
    pictures: Vec<Picture<'a>>,
) -> PlateRow<'a> {
    PlateRow {
        name,
        quantity,
        scale,
        shared,
        pictures,
    }
}

/// Returns the light fields and the measured and predicted spectra of some planes, and their full
/// radial spectra if there are any.
pub(crate) fn compared<'a>(seen: &[Seen<'a>], shared: bool) -> Vec<PlateRow<'a>> {
    let pictures = |of: &dyn Fn(&Seen<'a>) -> Picture<'a>| seen.iter().map(of).collect();
    let measured = pictures(&|seen| seen.spectrum(seen.found.radial.power.view()));
    let predicted = pictures(&|seen| seen.spectrum(seen.found.predicted_radial.view()));
    let spectra = |name, pictures| row(name, spectrum_quantity(), DECIBEL, shared, pictures);
    let mut rows = vec![
        row(
            "light field",
            light_field_quantity(),
            Scale::Linear,
            shared,
            pictures(&Seen::light_field),
        ),
        spectra("measured", measured),
        spectra("predicted", predicted),
    ];
    let full = seen.iter().map(|seen| {
        let full = seen.found.full_radial.as_ref()?;
        Some(full_radial(seen.plane, full))
    });
    let full: Option<Vec<[Picture<'a>; 2]>> = full.collect();
    for (i, name) in ["full radial", "prediction"].into_iter().enumerate() {
        let Some(full) = &full else { break };
        let pictures = full.iter().map(|both| both[i].clone()).collect();
        rows.push(row(name, full_radial_quantity(), DECIBEL, shared, pictures));
    }
    rows
}

/// Returns the headings with letters, beginning with (a).
pub(crate) fn lettered(heads: &[&str]) -> Vec<String> {
    let letters = ('a'..='z').zip(heads);
    letters
        .map(|(letter, head)| format!("({letter}) {head}"))
        .collect()
}

/// Puts letters before the titles of panels, beginning with `first`.
pub(crate) fn letter_panels(first: char, panels: &mut [CurvePanel]) {
    for (letter, panel) in (first..='z').zip(panels) {
        panel.title = format!("({letter}) {}", panel.title);
    }
}

pub(crate) fn feet(seen: &[Seen<'_>]) -> Vec<Vec<String>> {
    seen.iter().map(|seen| verdict_lines(seen.found)).collect()
}
