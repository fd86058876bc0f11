//! Fig. 11: a beam on a hollow mirror, at normal and at oblique incidence.

use crate::rows::{feet, measured};
use crate::subject::FigureData;
use etendue_figures::{Figure, Plate, stacked};
use etendue_report::pictures::Seen;
use etendue_report::table::spaced;
use etendue_store::Failure;

/// Draws Fig. 11: the steps at normal incidence, and below them spectra at 40°.
pub(crate) fn caustic(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let normal = taken.strip()?;
    let seen: Vec<Seen<'_>> = taken.shots[1].all().collect();
    let name = |seen: &Seen<'_>| spaced(&seen.plane.name);
    let oblique = taken.plate(&Plate {
        title: "The same mirror at an incidence of 40°",
        note: "Measured. Two foci, in and across the plane of incidence: no plane has all its light on *ν* = 0.",
        heads: seen.iter().map(name).collect(),
        rows: vec![measured("spectrum", &seen, false)],
        feet: feet(&seen),
        ..Plate::default()
    })?;
    Ok(stacked(&[normal, oblique]))
}
