//! Runs a scene for a figure.

use crate::quality::Quality;
use etendue_compare::{PlaneComparison, TESTS};
use etendue_field::FrequencyAxis;
use etendue_pipeline::{Reporter, Run, field, judged};
use etendue_predict::{Applicability, test_each};
use etendue_report::pictures::Seen;
use etendue_scene::{Scene, SceneFile};
use etendue_store::{Failure, Method, machine};
use std::path::Path;

/// A scene that was measured, predicted and compared, at finer frequencies than it specifies.
#[derive(Debug)]
pub(crate) struct Shot {
    pub(crate) scene: Scene,
    /// Photons emitted.
    pub(crate) photons: u64,
    pub(crate) theories: Vec<Applicability>,
    pub(crate) planes: Vec<PlaneComparison>,
}

impl Shot {
    /// Runs a scene, with or without full radial spectra.
    pub(crate) fn take(
        mut scene: Scene,
        quality: Quality,
        full_radial: bool,
        reporter: &dyn Reporter,
    ) -> Result<Self, Failure> {
        scene.run.photons = quality.photons(scene.run.photons);
        scene.file.run.photons = scene.run.photons;
        for plane in &mut scene.planes {
            for axis in [&mut plane.grid.rho, &mut plane.grid.nu] {
                *axis = FrequencyAxis {
                    half: quality.finer() * axis.half,
                    spacing: axis.spacing / quality.finer() as f64,
                };
            }
        }
        let run = Run::of(scene, Method::Photons, Vec::new())?;
        run.check_limits()?;
        let case = run.measured_scene(reporter)?;
        let tests = if full_radial { field::TESTS } else { TESTS };
        let mut planes = judged(&case, &test_each(&case.scene, tests))?;
        if full_radial {
            field::compare(None, &case, &mut planes, reporter)?;
        }
        Ok(Self {
            photons: case.measurement.emitted(),
            scene: case.scene,
            theories: case.theories,
            planes,
        })
    }
}

impl Shot {
    /// All planes with their results.
    pub(crate) fn all(&self) -> impl Iterator<Item = Seen<'_>> {
        let both = self.scene.planes.iter().zip(&self.planes);
        both.map(|(plane, found)| Seen { plane, found })
    }

    /// The plane with the given name.
    pub(crate) fn at(&self, name: &str) -> Result<Seen<'_>, Failure> {
        let missing = || Failure::cannot_run(format!("{} has no plane {name}", self.scene.name));
        let mut all = self.all();
        all.find(|seen| seen.plane.name == name).ok_or_else(missing)
    }

    /// The planes with the given names.
    pub(crate) fn each(&self, names: &[&str]) -> Result<Vec<Seen<'_>>, Failure> {
        names.iter().map(|name| self.at(name)).collect()
    }
}

/// A scene of the repository with some fields set, and with a number of photons derived
/// from the scene's own number.
pub(crate) fn resolved(
    name: &str,
    text: &str,
    set: &[(String, String)],
    photons: impl FnOnce(u64) -> u64,
) -> Result<Scene, Failure> {
    let file = SceneFile::parse(text).map_err(Failure::bad_input)?;
    let mut file = file.with_all(set).map_err(Failure::bad_input)?;
    file.run.photons = photons(file.run.photons);
    machine::resolved(name, file, Path::new(""), name)
}
