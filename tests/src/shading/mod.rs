//! The effect of cosines, BRDFs, textures and environments on spectra. In 2D, theory is compared
//! with plain quadrature and traced rays; in 4D, with photons.

mod arriving;
mod bandwidth;
mod bench;
mod blockers;
mod brdfs;
mod chains;
mod errata;
mod eye;
mod factors;
mod glossy;
mod glossy_bench;
mod light;
mod misprints;
mod operators;
mod photons;
mod planar;
mod planted;
mod primal;
#[cfg(test)]
mod reference;
mod scenes;
mod semi;
mod semi_operator;
mod spreading;
pub(crate) mod strips;
mod tamper;
mod traced;
mod visibility;
mod words;

pub(crate) use glossy::glossy;

use crate::report::ReportSection;

/// All sections. Sections in 2D need no photons. The other sections trace `photons` photons
/// in each scene. If `photons` is `None`, they trace the number of photons in the scene's file.
pub(crate) fn shading(photons: Option<u64>) -> Vec<ReportSection> {
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

/// The sections that trace photons.
fn with_photons(photons: Option<u64>) -> Vec<ReportSection> {
    vec![
        photons::photons(photons),
        planted::planted(photons),
        semi::semi(photons),
        chains::chains(photons),
        misprints::misprints(photons),
    ]
}

fn small(x: f64) -> String {
    format!("{x:.1e}")
}
