//! `--save`: the photons that crossed a plane, in batch order, or the batches of the measurement.

mod file;

use crate::measure::MeasuredScene;
use crate::method::source;
use etendue_field::{Crossing, PhotonSource, VirtualPlane};
use etendue_store::sealed::json;
use etendue_store::{Failure, Results, batches, theory};
use file::{Content, Rays};
use serde::Serialize;
use std::io;

/// Data that a run saves in addition to its result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Save {
    /// Every photon that crossed a plane, in coordinates of the plane.
    Photons,
    /// The photons that crossed a plane, as rays in world coordinates, in MCPL.
    Mcpl,
    /// The photons that crossed a plane, as rays in world coordinates, in IES TM-25.
    Tm25,
    /// The light field on a 4D grid, and its full radial spectrum.
    Field,
    /// The slices of each batch, and the predictions with their derivatives.
    Batches,
    /// The interactive page of the scene.
    Explorer,
}

impl Save {
    /// The name of the data in commands.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Photons => "photons",
            Self::Mcpl => "mcpl",
            Self::Tm25 => "tm25",
            Self::Field => "field",
            Self::Batches => "batches",
            Self::Explorer => "explorer",
        }
    }
}

/// The index of a plane's NPY file.
const INDEX: &str = "photons.json";

/// The file names of a plane, apart from those in [`of_scene`].
pub fn names(save: Save) -> Vec<&'static str> {
    let index = (save == Save::Photons).then_some(INDEX);
    let name = file_of(save).map(|(name, _)| name);
    name.into_iter().chain(index).collect()
}

/// The names of the files of all planes together.
pub fn of_scene(save: Save, planes: &[VirtualPlane]) -> Vec<String> {
    if save != Save::Batches {
        return Vec::new();
    }
    let mut names = batches::names(planes);
    names.push(theory::FILE.to_owned());
    names
}

/// Describes the file with the photons of a plane: returns its name, and its number of bytes per
/// photon.
#[must_use]
pub fn file_of(save: Save) -> Option<(&'static str, u64)> {
    match save {
        Save::Photons => Some(("photons.npy", 40)),
        Save::Mcpl => Some(("photons.mcpl", 64)),
        Save::Tm25 => Some(("photons.tm25ray", 28)),
        Save::Field | Save::Batches | Save::Explorer => None,
    }
}

/// The content of `photons.json`.
#[derive(Serialize)]
struct PhotonsIndex {
    columns: [&'static str; 5],
    /// First row of each batch, followed by the total number of rows.
    batch_offsets: Vec<u64>,
    /// Number of photons emitted in each batch.
    emitted: Vec<u64>,
}

/// Traces the same photons again, plane by plane, and streams them to disk, so that memory holds
/// only one block of photons. A TM-25 file begins with the flux of the photons, so the photons
/// are traced once more to compute this flux. Batches are not traced again.
pub fn save(results: &mut Results, case: &MeasuredScene, save: Save) -> Result<(), Failure> {
    if save == Save::Batches {
        batches::write(results, &case.measurement)?;
        let predicted = theory::bytes(&case.scene.planes, &case.predictions)?;
        return results.write(theory::FILE, &predicted);
    }
    let Some((name, _)) = file_of(save) else {
        return Ok(());
    };
    let source = source(&case.scene, case.method)?;
    for (plane, at) in case.scene.planes.iter().enumerate() {
        let rows = case.measurement.tally(plane).crossed;
        let name = format!("{}/{name}", at.name);
        let Some(rays) = Rays::of(case, plane) else {
            continue;
        };
        let mut offsets = Vec::new();
        results.stream(&name, &mut |file| {
            let mut content = match save {
                Save::Mcpl => Content::mcpl(&rays, rows),
                Save::Tm25 => {
                    // The header states the flux of all rays, which takes a trace of its own.
                    let mut flux = 0.0;
                    trace(case, &*source, plane, &mut |crossings| {
                        flux += crossings.iter().map(|c| rays.watts(c)).sum::<f64>();
                        Ok(())
                    })?;
                    Content::tm25(&rays, rows, flux)
                }
                _ => Content::Npy(rows),
            };
            file.write_all(&content.begin())?;
            offsets = trace(case, &*source, plane, &mut |crossings| {
                file.write_all(&content.rows(crossings)?)
            })?;
            Ok(())
        })?;
        if save == Save::Photons {
            let index = PhotonsIndex {
                columns: ["x", "y", "u", "v", "weight"],
                batch_offsets: offsets,
                emitted: case.measurement.batches().map(|b| b.emitted).collect(),
            };
            results.write(&format!("{}/{INDEX}", at.name), &json(&index))?;
        }
    }
    Ok(())
}

/// Calls `take` with the photons that cross a plane, block by block in the order of batches. Returns
/// the number of photons before each batch, and the total.
fn trace(
    case: &MeasuredScene,
    source: &dyn PhotonSource,
    plane: usize,
    take: &mut dyn FnMut(&[Crossing]) -> io::Result<()>,
) -> io::Result<Vec<u64>> {
    let mut offsets = vec![0];
    let mut done = 0;
    for batch in case.measurement.batches() {
        let mut outcome = Ok(());
        let mut record = |at: usize, crossings: &[Crossing]| {
            if at == plane && outcome.is_ok() {
                done += crossings.len() as u64;
                outcome = take(crossings);
            }
        };
        source.emit(batch.index, &mut record, &|_| ());
        outcome?;
        offsets.push(done);
    }
    Ok(offsets)
}
