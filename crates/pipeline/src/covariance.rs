//! Traces the covariance of the spectrum at each plane of a scene, and measures it on a 4D grid.

use crate::field::check_grid;
use crate::reporter::{Reporter, Work};
use crate::{Run, limits, measured, method};
use etendue_compare::Prediction;
use etendue_field::{PhotonSource, VirtualPlane};
use etendue_predict::{AXES, Applicability, CovarianceReport};
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_spectrum::field::{FieldOptions, measure_field};
use etendue_store::{Failure, VERSION, machine};

/// A request for the covariances at all planes of a scene.
#[derive(Debug)]
pub struct CovarianceStudy(Run);

/// The covariances at all planes, and the measurement to which they belong.
#[derive(Debug)]
pub struct SceneCovariances {
    /// The measured slices of all planes.
    pub measurement: Measurement,
    /// The covariances, in the order of the planes.
    pub reports: Vec<CovarianceReport>,
}

impl CovarianceStudy {
    /// Checks that the scene has one light.
    pub fn new(run: Run) -> Result<Self, Failure> {
        limits::check_one_light(&run.scene, "covariance tracing")?;
        Ok(Self(run))
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.0.scene
    }

    /// Checks that the work and its memory are within the limits.
    pub fn check_limits(&self) -> Result<(), Failure> {
        self.0.check_limits()?;
        check_memory(&self.0.scene.planes)
    }

    /// Measures and predicts all planes, and compares their covariances.
    pub fn run(&self, reporter: &dyn Reporter) -> Result<SceneCovariances, Failure> {
        let Run {
            scene,
            theories,
            method,
            ..
        } = &self.0;
        let measurement = measured(scene, *method, 0..scene.run.batches, reporter)?;
        let predictions = self.0.predictions(None, reporter)?;
        let source = method::source(&scene.clone().on_grids(), *method)?;
        let bar = reporter.begin(Work::Steps {
            verb: "transforming",
            total: scene.planes.len(),
            things: "planes",
        });
        bar.advance(0);
        let planes = predictions.iter().enumerate();
        let reports = planes.map(|(index, prediction)| {
            let report = of_plane(
                (&*source, &measurement, index),
                (&theories[index], prediction),
                reporter,
            );
            bar.advance(1);
            report
        });
        Ok(SceneCovariances {
            reports: reports.collect::<Result<_, _>>()?,
            measurement,
        })
    }

    /// The content of the index, without its list of files.
    #[must_use]
    pub fn index(&self, found: &SceneCovariances) -> serde_json::Value {
        let Run { scene, method, .. } = &self.0;
        serde_json::json!({
            "scene": scene.name,
            "scene_hash": scene.hash(),
            "scene_file": scene.file,
            "version": VERSION,
            "seed": scene.run.seed,
            "method": method,
            "photons": scene.run.photons,
            "axes": AXES,
            "planes": found.reports,
        })
    }
}

/// The covariances of a plane. The photons are traced once more for this plane, on a 4D
/// grid.
fn of_plane(
    (source, measurement, index): (&dyn PhotonSource, &Measurement, usize),
    (theory, prediction): (&Applicability, &Prediction),
    reporter: &dyn Reporter,
) -> Result<CovarianceReport, Failure> {
    let plane = &measurement.planes()[index];
    let options = fitting_options(plane);
    let passes = if options.keep { 1 } else { 2 };
    let bar = reporter.begin(Work::Photons(passes * measurement.emitted()));
    let batches = 0..u32::try_from(measurement.batches().len()).unwrap_or(u32::MAX);
    let progress = |photons| bar.advance(photons);
    let field = measure_field(source, index, plane, batches, &options, &progress)
        .map_err(Failure::cannot_run)?;
    drop(bar);
    let Some(covariance) = &field.covariance else {
        return Err(Failure::cannot_run(
            "a plane has no covariance: this is a bug in etendue",
        ));
    };
    CovarianceReport::new(
        (measurement, index),
        (&field.grid, covariance),
        theory,
        prediction,
    )
    .map_err(Failure::cannot_run)
}

/// The options with which a grid computes covariances, and groups of batches for their
/// errors.
fn grid_options() -> FieldOptions {
    FieldOptions {
        covariance: true,
        ..FieldOptions::default()
    }
}

/// The options of the grid on which a plane is measured. All groups are kept if they fit
/// into half of the memory; the photons then need not be traced twice.
pub fn fitting_options(plane: &VirtualPlane) -> FieldOptions {
    let kept = FieldOptions {
        keep: true,
        ..grid_options()
    };
    let threads = rayon::current_num_threads();
    if kept.bytes(&kept.grid(plane), threads) <= machine::available_memory() / 2 {
        kept
    } else {
        grid_options()
    }
}

/// Fails, before any photon is traced, if the grid of a plane does not fit into memory.
pub fn check_memory(planes: &[VirtualPlane]) -> Result<(), Failure> {
    for plane in planes {
        let name = format!("covariance: the grid of {}", plane.name);
        check_grid(&name, &grid_options().grid(plane), &grid_options())?;
    }
    Ok(())
}
