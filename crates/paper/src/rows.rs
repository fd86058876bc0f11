//! Collects the pictures of the planes of a figure's scenes, row by row.

use etendue_field::{Complex, Slices};
use etendue_figures::{CurvePanel, PlateRow};
use etendue_report::pictures::{Seen, full_radials, light_fields, spectra, verdict_lines};
use ndarray::{Array2, Axis as Along};

/// The phase is not shown where the power is below this share of the largest power.
pub(crate) const MIN_POWER: f64 = 1e-5;

/// The power, or the phase, of the slice of a spectrum at azimuth 0, [ρ, ν].
pub(crate) fn slice(slices: &Slices, of: &dyn Fn(Complex, f64) -> f64) -> Array2<f64> {
    let full = slices.full();
    let slice = full.index_axis(Along(0), 0);
    let most = slice.iter().map(|s| s.norm_sqr()).fold(0.0, f64::max);
    slice.map(|s| of(*s, most))
}

pub(crate) fn power(slices: &Slices) -> Array2<f64> {
    slice(slices, &|s, _| s.norm_sqr())
}

/// The phase in degrees.
pub(crate) fn phase(slices: &Slices) -> Array2<f64> {
    slice(slices, &|s, most| {
        if s.norm_sqr() > MIN_POWER * most {
            libm::atan2(s.im, s.re).to_degrees()
        } else {
            f64::NAN
        }
    })
}

/// A row of the measured light fields of some planes.
pub(crate) fn fields<'a>(name: &'a str, seen: &[Seen<'a>], shared: bool) -> PlateRow<'a> {
    light_fields(name, shared, seen.iter().map(Seen::light_field))
}

/// A row of the measured spectra of some planes.
pub(crate) fn measured<'a>(name: &'a str, seen: &[Seen<'a>], shared: bool) -> PlateRow<'a> {
    let each = seen.iter();
    let power = each.map(|seen| seen.spectrum(seen.found.radial.power.view()));
    spectra(name, shared, power)
}

/// The light fields and the measured and predicted spectra of some planes, and their full
/// radial spectra if there are any.
pub(crate) fn compared<'a>(seen: &[Seen<'a>], shared: bool) -> Vec<PlateRow<'a>> {
    let predicted = seen
        .iter()
        .map(|seen| seen.spectrum(seen.found.predicted_radial.view()));
    let mut rows = vec![
        fields("light field", seen, shared),
        measured("measured", seen, shared),
        spectra("predicted", shared, predicted),
    ];
    rows.extend(
        full_radials(seen.iter().copied(), shared)
            .into_iter()
            .flatten(),
    );
    rows
}

/// The headings with letters, beginning with (a).
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
