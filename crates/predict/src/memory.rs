//! Estimates the memory of a run before it begins.

use crate::applicability::Applicability;
use crate::budget::budget;
use crate::theories::Theory;
use crate::work;
use etendue_field::{ProjectionGrid, SliceGrid, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::PROJECTION_BINS;
use etendue_transform::SliceTransform;

/// The parts of a run's memory, in bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Memory {
    /// The spectra of all batches, which are kept until the errors are known. The batches of
    /// references are included.
    pub batches: f64,
    /// The fine grids over which each thread spreads photons.
    pub threads: f64,
    /// Predictions with their derivatives, and the working memory of computing a prediction.
    pub predictions: f64,
    /// The comparison, which handles one plane on each thread.
    pub comparison: f64,
    /// Triangles and the hierarchies over them.
    pub meshes: f64,
    /// Pictures while they are read.
    pub pictures: f64,
}

/// Bytes of a complex number.
const COMPLEX: f64 = 16.0;
/// Bytes that the program needs for any scene. They hold its code, buffers of photons, pictures,
/// and data that one stage does not free before the next stage.
const PROGRAM: f64 = 1.5e8;

/// Bytes that a triangle and its part of the hierarchy need during construction. The measured value
/// is 130.
const TRIANGLE: f64 = 150.0;
/// Bytes of the normals at the corners of a triangle.
const NORMALS: f64 = 72.0;

impl Memory {
    /// The memory of a run of a scene on `threads` threads. `theories` are the theories of
    /// the scene's planes.
    #[must_use]
    pub fn new(scene: &Scene, theories: &[Applicability], threads: usize) -> Self {
        let batches = f64::from(scene.run.batches);
        // A batch is the work of one thread.
        let busy = (threads as f64).min(batches);
        let planes = scene.planes.iter().zip(theories);
        let planes: Vec<(&VirtualPlane, &Applicability)> = planes.collect();
        let each = |of: &dyn Fn(&VirtualPlane, &Applicability) -> f64| -> Vec<f64> {
            planes
                .iter()
                .map(|(plane, theory)| of(plane, theory))
                .collect()
        };
        let sum =
            |of: &dyn Fn(&VirtualPlane, &Applicability) -> f64| each(of).into_iter().sum::<f64>();
        let picture = 8.0 * (PROJECTION_BINS * PROJECTION_BINS) as f64;
        let spectra = |plane: &VirtualPlane| COMPLEX * cells(&plane.grid);
        // For a reference, the program keeps the measurement, and the prediction holds copies of
        // it.
        let kept = |of: &Applicability| if is_reference(of) { 3.0 } else { 1.0 };
        Self {
            batches: batches * sum(&|plane, of| kept(of) * (spectra(plane) + picture)),
            // A transform of full precision needs a little less.
            threads: busy * sum(&|plane, _| SliceTransform::reduced(&plane.grid).bytes()),
            predictions: sum(&|plane, of| {
                let each = of.of_lights(scene, plane).map(|(scene, plane, of, _)| {
                    let held = of.theory.parameters().len() as f64;
                    3.0 + held + replicates(scene, plane, &of.theory)
                });
                each.sum::<f64>() * spectra(plane)
            }) + largest(
                1,
                each(&|plane, of| {
                    let work = work::of(scene, plane, of);
                    work.bytes + threads as f64 * work.bytes_each
                }),
            ),
            // The comparison holds residuals of all batches, means, variances, powers, and the sums
            // for p-values.
            comparison: largest(threads, each(&|plane, _| (batches + 8.0) * spectra(plane)))
                + sum(&|plane, _| 4.0 * spectra(plane)),
            // Lights at the same depth share their meshes.
            meshes: meshes(scene) * depths(scene) as f64,
            pictures: scene.picture_bytes as f64,
        }
    }

    /// The sum of the parts.
    #[must_use]
    pub fn total(&self) -> f64 {
        let Self {
            batches,
            threads,
            predictions,
            comparison,
            meshes,
            pictures,
        } = self;
        PROGRAM + batches + threads + predictions + comparison + meshes + pictures
    }
}

/// The sum of the largest `count` numbers.
fn largest(count: usize, mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(|a, b| b.total_cmp(a));
    numbers.iter().take(count).sum()
}

fn is_reference(applicability: &Applicability) -> bool {
    matches!(applicability.theory, Theory::None)
}

/// The number of different depths of lights.
fn depths(scene: &Scene) -> usize {
    let moved = |other: &&Scene| other.path.frame != scene.path.frame;
    1 + scene.other_lights.iter().filter(moved).count()
}

fn meshes(scene: &Scene) -> f64 {
    let each = scene.meshes.iter().map(|mesh| {
        let normals = mesh.smooth.as_ref().map_or(0.0, |_| NORMALS);
        mesh.triangles.len() as f64 * (TRIANGLE + normals)
    });
    // The method `sum` returns −0 for no numbers.
    each.fold(0.0, |all, bytes| all + bytes)
}

fn cells(grid: &SliceGrid) -> f64 {
    grid.half_shape().iter().map(|n| *n as f64).product()
}

/// The number of replicates that a prediction by nets holds, including the replicates of
/// its first-order chain.
fn replicates(scene: &Scene, plane: &VirtualPlane, theory: &Theory) -> f64 {
    let each = etendue_theory::REPLICATES as f64;
    let picture = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
    let over = (&plane.window, &plane.grid, &picture);
    match theory {
        Theory::Parallel(chain) if chain.is_sampled(over, budget(scene)) => each,
        Theory::Parallel(_) | Theory::None => 0.0,
        Theory::Path(_) => 2.0 * each,
    }
}
