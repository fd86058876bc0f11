//! A second implementation of the code that theory and both tracers share. It also implements the
//! BRDFs, which theory and the tracers implement separately.
//!
//! A comparison of photons with theory cannot reveal a mistake in code that the tracers and theory
//! share. Therefore this module implements every shared function again, in a slow and plain way. It
//! follows only the documentation: docs/scenes.md, docs/conventions.md, docs/theory.md, and the
//! cited literature. The second implementation never calls the fast code, and shares only the plain
//! data that describes a scene. If a function depends on how scene files are read, its test writes
//! a scene file and reads it. Faults are planted in the second implementation, and the comparison
//! must detect each of them.

mod brdf;
mod check;
mod files;
mod lights;
mod lobes;
mod maps;
mod masks;
mod meshes;
mod paths;
mod pattern;
mod plain;
mod sky;
mod smooth;
mod surfaces;
mod textures;
mod vector;
mod views;
mod world;

pub(crate) use plain::{PlainOptions, plain};

use crate::hostile::dice::Dice;
use crate::report::{self, ReportSection, Row};
use check::SecondCheck;
use std::io;
use std::rc::Rc;

/// The seed of all random points. This seed was fixed in advance, and not chosen by the results
/// that it gives.
const SEED: u64 = 1;

/// Compares every shared function with its second implementation.
pub(crate) fn second() -> io::Result<ReportSection> {
    let checks = checks()?;
    let named = checks.iter().all(|check| !check.faults.is_empty());
    Ok(ReportSection::new(
        "Second implementation",
        format!(
            "Theory and the tracers share some functions, and each has its own BRDFs. All of these \
             are compared with a second implementation from their definitions, at random points \
             (seed {SEED}). Required: the largest difference is within the tolerance, and it is \
             beyond the tolerance with each planted fault."
        ),
        "function | points | largest difference | tolerance | planted fault | difference with this \
         fault | verdict",
        checks.iter().flat_map(rows),
    )
    .with_checks(vec![report::Check::fact(
        "faults",
        named,
        "every row needs a fault",
    )]))
}

fn checks() -> io::Result<Vec<SecondCheck>> {
    let folder = Rc::new(tempfile::tempdir()?);
    // Pictures use the random numbers of the largest case number, because points use case numbers
    // from 0 upwards.
    let mut dice = Dice::new(SEED, u64::MAX);
    let picture = files::write_picture(folder.path(), &mut dice)?;
    let map = files::write_map(&folder.path().join(sky::FILE), &mut dice)?;
    let all = [
        lobes::checks(),
        textures::checks(),
        files::checks(&folder, &picture),
        lights::checks(),
        sky::checks(&folder, &map),
        masks::checks(),
        surfaces::checks(),
        meshes::checks(),
        paths::checks(),
        views::checks(),
        maps::checks(),
    ];
    Ok(all.into_iter().flatten().collect())
}

/// One table row for each planted fault.
fn rows(check: &SecondCheck) -> Vec<Row> {
    let outcome = check.run();
    let (tolerance, reason) = check.tolerance;
    let planted = check.faults.iter().zip(&outcome.planted);
    let rows = planted.map(|(fault, off)| {
        let cells = vec![
            check.name.to_owned(),
            check.points().to_string(),
            format!("{:.1e}", outcome.difference),
            format!("{tolerance:.0e}: {reason}"),
            (*fault).to_owned(),
            format!("{off:.1e}"),
        ];
        Row::new(cells, check.required(outcome.difference, *off))
    });
    rows.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shared_functions_are_as_defined_and_planted_faults_are_seen() {
        let section = second().unwrap();
        assert!(section.passes(), "{}", section.markdown());
    }
}
