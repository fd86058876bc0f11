//! The light field behind a pixel, and how fast it changes over a picture.

mod covariance;
mod map;
mod said;

use crate::args::ProbeArgs;
use crate::print::{deliver, say_replaced};
use crate::threads::on_threads;
use crate::{progress, world};
use covariance::FoundCovariance;
use etendue_compare::{PlaneComparison, Prediction, Test, Verdict, compare, sidak};
use etendue_field::PhotonSource;
use etendue_import::Imported;
use etendue_paths::{BackwardProbe, Budget, Paths, PhotonProbe, Probe, Question};
use etendue_report::pictures;
use etendue_spectrum::bandwidth::{Widest, bandwidth_nu, bandwidth_rho};
use etendue_spectrum::{CrossPower, Measurement, Uncertain, measure};
use etendue_store::Failure;
use etendue_store::sealed::json;
use etendue_store::stored::VERSION;
use etendue_store::{PROBE, Plan, Results, arrays};
use etendue_world::Camera;
use said::{of_plane, of_stop, said};
use serde_json::{Value, json as tree_of};
use std::path::{Path, PathBuf};

/// Batches of rays and of photons, from whose differences errors and p are found.
const BATCHES: u32 = 64;
/// Of all planes together.
const ALPHA: f64 = 0.01;
/// A plane passes when its noise is not above this share of its spectrum.
const RESOLUTION: f64 = 0.1;

/// Frequencies on either side of zero, half a cycle a window apart.
const FREQUENCIES: usize = 12;

/// What came of a plane.
#[derive(Debug)]
struct Found {
    comparison: PlaneComparison,
    nu: Option<Widest<Uncertain>>,
    rho: Option<Widest<Uncertain>>,
    /// Why photons do not find all its light.
    misses: Option<&'static str>,
    /// The covariance of its spectrum, if it was asked for.
    covariance: Option<FoundCovariance>,
}

/// What is asked of which scene.
struct Case<'a> {
    args: &'a ProbeArgs,
    imported: Imported,
    camera: Camera,
    paths: Paths,
}

/// `etendue probe`: returns the exit code.
pub(crate) fn probe(args: &ProbeArgs) -> Result<u8, Failure> {
    let imported = world::load(&args.scene)?;
    world::require_light(&imported.world)?;
    let case = Case {
        args,
        camera: world::camera(&imported.world, &args.camera)?,
        paths: Paths::new(&imported.world),
        imported,
    };
    match (args.pixel, args.map) {
        (Some(pixel), _) => case.pixel(pixel),
        (None, Some(size)) => map::map(&case, size),
        (None, None) => unreachable!("clap asks for one of them"),
    }
}

impl Case<'_> {
    fn name(&self) -> String {
        let name = self.args.scene.path.file_stem().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    /// What results are made from.
    fn made_from(&self) -> Value {
        let name = self.args.scene.path.file_name();
        tree_of!({
            "scene": name.map(|name| name.to_string_lossy()),
            "camera": self.camera.name,
            "seed": self.args.seed,
            "version": VERSION,
            "notes": world::notes(&self.imported),
        })
    }

    fn question(&self, pixel: [usize; 2], azimuths: usize) -> Question {
        Question {
            pixel,
            surfaces: self.args.surfaces.into(),
            across: self.args.window,
            frequencies: FREQUENCIES,
            azimuths,
        }
    }

    /// Claims the folder that is asked for, or one of this name.
    fn claim(&self, name: String, files: Vec<String>) -> Result<(Results, PathBuf), Failure> {
        let folder = self.args.out.clone();
        let folder = folder.unwrap_or_else(|| Path::new("out").join(name));
        let plan = Plan {
            index: PROBE,
            files,
            inputs: vec![self.args.scene.path.clone()],
            force: self.args.force.force,
        };
        Ok((Results::claim(&folder, plan)?, folder))
    }

    /// The light field behind one pixel.
    fn pixel(&self, pixel: [usize; 2]) -> Result<u8, Failure> {
        let [[column, row], [w, h]] = [pixel, self.camera.size];
        if column >= w || row >= h {
            let [w, h] = [w - 1, h - 1];
            let message = format!("--pixel {column},{row}; allowed: 0,0 to {w},{h}");
            return Err(Failure::bad_input(message));
        }
        let question = self.question(pixel, 4);
        let probe = Probe::new(&self.paths, &self.camera, &question).ok_or_else(|| {
            Failure::bad_input(
                "the ray through this pixel meets nothing, or the camera is orthographic",
            )
        })?;
        let name = self.name();
        let files = probe.planes.iter().flat_map(|plane| files_of(&plane.name));
        let (results, folder) = self.claim(format!("{name}-{column}-{row}"), files.collect())?;
        let found = on_threads(&self.args.threads, || measured(self.args, &probe))?;
        let note = format!("{name}, pixel {column}, {row}; backward rays | photons");
        let verdict = self.written(results, &note, pixel, &probe, &found)?;
        if !self.args.quiet {
            let found: Vec<&Found> = found.iter().map(|(found, _)| found).collect();
            deliver(&said(&self.imported.world, &probe, &found, self.args.surfaces).join("\n"))?;
            deliver(&format!("results: {}", folder.display()))?;
        }
        Ok(match verdict {
            Verdict::Pass => 0,
            Verdict::Fail => 1,
            Verdict::Undecided => 4,
        })
    }

    /// Writes everything, and says what it comes to.
    fn written(
        &self,
        mut results: Results,
        note: &str,
        pixel: [usize; 2],
        probe: &Probe<'_>,
        found: &[(Found, Prediction)],
    ) -> Result<Verdict, Failure> {
        let mut made_from = self.made_from();
        made_from["pixel"] = tree_of!(pixel);
        made_from["rays"] = tree_of!(self.args.rays());
        for (plane, (found, photons)) in probe.planes.iter().zip(found) {
            arrays::write(&mut results, made_from.clone(), &found.comparison)?;
            pictures::plane(&mut results, note, photons, plane, &found.comparison)?;
        }
        let each = found.iter().map(|(found, _)| verdict(found));
        let verdict = each.fold(Verdict::Pass, Verdict::and);
        let stops = probe.stops.iter();
        let finished = results.finish(|files| {
            made_from["verdict"] = tree_of!(verdict);
            made_from["surfaces"] = stops
                .map(|stop| of_stop(&self.imported.world, stop))
                .collect();
            made_from["planes"] = found.iter().map(|(found, _)| of_plane(found)).collect();
            made_from["files"] = tree_of!(files);
            json(&made_from)
        })?;
        say_replaced(&finished, self.args.quiet);
        Ok(verdict)
    }
}

fn files_of(name: &str) -> impl Iterator<Item = String> + use<'_> {
    let files = arrays::NAMES.into_iter().chain(pictures::NAMES);
    files.map(move |file| format!("{name}/{file}"))
}

/// Backward rays and photons of all planes, held against each other.
fn measured(args: &ProbeArgs, probe: &Probe<'_>) -> Result<Vec<(Found, Prediction)>, Failure> {
    let each = |count: u64| count.div_ceil(u64::from(BATCHES));
    let budget = |each| Budget {
        each,
        seed: args.seed,
    };
    let rays = BackwardProbe::new(probe, budget(each(args.rays())));
    let photons = PhotonProbe::new(
        probe,
        Budget {
            seed: !args.seed,
            ..budget(each(args.photons))
        },
    );
    let trace = |source: &dyn PhotonSource, count| -> Measurement {
        let bar = progress::photons(count, args.quiet);
        let found = measure(source, &probe.planes, 0..BATCHES, &|done| bar.inc(done));
        bar.finish_and_clear();
        found
    };
    let backward = trace(&rays, args.rays());
    let forward = trace(&photons, args.photons);
    let test = Test {
        level: sidak(ALPHA, probe.planes.len()),
        resolution: RESOLUTION,
        seed: args.seed,
    };
    let plane = |i: usize| {
        let prediction = Prediction::measured(&forward, i).map_err(Failure::cannot_run)?;
        let comparison = compare(&backward, i, &prediction, &test).map_err(Failure::cannot_run)?;
        let power = CrossPower::new(&backward, i).map_err(Failure::cannot_run)?;
        let found = Found {
            comparison,
            nu: power.bandwidth(bandwidth_nu),
            rho: power.bandwidth(bandwidth_rho),
            misses: photons.misses(i),
            covariance: None,
        };
        Ok((found, prediction))
    };
    let planes: Result<Vec<_>, Failure> = (0..probe.planes.len()).map(plane).collect();
    let mut planes = planes?;
    if args.covariance {
        let all = covariance::measured(probe, budget(each(args.rays())), args.quiet)?;
        for ((found, _), covariance) in planes.iter_mut().zip(all) {
            found.covariance = Some(covariance);
        }
    }
    Ok(planes)
}

/// Where photons do not find all light, nothing is judged. Where neither finds any, they agree.
fn verdict(found: &Found) -> Verdict {
    match found.misses {
        Some(_) => Verdict::Undecided,
        None if found.is_dark() => Verdict::Pass,
        None => found.comparison.report.verdict,
    }
}

impl Found {
    /// Whether neither rays nor photons found light.
    fn is_dark(&self) -> bool {
        self.comparison.measured.is_dark() && self.comparison.predicted.is_dark()
    }
}
