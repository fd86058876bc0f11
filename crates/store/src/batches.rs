//! Stores the batches of a measurement in files: one `ledger.npz`, and a `batches.npz` for each
//! plane.

use crate::npz::{Npz, NpzFile, Number};
use crate::stored::Stored;
use crate::{Failure, Method, Results};
use etendue_field::{Ledger, PlaneTally, Projection, ProjectionGrid, Slices, VirtualPlane};
use etendue_spectrum::{Batch, Measurement, PROJECTION_BINS, PlaneBatch, RayMoments};
use ndarray::{Array1, Array2, Array3, Array4, ArrayView, Axis, Dimension, RemoveAxis, stack};
use serde::{Deserialize, Deserializer, Serialize};
use std::ops::Range;

/// The content of `measurement.json`, beside the scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Held {
    /// Seed of the photons.
    pub seed: u64,
    /// Method of measurement.
    pub method: Method,
    /// Photons emitted in the stored batches.
    pub photons: u64,
    /// The stored batches. A run with all batches states their number.
    #[serde(deserialize_with = "ranged")]
    pub batches: Range<u32>,
}

/// Reads a range of batches, or the number of batches of a run.
pub fn ranged<'d, D: Deserializer<'d>>(from: D) -> Result<Range<u32>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Batches {
        All(u32),
        Some(Range<u32>),
    }
    Ok(match Batches::deserialize(from)? {
        Batches::All(count) => 0..count,
        Batches::Some(range) => range,
    })
}

/// The file with the numbers of all batches.
pub const LEDGER: &str = "ledger.npz";

fn file_of(plane: &VirtualPlane) -> String {
    format!("{}/batches.npz", plane.name)
}

/// The names of the files of a measurement.
pub fn names(planes: &[VirtualPlane]) -> Vec<String> {
    let each = planes.iter().map(file_of);
    each.chain([LEDGER.to_owned()]).collect()
}

/// Writes all batches of a measurement.
pub fn write(results: &mut Results, measurement: &Measurement) -> Result<(), Failure> {
    let batches: Vec<&Batch> = measurement.batches().collect();
    files(measurement.planes(), &batches)?
        .into_iter()
        .try_for_each(|(name, bytes)| results.write(&name, &bytes))
}

/// The files of some batches at `planes`: name and content of each.
pub fn files(
    planes: &[VirtualPlane],
    batches: &[&Batch],
) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let flux = batches.iter().map(|batch| {
        let Ledger {
            emitted,
            absorbed,
            escaped,
            stopped,
        } = batch.ledger;
        [emitted, absorbed, escaped, stopped]
    });
    let flux = Array2::from(flux.collect::<Vec<_>>());
    let ledger = numbered(batches)?.add("ledger", &flux)?.bytes()?;
    planes
        .iter()
        .enumerate()
        .map(|(i, plane)| Ok((file_of(plane), at_plane(plane, batches, i)?)))
        .chain([Ok((LEDGER.to_owned(), ledger))])
        .collect()
}

/// A new file with an array of the numbers of the batches. Each row of later arrays belongs
/// to one of these batches.
fn numbered(batches: &[&Batch]) -> Result<Npz, Failure> {
    let numbers: Array1<u32> = batches.iter().map(|b| b.index).collect();
    let emitted: Array1<u64> = batches.iter().map(|b| b.emitted).collect();
    Npz::default()
        .add("batch", &numbers)?
        .add("emitted", &emitted)
}

fn at_plane(plane: &VirtualPlane, batches: &[&Batch], index: usize) -> Result<Vec<u8>, Failure> {
    let each = || batches.iter().map(|batch| &batch.planes[index]);
    let tally = each().map(|batch| {
        let PlaneTally {
            crossed,
            inside,
            outside,
        } = batch.tally;
        [crossed, inside, outside]
    });
    let tally = Array2::from(tally.collect::<Vec<_>>());
    let npz = numbered(batches)?.add("tally", &tally)?;
    let npz = add_stacked(npz, "slices", each().map(|b| b.slices.half.view()))?;
    let projections = each().map(|b| b.projection.values.view());
    let npz = add_stacked(npz, "projection", projections)?;
    let moments = each().map(|batch| batch.moments.0);
    let moments = Array2::from(moments.collect::<Vec<_>>());
    npz.add("moments", &moments)?
        .add_half_axes(&plane.grid)?
        .bytes()
}

/// Adds arrays of equal shape as one array with an additional first axis.
fn add_stacked<'a, A, D>(
    npz: Npz,
    name: &str,
    arrays: impl Iterator<Item = ArrayView<'a, A, D>>,
) -> Result<Npz, Failure>
where
    A: Number + 'a,
    D: Dimension,
    D::Larger: RemoveAxis,
{
    let arrays: Vec<_> = arrays.collect();
    let stacked = stack(Axis(0), &arrays).map_err(Failure::cannot_run)?;
    npz.add(name, &stacked)
}

/// Reads the batches of a stage of `planes`.
pub fn read(stored: &Stored<Held>, planes: &[VirtualPlane]) -> Result<Measurement, Failure> {
    let held = &stored.index.content;
    let seed = stored.index.scene_file.run.seed;
    if held.seed != seed {
        return Err(stored.fault(format!(
            "its seed is {}, but the seed of its scene is {seed}",
            held.seed
        )));
    }
    read_files(&|name| stored.npz(name), held, planes)
}

/// Reads the batches stored in files, which `open` opens by name.
pub fn read_files(
    open: &dyn Fn(&str) -> Result<NpzFile, Failure>,
    held: &Held,
    planes: &[VirtualPlane],
) -> Result<Measurement, Failure> {
    let mut file = open(LEDGER)?;
    let rows = StoredRows::read(&mut file, held)?;
    let ledger: Array2<f64> = file.array("ledger", [rows.numbers.len(), 4])?;
    let mut columns = Vec::new();
    for plane in planes {
        let batches = plane_batches(&mut open(&file_of(plane))?, held, &rows, plane)?;
        columns.push(batches.into_iter());
    }
    let mut measurement = Measurement::new(planes.to_vec());
    for (row, ledger) in ledger.outer_iter().enumerate() {
        let batch = Batch {
            index: rows.numbers[row],
            emitted: rows.emitted[row],
            ledger: Ledger {
                emitted: ledger[0],
                absorbed: ledger[1],
                escaped: ledger[2],
                stopped: ledger[3],
            },
            planes: columns.iter_mut().filter_map(Iterator::next).collect(),
        };
        measurement
            .insert(batch)
            .map_err(|e| file.fault("batch", e))?;
    }
    Ok(measurement)
}

/// The batches to which the rows of a file belong.
#[derive(PartialEq)]
struct StoredRows {
    numbers: Array1<u32>,
    emitted: Array1<u64>,
}

impl StoredRows {
    /// Checks that the rows belong to the batches that the index lists.
    fn read(file: &mut NpzFile, held: &Held) -> Result<Self, Failure> {
        let Range { start, end } = held.batches;
        let count = end.saturating_sub(start) as usize;
        let numbers: Array1<u32> = file.array("batch", [count])?;
        if !numbers.iter().copied().eq(held.batches.clone()) {
            return Err(file.fault("batch", format!("must be the batches {start}..{end}")));
        }
        let emitted: Array1<u64> = file.array("emitted", [count])?;
        let sum = emitted.iter().try_fold(0_u64, |sum, n| sum.checked_add(*n));
        if emitted.iter().any(|n| *n == 0) || sum != Some(held.photons) {
            let must = format!(
                "must be the numbers of photons of the batches, {} in all",
                held.photons
            );
            return Err(file.fault("emitted", must));
        }
        Ok(Self { numbers, emitted })
    }
}

fn plane_batches(
    file: &mut NpzFile,
    held: &Held,
    rows: &StoredRows,
    plane: &VirtualPlane,
) -> Result<Vec<PlaneBatch>, Failure> {
    if StoredRows::read(file, held)? != *rows {
        return Err(file.fault("emitted", format!("must be the same as in {LEDGER}")));
    }
    file.check_half_axes(&plane.grid)?;
    let count = rows.numbers.len();
    let [azimuths, rho, nu] = plane.grid.half_shape();
    let cells = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
    let tallies: Array2<u64> = file.array("tally", [count, 3])?;
    let slices: Array4<_> = file.array("slices", [count, azimuths, rho, nu])?;
    let projections: Array3<f64> = file.array("projection", [count, cells.bins, cells.bins])?;
    let moments: Array2<f64> = file.array("moments", [count, RayMoments::COUNT])?;
    let rows = tallies.outer_iter().zip(slices.outer_iter());
    rows.zip(projections.outer_iter().zip(moments.outer_iter()))
        .map(|((tally, half), (values, moments))| {
            let tally = PlaneTally {
                crossed: tally[0],
                inside: tally[1],
                outside: tally[2],
            };
            if tally.inside.checked_add(tally.outside) != Some(tally.crossed) {
                return Err(file.fault(
                    "tally",
                    "`crossed` must be the sum of `inside` and `outside`",
                ));
            }
            Ok(PlaneBatch {
                tally,
                slices: Slices {
                    grid: plane.grid,
                    half: half.to_owned(),
                },
                projection: Projection {
                    grid: cells,
                    values: values.to_owned(),
                },
                moments: RayMoments(std::array::from_fn(|i| moments[i])),
            })
        })
        .collect()
}
