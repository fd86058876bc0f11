//! The light field behind a pixel.

use crate::args::ProbeArgs;
use crate::failure::Failure;
use crate::results::sealed::json;
use crate::results::stored::VERSION;
use crate::results::{PROBE, Plan, Results, arrays};
use crate::table::aligned;
use crate::threads::on_threads;
use crate::{deliver, pictures, progress, world};
use etendue_compare::{PlaneComparison, Prediction, Test, Verdict, compare, sidak};
use etendue_field::{Lobe, PhotonSource, uncertain};
use etendue_paths::{BackwardProbe, Budget, Paths, PhotonProbe, Probe, Question, Reflects, Stop};
use etendue_spectrum::moments::{BANDWIDTH_FRACTION, bandwidth_nu, bandwidth_rho};
use etendue_spectrum::{CrossPower, Measurement, Uncertain, measure};
use etendue_theory::shading::{self, Criterion};
use etendue_world::World;
use serde_json::{Value, json as tree_of};
use std::path::Path;

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
    nu: Option<Uncertain>,
    rho: Option<Uncertain>,
    /// Why photons do not find all its light.
    misses: Option<&'static str>,
}

/// `etendue probe`: returns the exit code.
pub(crate) fn probe(args: &ProbeArgs) -> Result<u8, Failure> {
    let imported = world::load(&args.scene)?;
    let camera = world::camera(&imported.world, &args.camera)?;
    let [column, row] = args.pixel;
    let [w, h] = camera.size;
    if column >= w || row >= h {
        let message = format!(
            "--pixel {column},{row}; allowed: 0,0 to {},{}",
            w - 1,
            h - 1
        );
        return Err(Failure::bad_input(message));
    }
    let paths = Paths::new(&imported.world);
    let question = Question {
        pixel: args.pixel,
        surfaces: args.surfaces.into(),
        across: args.window,
        frequencies: FREQUENCIES,
        azimuths: 4,
    };
    let probe = Probe::new(&paths, &camera, &question).ok_or_else(|| {
        Failure::bad_input(
            "the ray through this pixel meets nothing, or the camera is orthographic",
        )
    })?;
    let name = args
        .scene
        .path
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy();
    let folder = args.out.clone();
    let folder = folder.unwrap_or_else(|| Path::new("out").join(format!("{name}-{column}-{row}")));
    let plan = Plan {
        index: PROBE,
        files: probe
            .planes
            .iter()
            .flat_map(|plane| files_of(&plane.name))
            .collect(),
        inputs: vec![args.scene.path.clone()],
        force: args.force.force,
    };
    let mut results = Results::claim(&folder, plan)?;
    let found = on_threads(&args.threads, || measured(args, &probe))?;
    let made_from = tree_of!({
        "scene": args.scene.path.file_name().map(|name| name.to_string_lossy()),
        "camera": camera.name,
        "pixel": args.pixel,
        "rays": args.rays,
        "seed": args.seed,
        "version": VERSION,
    });
    let note = format!("{name}, pixel {column}, {row}; backward rays | photons");
    for (plane, found) in probe.planes.iter().zip(&found) {
        arrays::write(&mut results, made_from.clone(), &found.0.comparison)?;
        pictures::plane(&mut results, &note, &found.1, plane, &found.0.comparison)?;
    }
    let found: Vec<Found> = found.into_iter().map(|(found, _)| found).collect();
    let verdict = found.iter().map(verdict).fold(Verdict::Pass, Verdict::and);
    let finished = results.finish(|files| {
        let mut index = made_from.clone();
        index["verdict"] = tree_of!(verdict);
        index["surfaces"] = probe
            .stops
            .iter()
            .map(|stop| of_stop(&imported.world, stop))
            .collect();
        index["planes"] = found.iter().map(of_plane).collect();
        index["files"] = tree_of!(files);
        json(&index)
    })?;
    finished.tell_replaced(args.quiet);
    if !args.quiet {
        deliver(&said(&imported.world, &probe, &found).join("\n"))?;
        deliver(&format!("results: {}", folder.display()))?;
    }
    Ok(match verdict {
        Verdict::Pass => 0,
        Verdict::Fail => 1,
        Verdict::Undecided => 4,
    })
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
    let rays = BackwardProbe::new(probe, budget(each(args.rays)));
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
    let backward = trace(&rays, args.rays);
    let forward = trace(&photons, args.photons);
    let test = Test {
        level: sidak(ALPHA, probe.planes.len()),
        resolution: RESOLUTION,
        seed: args.seed,
    };
    let plane = |i: usize| {
        let prediction = Prediction::measured(&forward, i).map_err(Failure::cannot_run)?;
        let comparison = compare(&backward, i, &prediction, &test).map_err(Failure::cannot_run)?;
        let grid = probe.planes[i].grid;
        let power = CrossPower::new(&backward, i).map_err(Failure::cannot_run)?;
        let found = Found {
            comparison,
            nu: power.statistic(|p| bandwidth_nu(p, &grid, BANDWIDTH_FRACTION)),
            rho: power.statistic(|p| bandwidth_rho(p, &grid, BANDWIDTH_FRACTION)),
            misses: photons.misses(i),
        };
        Ok((found, prediction))
    };
    (0..probe.planes.len()).map(plane).collect()
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

/// The paper's criterion for light that leaves a surface, in cycles per radian at the camera (Durand et al. 2005, Eq. 20, corrected); `None` where it has
/// no lobe.
fn criterion(stop: &Stop) -> Option<f64> {
    let Reflects::Lobe(lobe) = stop.reflects else {
        return None;
    };
    let cutoff = match lobe {
        Lobe::Phong { exponent } => shading::Lobe::Phong { exponent },
        Lobe::Beckmann { roughness } => shading::Lobe::Beckmann { roughness },
        Lobe::Ggx { roughness } => shading::Lobe::Ggx { roughness },
        Lobe::Lambertian => return None,
    }
    .cutoff(BANDWIDTH_FRACTION);
    let angle = libm::acos(stop.cosine().clamp(-1.0, 1.0));
    let of = Criterion {
        curvature: stop.curvature[0],
        incidence: angle,
        outgoing: angle,
        distance: stop.distance,
        blocker_distance: None,
        lobe_cutoff: cutoff,
        environment_cutoff: f64::INFINITY,
    };
    Some(of.environment())
}

fn of_stop(world: &World, stop: &Stop) -> Value {
    tree_of!({
        "shape": world.shapes[stop.shape].name,
        "position": stop.position.to_array(),
        "normal": stop.normal.to_array(),
        "distance": stop.distance,
        "angle": libm::acos(stop.cosine().clamp(-1.0, 1.0)),
        "curvature": stop.curvature,
        "reflects": word(stop.reflects),
        "criterion": criterion(stop),
    })
}

fn of_plane(found: &Found) -> Value {
    let number = |of: &Option<Uncertain>| of.map(|of| [of.value, of.error]);
    tree_of!({
        "report": found.comparison.report,
        "verdict": verdict(found),
        "photons_miss": found.misses,
        "bandwidth_95": { "nu": number(&found.nu), "rho": number(&found.rho) },
    })
}

fn word(reflects: Reflects) -> String {
    match reflects {
        Reflects::Nothing => "nothing: it is black from here".to_owned(),
        Reflects::Diffuse => "diffuse".to_owned(),
        Reflects::Mirror => "mirror or smooth interface".to_owned(),
        Reflects::Lobe(lobe) => match lobe {
            Lobe::Lambertian => "diffuse".to_owned(),
            Lobe::Phong { exponent } => format!("Phong, exponent {exponent}"),
            Lobe::Beckmann { roughness } => format!("Beckmann, roughness {roughness}"),
            Lobe::Ggx { roughness } => format!("GGX, roughness {roughness}"),
        },
    }
}

/// The surfaces, the planes, and how densely the picture is to be sampled.
fn said(world: &World, probe: &Probe<'_>, found: &[Found]) -> Vec<String> {
    let header = [
        "surface",
        "shape",
        "reflects",
        "distance",
        "angle [°]",
        "curvatures [1/m]",
    ];
    let surfaces = probe.stops.iter().enumerate().map(|(i, stop)| {
        let angle = libm::acos(stop.cosine().clamp(-1.0, 1.0)).to_degrees();
        let [along, across] = stop.curvature;
        vec![
            (i + 1).to_string(),
            world.shapes[stop.shape].name.clone(),
            word(stop.reflects),
            format!("{:.4}", stop.distance),
            format!("{angle:.2}"),
            format!("{along:.4}, {across:.4}"),
        ]
    });
    let header = vec![header.map(str::to_owned).to_vec()];
    let mut lines = aligned(header.into_iter().chain(surfaces).collect());
    lines.push(String::new());
    let header = [
        "plane",
        "noise alone",
        "p",
        "95 % of ν",
        "95 % of ρ [1/m]",
        "verdict",
    ];
    let shown =
        |of: &Option<Uncertain>| of.map_or("–".to_owned(), |of| uncertain(of.value, of.error));
    let planes = found.iter().map(|found| {
        let report = &found.comparison.report;
        let percent =
            |x: Option<f64>| x.map_or("–".to_owned(), |x| format!("{:.3} %", 100.0 * x));
        vec![
            report.name.clone(),
            percent(report.noise_limit),
            report.p_value.map_or("–".to_owned(), |p| format!("{p:.5}")),
            shown(&found.nu),
            shown(&found.rho),
            match found.misses {
                Some(what) => format!("undecided: photons do not find light from {what}"),
                None if found.is_dark() => "dark".to_owned(),
                None => format!("{:?}", report.verdict).to_lowercase(),
            },
        ]
    });
    let header = vec![header.map(str::to_owned).to_vec()];
    lines.extend(aligned(header.into_iter().chain(planes).collect()));
    lines.push(String::new());
    if let Some(nu) = found.first().and_then(|camera| camera.nu) {
        let samples = |cycles: f64| 2.0 * cycles * probe.pixel_slope;
        lines.push(format!(
            "shading samples a pixel and direction: measured {:.4}{}",
            samples(nu.value),
            criterion(&probe.stops[0]).map_or(String::new(), |cycles| {
                format!(
                    "; by Eq. 20, corrected, for light of all frequencies {:.4}",
                    samples(cycles)
                )
            })
        ));
    }
    lines
}
