//! A tracer that reads the scene file, not the resolved scene.
//!
//! Theory, photons and backward rays share what a scene file resolves to. If that is wrong, all
//! three agree on the wrong number. This tracer shares only the types of the file: surfaces, masks
//! and lights stand at their places in the world, a path chooses a point on each surface that light
//! visits, and every piece of the path is tested against everything. It computes one number, the
//! spectrum at zero frequency, and photons must find the same number.

mod lamp;
mod mask;
mod path;
mod planted;
#[cfg(test)]
mod tests;
mod world;

use crate::hostile::dice::Dice;
use crate::progress::in_parallel;
use crate::report::{Check, ReportSection, Row};
use crate::scenes::{traced, traced_backwards};
use crate::statistics::mean;
use crate::wild::{MORE_PHOTONS, plain_scene, text};
use etendue_scene::{Scene, SceneFile, resolve};
use lamp::Lamp;
pub(super) use mask::is_in_hole;
use path::{Choice, NUMBERS};
use planted::FAULTS;
use std::path::{Path, PathBuf};
use std::{fmt, fs, io};
use world::PlainWorld;

/// Options of the comparison.
#[derive(Debug, clap::Args)]
pub(crate) struct PlainOptions {
    /// Number of random scenes.
    #[arg(long, default_value_t = 2000)]
    scenes: u64,
    /// Index of the first scene.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Seed of the random scenes.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Maximum number of photons per scene.
    #[arg(long, default_value_t = 1 << 22)]
    photons: u64,
    /// Compare this scene file alone.
    #[arg(long)]
    scene: Option<PathBuf>,
    /// Plant faults in the resolved scenes; each must be found.
    #[arg(long)]
    planted: bool,
    /// Folder for scenes in which the tracers disagree.
    #[arg(long, default_value = "target/plain")]
    out: PathBuf,
}

/// Independent shifts of the points; their spread is the error.
const SHIFTS: u64 = 32;
/// The first and the largest number of paths of each lamp, and the largest if a BRDF of the scene
/// takes long.
const PATHS: [u64; 3] = [1 << 15, 1 << 21, 1 << 18];
/// The first number of photons.
const PHOTONS: u64 = 1 << 16;
/// Rays are added until the error is this share of the light. Two such errors together are less
/// than [`RESOLVED`].
const PRECISE: f64 = 3e-3;
/// Factor by which the number of rays grows at most from one estimate to the next. If few rays
/// bring light, their error is not known well.
const GROWTH: f64 = 8.0;
/// Rays are not added if, at the largest number, the error would still be this many times too
/// large.
const HOPELESS: f64 = 2.0;
/// A scene counts if the error of the difference is at most this share of the light.
const RESOLVED: f64 = 5e-3;
/// The difference, in standard errors, beyond which a scene is compared again with other points and
/// other photons. Correct scenes do so once in 16,000.
const MAX_DEVIATION: f64 = 4.0;
/// The seed of the points that choose between paths.
const PILOT: u64 = 0x70_696c_6f74;
/// Fewer paths or photons with light do not tell their error.
const MIN_LIT: u64 = 1000;
/// If the error of an estimate is a larger share of the light, a few rays carry most of the light,
/// and the error is not known either.
const MAX_NOISE: f64 = 0.1;
/// If masks leave a smaller share of the light, at most 26 of the first photons find it.
const MIN_SHARE: f64 = 1e-4;

/// An estimate with its standard error.
#[derive(Clone, Copy)]
struct Estimate {
    mean: f64,
    error: f64,
    /// Number of paths or photons that bring light.
    count: u64,
}

impl Estimate {
    const ZERO: Self = Self {
        mean: 0.0,
        error: 0.0,
        count: 0,
    };

    /// Whether enough rays bring light to know the error.
    fn is_lit(&self) -> bool {
        self.count >= MIN_LIT
    }

    /// The relative error, or infinity if it is not known.
    fn noise(&self) -> f64 {
        if self.is_lit() {
            self.error / self.mean
        } else {
            f64::INFINITY
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            mean: self.mean + other.mean,
            error: self.error.hypot(other.error),
            count: self.count + other.count,
        }
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.4e} ± {:.1e}", self.mean, self.error)
    }
}

/// Two estimates of the light in the window.
#[derive(Clone, Copy)]
struct Pair {
    plain: Estimate,
    photons: Estimate,
    /// Whether the rays cannot tell whether the estimates differ.
    is_faint: bool,
}

impl Pair {
    /// Whether both tracers bring enough light to know their errors.
    fn is_lit(&self) -> bool {
        self.plain.is_lit() && self.photons.is_lit()
    }

    /// Whether one tracer brings light, and the other brings none at all.
    fn is_dark_in_one(&self) -> bool {
        let [plain, photons] = [&self.plain, &self.photons];
        (plain.is_lit() && photons.count == 0) || (photons.is_lit() && plain.count == 0)
    }

    fn deviation(&self) -> f64 {
        if self.is_faint || !self.is_lit() && !self.is_dark_in_one() {
            return 0.0;
        }
        let error = self.plain.error.hypot(self.photons.error);
        let apart = self.photons.mean - self.plain.mean;
        if apart == 0.0 { 0.0 } else { apart / error }
    }

    /// Whether the pair could show a difference of half a percent.
    fn is_resolved(&self) -> bool {
        if !self.is_lit() {
            return false;
        }
        let error = self.plain.error.hypot(self.photons.error);
        error <= RESOLVED * self.plain.mean.max(self.photons.mean)
    }
}

/// Compares random scenes, or one.
pub(crate) fn plain(options: &PlainOptions) -> io::Result<ReportSection> {
    if let Some(path) = &options.scene {
        return one(options, path);
    }
    let faults: Vec<Option<usize>> = if options.planted {
        (0..FAULTS.len()).map(Some).collect()
    } else {
        vec![None]
    };
    let tasks = faults.iter().flat_map(|fault| {
        let numbers = options.first..options.first + options.scenes;
        numbers.map(move |number| (*fault, number))
    });
    let compared = in_parallel(tasks, "scenes", |(fault, number)| {
        let found = random(options, number, fault)?;
        Ok((fault, number, found))
    });
    let compared: Vec<_> = compared.into_iter().collect::<io::Result<_>>()?;
    let rows = faults.iter().map(|fault| {
        let of_fault = compared.iter().filter(|(of, ..)| of == fault);
        let pairs = of_fault.filter_map(|(_, number, pair)| Some((*number, (*pair)?)));
        row(*fault, options.scenes, &pairs.collect::<Vec<_>>())
    });
    Ok(section(options, rows.collect()))
}

/// Compares a scene file.
fn one(options: &PlainOptions, path: &Path) -> io::Result<ReportSection> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let file = SceneFile::parse(&fs::read_to_string(path)?).map_err(io::Error::other)?;
    let scene = resolve("plain", file.clone(), folder, u64::MAX).map_err(io::Error::other)?;
    let world = PlainWorld::new(&file).ok_or_else(|| {
        io::Error::other("the plain tracer has no meshes, pictures, ray files, or other planes")
    })?;
    let pair = judged(world, &scene, options.photons);
    let Pair { plain, photons, .. } = pair;
    let text = format!("Paths find {plain}, photons {photons} W m⁻² sr⁻¹ m².");
    Ok(section(options, vec![row(None, 1, &[(0, pair)])]).with_text(text))
}

/// Draws a scene and compares it. A fault is planted in the resolved scene. Returns `None` if the
/// plain tracer does not have everything in the scene, or the fault does not apply.
fn random(options: &PlainOptions, number: u64, fault: Option<usize>) -> io::Result<Option<Pair>> {
    let folder = tempfile::tempdir()?;
    let Some(file) = plain_scene(options.seed, number, options.photons, folder.path()) else {
        return Ok(None);
    };
    let Some(world) = PlainWorld::new(&file) else {
        return Ok(None);
    };
    let resolved = resolve("plain", file.clone(), folder.path(), u64::MAX);
    let mut scene = resolved.map_err(io::Error::other)?;
    if let Some(fault) = fault
        && !planted::plant(FAULTS[fault], &mut scene)
    {
        return Ok(None);
    }
    let pair = judged(world, &scene, options.photons);
    if fault.is_none() && pair.deviation().abs() > MAX_DEVIATION {
        fs::create_dir_all(&options.out)?;
        let name = format!("{}-{number}.ron", options.seed);
        fs::write(options.out.join(name), text(&file)?)?;
    }
    Ok(Some(pair))
}

/// Compares a scene; if the tracers are far apart, compares it once more.
fn judged(mut world: PlainWorld, scene: &Scene, photons: u64) -> Pair {
    let compared = |world: &PlainWorld, seed: u64, more: u64| {
        let plain = by_paths(world, seed, more);
        // If paths do not resolve the light, photons need not resolve it either.
        let most = if plain.noise() <= RESOLVED {
            photons
        } else {
            photons.min(4 * PHOTONS)
        };
        let rays = [PHOTONS, most.max(PHOTONS)].map(|rays| more * rays);
        Pair {
            plain,
            photons: by_photons(scene, seed, rays),
            is_faint: false,
        }
    };
    let mut found = compared(&world, 1, 1);
    if found.deviation().abs() > MAX_DEVIATION {
        found = compared(&world, 2, MORE_PHOTONS);
    }
    if found.deviation().abs() > MAX_DEVIATION {
        found.is_faint = if found.is_dark_in_one() {
            world.masks.clear();
            found.plain.mean.max(found.photons.mean) < MIN_SHARE * by_paths(&world, 1, 1).mean
        } else {
            found.plain.noise().max(found.photons.noise()) > MAX_NOISE
        };
    }
    found
}

/// An estimate by as many rays as it needs, from the first number to the largest.
fn precise([first, most]: [u64; 2], estimate: impl Fn(u64) -> Estimate) -> Estimate {
    let mut rays = first;
    loop {
        let found = estimate(rays);
        let more = (found.error / (PRECISE * found.mean)).powi(2);
        let possible = most as f64 / rays as f64;
        let is_hopeless = if found.is_lit() {
            more > HOPELESS.powi(2) * possible
        } else {
            found.count as f64 * possible < MIN_LIT as f64
        };
        if rays >= most || more <= 1.0 || is_hopeless {
            return found;
        }
        // A tenth more, because the error has an error.
        let wanted = rays as f64 * (1.1 * more).min(GROWTH);
        while rays < most && (rays as f64) < wanted {
            rays *= 2;
        }
    }
}

/// The light by photons or backward rays through the resolved scene, whichever have less
/// noise.
fn by_photons(scene: &Scene, seed: u64, [first, most]: [u64; 2]) -> Estimate {
    let measured = |is_backward: bool, seed: u64, photons: u64| {
        let mut scene = scene.clone();
        (scene.run.seed, scene.run.photons) = (seed, photons);
        let measurement = if is_backward {
            traced_backwards(&scene)?
        } else {
            traced(&scene)
        };
        let values = measurement.at_plane(0).map(|batch| batch.slices.at_zero());
        Some(Estimate {
            count: measurement.tally(0).inside,
            ..estimate(&values.collect::<Vec<f64>>())
        })
    };
    let pilot = |is_backward: bool| measured(is_backward, PILOT, first / 2);
    let noise = |is_backward: bool| pilot(is_backward).map_or(f64::INFINITY, |it| it.noise());
    let is_backward = noise(true) < noise(false);
    precise([first, most], |rays| {
        measured(is_backward, seed, rays).unwrap_or(Estimate::ZERO)
    })
}

/// The light of all lamps by paths.
fn by_paths(world: &PlainWorld, seed: u64, least: u64) -> Estimate {
    let [first, most, most_slow] = PATHS;
    let is_slow = world.surfaces.iter().any(world::PlainSurface::is_slow);
    let most = if is_slow { most_slow } else { most };
    // Other points than those of the estimate tell which paths have less noise.
    let choices: Vec<Choice> = world.lamps.iter().map(|lamp| choice(world, lamp)).collect();
    precise([least * first, most.max(least * first)], |paths| {
        let each = world.lamps.iter().zip(&choices).enumerate();
        let each = each.map(|(i, (lamp, choice))| of_lamp(world, lamp, *choice, (seed, i), paths));
        each.fold(Estimate::ZERO, Estimate::plus)
    })
}

/// The choice of paths with the smaller relative error.
fn choice(world: &PlainWorld, lamp: &Lamp) -> Choice {
    if !world.connects(lamp) {
        return Choice::Forward;
    }
    let noise = |choice: Choice| of_lamp(world, lamp, choice, (PILOT, 0), PATHS[0]).noise();
    if noise(Choice::Connected) < noise(Choice::Forward) {
        Choice::Connected
    } else {
        Choice::Forward
    }
}

fn of_lamp(
    world: &PlainWorld,
    lamp: &Lamp,
    choice: Choice,
    (seed, number): (u64, usize),
    paths: u64,
) -> Estimate {
    let mut count = 0;
    let points = u32::try_from(paths / SHIFTS).unwrap_or(u32::MAX);
    let shifts = (0..SHIFTS).map(|shift| {
        let mut dice = Dice::new(seed, SHIFTS * number as u64 + shift);
        let shift = [0; NUMBERS].map(|_| dice.unit());
        let each = (0..points).map(|i| world.light(lamp, choice, &shifted(i, &shift)));
        let lit = each.filter(|light| *light > 0.0).inspect(|_| count += 1);
        lit.sum::<f64>() / f64::from(points)
    });
    let shifts: Vec<f64> = shifts.collect();
    Estimate {
        count,
        ..estimate(&shifts)
    }
}

/// A point of a Kronecker sequence: multiples of powers of the generalised golden ratio,
/// the root of x^(n + 1) = x + 1, modulo 1.
fn shifted(index: u32, shift: &[f64; NUMBERS]) -> [f64; NUMBERS] {
    let golden = (0..60).fold(1.0_f64, |x, _| (x + 1.0).powf(1.0 / (NUMBERS as f64 + 1.0)));
    let mut step = 1.0;
    shift.map(|shift| {
        step /= golden;
        (shift + f64::from(index) * step).fract()
    })
}

fn estimate(values: &[f64]) -> Estimate {
    let [mean, error] = mean(values);
    Estimate {
        mean,
        error,
        count: 0,
    }
}

fn row(fault: Option<usize>, drawn: u64, pairs: &[(u64, Pair)]) -> Row {
    let resolved: Vec<_> = pairs
        .iter()
        .filter(|(_, pair)| pair.is_resolved())
        .collect();
    let far: Vec<String> = pairs
        .iter()
        .filter(|(_, pair)| pair.deviation().abs() > MAX_DEVIATION)
        .map(|(number, pair)| {
            let off = 100.0 * (pair.photons.mean / pair.plain.mean - 1.0);
            format!("{number} ({off:+.1} %, {:+.1} σ)", pair.deviation())
        })
        .collect();
    let squares = resolved.iter().map(|(_, pair)| pair.deviation().powi(2));
    let rms = (squares.sum::<f64>() / resolved.len() as f64).sqrt();
    let sizes = resolved.iter().map(|(_, pair)| pair.deviation().abs());
    let largest = sizes.fold(0.0, f64::max);
    let checks = match fault {
        None => {
            let is_known =
                Check::fact("resolved", !resolved.is_empty(), "a scene must be resolved");
            vec![Check::none("apart", far.len()), is_known]
        }
        Some(_) => vec![Check::fact(
            "seen",
            !far.is_empty(),
            "a fault must be found",
        )],
    };
    let cells = vec![
        fault.map_or("none", |fault| FAULTS[fault]).to_owned(),
        drawn.to_string(),
        pairs.len().to_string(),
        resolved.len().to_string(),
        format!("{rms:.2}"),
        format!("{largest:.2}"),
        far.len().to_string(),
        far.iter().take(8).cloned().collect::<Vec<_>>().join(", "),
    ];
    Row::new(cells, checks)
}

fn section(options: &PlainOptions, rows: Vec<Row>) -> ReportSection {
    ReportSection::new(
        format!("A tracer of scene files, seed {}", options.seed),
        format!(
            "The light in the window of a random plane, ∫ L W, by at most {} photons or backward \
             rays through the resolved scene, and by paths through the objects of the scene file. \
             Scenes with meshes, pictures or ray files are not compared. *Resolved* scenes would \
             show a difference of {} %. Required: no scene differs by more than {MAX_DEVIATION} \
             standard errors twice (the second time with other points, other photons and at least \
             {MORE_PHOTONS} times the first number of both), and each fault that is planted in the \
             resolved scene is found.",
            options.photons,
            100.0 * RESOLVED,
        ),
        "planted fault | drawn | compared | resolved | rms deviation, σ | largest, σ | apart | \
         numbers of scenes apart | verdict",
        rows,
    )
}
