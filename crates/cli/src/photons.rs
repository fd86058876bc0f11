//! `--save photons`: every photon that crossed a plane, in batch order.

use crate::case::Case;
use crate::failure::Failure;
use crate::method::source;
use crate::results::Results;
use crate::results::sealed::json;
use etendue_field::{Crossing, PhotonSource};
use etendue_scene::Scene;
use serde::Serialize;
use std::io::{self, Write};

/// The files of a plane.
pub(crate) const NAMES: [&str; 2] = ["photons.npy", "photons.json"];

/// `photons.json`.
#[derive(Serialize)]
struct Index {
    columns: [&'static str; 5],
    /// First row of each batch, and the number of rows at the end.
    batch_offsets: Vec<u64>,
    /// Photons emitted in each batch.
    emitted: Vec<u64>,
}

/// Bytes of a photon in the file: five numbers.
const ROW: u64 = 40;

/// How large the files will be at most: if every photon crosses every plane.
pub(crate) fn announcement(scene: &Scene) -> String {
    let planes = scene.planes.len();
    let each = ROW * scene.run.photons;
    let [all, each] = [each * planes as u64, each].map(size);
    format!("--save photons: at most {all} on disk, {each} for each of {planes} planes")
}

fn size(bytes: u64) -> String {
    let megabytes = bytes as f64 / 1e6;
    if megabytes < 1000.0 {
        format!("{megabytes:.1} MB")
    } else {
        format!("{:.1} GB", megabytes / 1000.0)
    }
}

/// Traces the photons again, one plane after the other, and streams them to disk: they are the same ones,
/// and memory holds a block of them.
pub(crate) fn save(results: &mut Results, case: &Case) -> Result<(), Failure> {
    let source = source(&case.scene, case.method)?;
    for (index, plane) in case.scene.planes.iter().enumerate() {
        let mut offsets = vec![0];
        let mut emitted = Vec::new();
        let rows = case.measurement.tally(index).crossed;
        results.stream(&format!("{}/photons.npy", plane.name), &mut |file| {
            file.write_all(&npy_header(rows))?;
            for batch in case.measurement.batches() {
                let written = write_batch(file, &*source, batch.index, index)?;
                offsets.push(offsets.last().copied().unwrap_or(0) + written);
                emitted.push(batch.emitted);
            }
            Ok(())
        })?;
        let index = Index {
            columns: ["x", "y", "u", "v", "weight"],
            batch_offsets: offsets,
            emitted,
        };
        results.write(&format!("{}/photons.json", plane.name), &json(&index))?;
    }
    Ok(())
}

fn write_batch(
    file: &mut dyn Write,
    source: &dyn PhotonSource,
    batch: u32,
    plane: usize,
) -> io::Result<u64> {
    let mut written = 0;
    let mut outcome = Ok(());
    let mut record = |at: usize, crossings: &[Crossing]| {
        if at == plane && outcome.is_ok() {
            written += crossings.len() as u64;
            outcome = file.write_all(&rows(crossings));
        }
    };
    source.emit(batch, &mut record, &|_| ());
    outcome.map(|()| written)
}

fn rows(crossings: &[Crossing]) -> Vec<u8> {
    crossings
        .iter()
        .flat_map(|c| [c.ray.x, c.ray.y, c.ray.u, c.ray.v, c.weight])
        .flat_map(f64::to_le_bytes)
        .collect()
}

/// Header of an NPY file, version 1.0, of f64 [rows, 5] in C order; padded to a multiple of 64 bytes.
fn npy_header(rows: u64) -> Vec<u8> {
    let fields = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows}, 5), }}");
    let preamble = 10;
    let length = (preamble + fields.len() + 1).next_multiple_of(64) - preamble;
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    // The fields are about 80 bytes: the length fits 16 bits.
    header.extend(u16::try_from(length).unwrap_or(u16::MAX).to_le_bytes());
    header.extend(format!("{fields:<width$}\n", width = length - 1).bytes());
    header
}
