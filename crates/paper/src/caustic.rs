//! Fig. 11: a beam on a hollow mirror, at normal and at oblique incidence.

use crate::rows::{DECIBEL, Seen, feet, row};
use crate::subject::FigureData;
use etendue_figures::{Figure, Plate, stacked};
use etendue_report::pictures::spectrum_quantity;
use etendue_report::table::spaced;
use etendue_store::Failure;

/// Draws Fig. 11: the steps at normal incidence, and below them spectra at 40°.
pub(crate) fn caustic(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let normal = taken.strip()?;
    let seen: Vec<Seen<'_>> = Seen::all(&taken.shots[1]).collect();
    let power = seen
        .iter()
        .map(|seen| seen.spectrum(seen.found.radial.power.view()));
    let spectra = row(
        "spectrum",
        spectrum_quantity(),
        DECIBEL,
        false,
        power.collect(),
    );
    let name = |seen: &Seen<'_>| spaced(&seen.plane.name);
    let oblique = taken.plate(&Plate {
        title: "The same mirror at an incidence of 40°",
        note: "Measured. Two foci, in and across the plane of incidence: no plane has all its light on *ν* = 0.",
        heads: seen.iter().map(name).collect(),
        rows: vec![spectra],
        feet: feet(&seen),
        bars: None,
        side: None,
    })?;
    Ok(stacked(&[normal, oblique]))
}
