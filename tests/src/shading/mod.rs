//! Shading: what cosines, BRDFs, textures and environments do to spectra, against plain quadrature and traced rays, in 2D.

mod bandwidth;
mod blockers;
mod brdfs;
mod errata;
mod eye;
mod factors;
mod glossy;
mod light;
mod operators;
mod primal;
mod spreading;
mod traced;
mod words;

pub(crate) use glossy::glossy;

use crate::report::Section;

/// All sections. Those in 2D need no photons; the others have those of their files, or `photons` for each scene.
pub(crate) fn shading(photons: Option<u64>) -> Vec<Section> {
    let mut sections = vec![
        operators::operators(),
        traced::traced(),
        errata::errata(),
        words::words(),
        bandwidth::bandwidths(),
    ];
    sections.extend(with_photons(photons));
    sections
}

/// Sections that trace photons.
fn with_photons(photons: Option<u64>) -> Vec<Section> {
    vec![glossy(photons).0]
}

fn verdict(well: bool) -> String {
    if well { "pass" } else { "FAIL" }.to_owned()
}

fn small(x: f64) -> String {
    format!("{x:.1e}")
}
