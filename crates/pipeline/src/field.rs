//! `--save field`: the light field of each plane on a 4D grid, and its full radial spectrum.

use crate::limits;
use crate::measure::MeasuredScene;
use crate::method::{judge_of, source};
use crate::reporter::{Reporter, Work};
use etendue_compare::{FullRadialComparison, PlaneComparison, PredictedField};
use etendue_field::{FieldGrid, Slices, VirtualPlane, byte_size};
use etendue_predict::{Theory, predict_field, test_each};
use etendue_scene::Scene;
use etendue_spectrum::field::{Aliasing, FieldMeasurement, FieldOptions, measure_field};
use etendue_store::npz::{Npz, write_npy};
use etendue_store::sealed::json;
use etendue_store::{Failure, Method, Results, machine};
use ndarray::{Array1, Array4};
use serde::Serialize;

/// The names of the files that are written for each plane.
pub const NAMES: [&str; 3] = ["field.npy", "field.json", "full_radial.npz"];

/// The content of `field.json`.
#[derive(Serialize)]
struct FieldIndex {
    axes: [&'static str; 4],
    units: [&'static str; 5],
    cells: [usize; 4],
    /// The centre of the first cell and the width of all cells along each axis: the centre of
    /// cell i is `first` + i · `width`.
    first: [f64; 4],
    width: [f64; 4],
    window: etendue_field::Window,
    assignment: etendue_field::Assignment,
    /// The relative difference ‖4D − slices‖/‖slices‖ between the 4D spectrum and the slices of the
    /// same photons, and the values with which it is compared. The norms are over shared
    /// frequencies up to half of Nyquist.
    aliasing: Option<Aliasing>,
}

/// Fails, before any photon is traced, if the grid of a plane does not fit into memory.
pub fn check_memory(scene: &Scene) -> Result<(), Failure> {
    limits::check_one_light(scene, "--save field")?;
    for plane in &scene.planes {
        let grid = FieldGrid::new(&plane.window, &plane.grid);
        let name = format!("--save field: the grid of {}", plane.name);
        check_grid(&name, &grid, &FieldOptions::default())?;
    }
    Ok(())
}

/// Fails if the grid `name`, measured with `options`, does not fit into memory.
pub fn check_grid(name: &str, grid: &FieldGrid, options: &FieldOptions) -> Result<(), Failure> {
    let memory = machine::available_memory();
    let bytes = options.bytes(grid, rayon::current_num_threads());
    if bytes > memory {
        let [nx, ny, nu, nv] = grid.cells;
        let [needed, memory] = [bytes, memory].map(|bytes| byte_size(bytes as f64));
        return Err(Failure::cannot_run(format!(
            "{name} has {nx} x {ny} x {nu} x {nv} cells and needs {needed}; {memory} are available"
        )));
    }
    Ok(())
}

/// The light field of a plane, and the comparison of its full radial spectrum with the prediction.
#[derive(Debug)]
struct Field {
    measured: FieldMeasurement,
    /// The comparison with the prediction; `None` if there is no prediction, or if memory is too
    /// small to hold all groups for the comparison.
    compared: Option<FullRadialComparison>,
}

impl Field {
    /// Traces the photons again, and puts the photons that cross the plane `index` on a grid.
    fn new(case: &MeasuredScene, index: usize, reporter: &dyn Reporter) -> Result<Self, Failure> {
        let plane = &case.scene.planes[index];
        let grid = FieldGrid::new(&plane.window, &plane.grid);
        let options = FieldOptions {
            keep: true,
            spectra: true,
            ..FieldOptions::default()
        };
        // The prediction is divided into the same number of groups as the measurement.
        let groups = options.groups.min(case.measurement.batches().len());
        let needed = grid
            .bytes()
            .saturating_mul(groups as u64)
            .saturating_add(options.bytes(&grid, rayon::current_num_threads()));
        if needed > machine::available_memory() {
            let options = FieldOptions::default();
            return Ok(Self {
                measured: on_grid((case, case.method), index, &options, reporter)?,
                compared: None,
            });
        }
        let mut measured = on_grid((case, case.method), index, &options, reporter)?;
        let theory = &case.theories[index];
        let predicted = if matches!(theory.theory, Theory::None) {
            let judge = judge_of(case.method, &case.scene, plane);
            let reference = on_grid((case, judge), index, &options, reporter)?;
            Some(PredictedField::reference(reference.groups))
        } else {
            let over = (grid, options.assignment);
            predict_field(&case.scene, plane, theory, over, groups)
        };
        let seed = case.scene.run.seed;
        let compared = predicted.map(|field| FullRadialComparison::new(&measured, &field, seed));
        measured.groups.clear();
        Ok(Self { measured, compared })
    }
}

/// Traces the photons of a plane by a method. If the grids of groups are kept, the photons are
/// traced once; otherwise they are traced once for the sum and once for the groups.
fn on_grid(
    (case, method): (&MeasuredScene, Method),
    index: usize,
    options: &FieldOptions,
    reporter: &dyn Reporter,
) -> Result<FieldMeasurement, Failure> {
    let scene = case.scene.clone().on_grids();
    // The tracer aims photons at all planes of a scene. Unless they are from lattices, the photons
    // on the grid are the photons of the measurement, so the scene is traced with all its planes.
    let (source, at) = if method == case.method {
        (source(&scene, method)?, index)
    } else {
        (source(&scene.seen_at(&[index]), method)?, 0)
    };
    let passes = if options.keep { 1 } else { 2 };
    let bar = reporter.begin(Work::Photons(passes * case.measurement.emitted()));
    let batches = 0..case.scene.run.batches;
    let plane = &case.scene.planes[index];
    let measured = measure_field(&*source, at, plane, batches, options, &|photons| {
        bar.advance(photons);
    });
    drop(bar);
    measured.map_err(Failure::cannot_run)
}

/// Measures the light field of each plane, compares the field with the prediction, and writes the
/// field if there is a result folder.
pub fn compare(
    mut results: Option<&mut Results>,
    case: &MeasuredScene,
    planes: &mut [PlaneComparison],
    reporter: &dyn Reporter,
) -> Result<(), Failure> {
    limits::check_one_light(&case.scene, "the full radial spectrum")?;
    let test = test_each(&case.scene, TESTS);
    let each = case.scene.planes.iter().zip(planes).enumerate();
    for (index, (plane, comparison)) in each {
        let field = Field::new(case, index, reporter)?;
        if let Some(results) = &mut results {
            write(results, plane, &field, &comparison.measured)?;
        }
        if let Some(compared) = field.compared {
            comparison.add_full_radial(compared, &case.predictions[index], &test);
        }
    }
    Ok(())
}

/// The number of tests of a plane if its light field is saved: those of every plane, and a test of
/// the full radial spectrum.
pub const TESTS: usize = etendue_compare::TESTS + 1;

/// The share of Nyquist up to which the grid is compared with the slices.
const COMPARED: f64 = 0.5;

fn write(
    results: &mut Results,
    plane: &VirtualPlane,
    Field { measured, compared }: &Field,
    slices: &Slices,
) -> Result<(), Failure> {
    let name = &plane.name;
    let FieldMeasurement {
        grid, full_radial, ..
    } = measured;
    let field: &Array4<f64> = &measured.field;
    // The field may have gigabytes, so it is written without a copy in memory.
    results.stream(&format!("{name}/field.npy"), &mut |file| {
        write_npy(file, field)
    })?;
    let index = FieldIndex {
        axes: ["x", "y", "u", "v"],
        units: ["m", "m", "slope", "slope", "W m⁻² sr⁻¹"],
        cells: grid.cells,
        first: [0, 1, 2, 3].map(|axis| grid.center(axis, 0)),
        width: [0, 1, 2, 3].map(|axis| grid.cell_width(axis)),
        window: plane.window,
        assignment: measured.spectrum.assignment,
        aliasing: measured.spectrum.aliasing(slices, COMPARED),
    };
    results.write(&format!("{name}/field.json"), &json(&index))?;
    let mut npz = Npz::default().add("power", &full_radial.power)?;
    // Only theory predicts power; another measurement has noise of its own.
    if let Some(compared) = compared {
        npz = npz
            .add("predicted_power", &compared.predicted)?
            .add("sigma_predicted", &compared.sigma)?;
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
