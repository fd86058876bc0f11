//! Estimates the work of the predictions of a scene before anything is traced.

use crate::applicability::Applicability;
use crate::budget::budget;
use etendue_compare::Class;
use etendue_field::{ProjectionGrid, VirtualPlane, byte_size};
use etendue_scene::Scene;
use etendue_spectrum::PROJECTION_BINS;
use etendue_theory::PredictionWork;
use std::fmt;

/// The largest number of steps of all predictions of a scene. These steps take about ten minutes on
/// one core.
const MOST_STEPS: f64 = 6e11;
/// The largest number of bytes of a prediction on one core.
const MOST_BYTES: f64 = 1e9;

/// The error for a scene whose predictions exceed the allowed work. It names the plane that is
/// responsible.
#[derive(Clone, Debug, PartialEq)]
pub struct TooMuchWork {
    plane: String,
    work: PredictionWork,
    /// Steps of all planes counted so far.
    total: f64,
}

impl fmt::Display for TooMuchWork {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { plane, work, total } = self;
        let (estimate, limit) = if work.bytes + work.bytes_each > MOST_BYTES {
            let limit = format!("{:.0} GB", MOST_BYTES / 1e9);
            (
                format!("{} on one core", byte_size(work.bytes + work.bytes_each)),
                limit,
            )
        } else {
            let steps = if work.steps.is_finite() {
                format!(
                    "{:.1e} steps, out of {total:.1e} or more for all planes",
                    work.steps
                )
            } else {
                "too many steps to count".to_owned()
            };
            let minutes = MOST_STEPS / 6e10;
            let limit =
                format!("{MOST_STEPS:.0e} for all planes, about {minutes} minutes on one core");
            (steps, limit)
        };
        write!(
            f,
            "the prediction of {plane} takes {estimate}, but the limit is {limit}. The work consists of {}",
            work.drivers
        )
    }
}

/// The first plane whose prediction would not fit into a gigabyte, if there is one.
/// Otherwise, if the predictions of a scene would take more than about ten minutes, returns the
/// plane that takes most of the work. `theories` are the theories of the scene's planes.
#[must_use]
pub fn too_much_work(scene: &Scene, theories: &[Applicability]) -> Option<TooMuchWork> {
    let mut total = 0.0;
    let mut most: Option<TooMuchWork> = None;
    for (plane, theory) in scene.planes.iter().zip(theories) {
        let this = TooMuchWork {
            plane: plane.name.clone(),
            work: of(scene, plane, theory),
            total: 0.0,
        };
        if this.work.bytes + this.work.bytes_each > MOST_BYTES {
            return Some(this);
        }
        total += this.work.steps;
        if most.as_ref().is_none_or(|m| this.work.steps > m.work.steps) {
            most = Some(this);
        }
        if total > MOST_STEPS {
            return most.map(|most| TooMuchWork { total, ..most });
        }
    }
    None
}

/// Seconds on one core for each photon, on each leg of the path, and at each plane and azimuth.
/// Tracing `fig9b` takes 37e-9 s and tracing `ggx_sphere` 33e-9 s for each photon, plane and azimuth,
/// on an AMD EPYC processor; the legs are a fit to random scenes.
const OF_LEG: f64 = 1e-7;
const OF_AZIMUTH: f64 = 4e-8;
/// Seconds on one core for each plane to compare, draw and save it, and more for each of its
/// frequencies in each batch.
const OF_PLANE: f64 = 0.3;
const OF_FREQUENCY: f64 = 3e-7;

/// The approximate seconds that one core takes to trace the photons of a scene, the most
/// seconds that it takes for the predictions of the scene, and the approximate seconds that it
/// takes to compare and draw the planes, with a second tracer where no theory applies.
#[must_use]
pub fn seconds(scene: &Scene, theories: &[Applicability]) -> [f64; 3] {
    let (mut of_photon, mut steps, mut compared) =
        (scene.path.legs.len() as f64 * OF_LEG, 0.0, 0.0);
    for (plane, theory) in scene.planes.iter().zip(theories) {
        of_photon += plane.grid.azimuths as f64 * OF_AZIMUTH;
        steps += of(scene, plane, theory).steps;
        let frequencies = plane.grid.half_shape().iter().product::<usize>() as f64;
        compared += OF_PLANE + frequencies * f64::from(scene.run.batches) * OF_FREQUENCY;
    }
    let photons = of_photon * scene.run.photons as f64;
    let references = theories
        .iter()
        .filter(|of| of.class() == Class::Reference)
        .count();
    let of_second_tracer = photons * references as f64 / theories.len() as f64;
    // A core takes about a nanosecond for a step.
    [photons, 1e-9 * steps, compared + of_second_tracer]
}

/// The work of the prediction of a plane.
pub(crate) fn of(
    scene: &Scene,
    plane: &VirtualPlane,
    applicability: &Applicability,
) -> PredictionWork {
    let picture = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
    let over = (&plane.window, &plane.grid, &picture);
    let lit = applicability.of_lights(scene, plane);
    let lit = lit.filter(|(.., theory, _)| theory.dark.is_none());
    let each = lit.map(|(_, _, theory, _)| theory.theory.work(over, budget(scene)));
    each.reduce(PredictionWork::then)
        .unwrap_or_else(PredictionWork::none)
}
