//! `--save field`: the light field of each plane on a 4D grid, and its full radial spectrum.

use crate::case::Case;
use crate::failure::Failure;
use crate::machine;
use crate::method::source;
use crate::progress;
use crate::results::Results;
use crate::results::npz::Npz;
use crate::results::sealed::json;
use etendue_compare::{Applicability, Theory};
use etendue_field::{FieldGrid, Slices, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::field::{FieldMeasurement, FieldOptions, full_radial_of, measure_field};
use etendue_theory::Harmonics;
use ndarray::{Array1, Array2, Array4};
use ndarray_npy::WriteNpyExt;
use serde::Serialize;
use std::io;

/// The files of a plane.
pub(crate) const NAMES: [&str; 3] = ["field.npy", "field.json", "full_radial.npz"];

/// `field.json`.
#[derive(Serialize)]
struct Index {
    axes: [&'static str; 4],
    units: [&'static str; 5],
    cells: [usize; 4],
    /// Centres of the first cells and widths of all: cell i is at `first` + i · `width`.
    first: [f64; 4],
    width: [f64; 4],
    window: etendue_field::Window,
    assignment: etendue_field::Assignment,
    /// ‖4D − slices‖/‖slices‖ of the same photons on shared frequencies up to half of Nyquist, and what it is held against.
    aliasing: Option<Aliasing>,
}

#[derive(Serialize)]
struct Aliasing {
    frequencies: usize,
    difference: f64,
    /// What aliasing makes of it if the spectrum beyond Nyquist is as strong as just inside.
    expected: f64,
    /// What it cannot be more than, whatever the photons.
    bound: f64,
}

/// Fails, before anything is traced, when a plane's grid is larger than memory.
pub(crate) fn check_memory(scene: &Scene) -> Result<(), Failure> {
    let memory = machine::available_memory();
    for plane in &scene.planes {
        let grid = FieldGrid::new(&plane.window, &plane.grid);
        let bytes = FieldOptions::default().bytes(&grid, rayon::current_num_threads());
        if bytes > memory {
            let [nx, ny, nu, nv] = grid.cells;
            let gigabytes = |bytes: u64| bytes as f64 / 1e9;
            return Err(Failure::cannot_run(format!(
                "--save field: the grid of {} has {nx} x {ny} x {nu} x {nv} cells and needs {:.1} GB; memory holds {:.1} GB here",
                plane.name,
                gigabytes(bytes),
                gigabytes(memory),
            )));
        }
    }
    Ok(())
}

/// Traces the photons again, one plane after the other.
pub(crate) fn save(results: &mut Results, case: &Case, quiet: bool) -> Result<(), Failure> {
    let source = source(&case.scene, case.method)?;
    for (index, plane) in case.scene.planes.iter().enumerate() {
        // Once for the sum, once for the groups its errors come from.
        let bar = progress::photons(2 * case.measurement.emitted(), quiet);
        let batches = 0..case.scene.run.batches;
        let options = FieldOptions::default();
        let measured = measure_field(&*source, index, plane, batches, &options, &|photons| {
            bar.inc(photons);
        });
        bar.finish_and_clear();
        let measured = measured.map_err(Failure::cannot_run)?;
        let slices = etendue_spectrum::estimate::slices(&case.measurement, index);
        let slices = slices.map_err(Failure::cannot_run)?.mean;
        let predicted = predicted(&case.theories[index], plane, &measured.grid);
        write(results, plane, &measured, &slices, predicted)?;
    }
    Ok(())
}

/// The full radial spectrum that theory predicts, where it can tell all four dimensions at once: on the way to
/// the receiver, and not behind a mesh.
fn predicted(
    applicability: &Applicability,
    plane: &VirtualPlane,
    grid: &FieldGrid,
) -> Option<Array2<f64>> {
    let Theory::Parallel(chain) = &applicability.theory else {
        return None;
    };
    if matches!(chain.source.light, etendue_field::Light::Rays { .. }) {
        return None;
    }
    let axes = [0, 1, 2, 3];
    let spacing = axes.map(|axis| grid.spacing(axis));
    let half = axes.map(|axis| grid.cells[axis] / 2);
    let harmonics = Harmonics::new(chain, &plane.window, spacing, half)?;
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a multiple below the number of cells"
    )]
    let multiples =
        |frequency: [f64; 4]| axes.map(|axis| (frequency[axis] / spacing[axis]).round() as isize);
    Some(full_radial_of(grid, |frequency| {
        harmonics.at(multiples(frequency))
    }))
}

/// The share of Nyquist up to which the grid is held against the slices.
const COMPARED: f64 = 0.5;

fn write(
    results: &mut Results,
    plane: &VirtualPlane,
    measured: &FieldMeasurement,
    slices: &Slices,
    predicted: Option<Array2<f64>>,
) -> Result<(), Failure> {
    let name = &plane.name;
    let FieldMeasurement {
        grid, full_radial, ..
    } = measured;
    let field: &Array4<f64> = &measured.field;
    results.stream(&format!("{name}/field.npy"), &mut |file| {
        field.write_npy(file).map_err(io::Error::other)
    })?;
    let index = Index {
        axes: ["x", "y", "u", "v"],
        units: ["m", "m", "slope", "slope", "W m⁻² sr⁻¹"],
        cells: grid.cells,
        first: [0, 1, 2, 3].map(|axis| grid.center(axis, 0)),
        width: [0, 1, 2, 3].map(|axis| grid.cell_width(axis)),
        window: plane.window,
        assignment: measured.spectrum.assignment,
        aliasing: measured
            .spectrum
            .aliasing(slices, COMPARED)
            .map(|a| Aliasing {
                frequencies: a.compared,
                difference: a.difference,
                expected: a.expected,
                bound: a.bound,
            }),
    };
    results.write(&format!("{name}/field.json"), &json(&index))?;
    let mut npz = Npz::new().add("power", &full_radial.power)?;
    if let Some(predicted) = predicted {
        npz = npz.add("predicted_power", &predicted)?;
    }
    let bytes = npz
        .add("sigma", &full_radial.sigma)?
        .add("shot_noise", &full_radial.shot_noise)?
        .add("counts", &full_radial.counts)?
        .add("rho_edges", &Array1::from(full_radial.rho_edges.clone()))?
        .add("nu_edges", &Array1::from(full_radial.nu_edges.clone()))?
        .bytes()?;
    results.write(&format!("{name}/full_radial.npz"), &bytes)
}
