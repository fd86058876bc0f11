mod faults;
mod jitter;
mod planes;

use crate::fault::SceneError;
use crate::file::{BlockersFile, LightFile, RunFile, SceneFile, SurfaceFile};
use crate::scene::{BlockerLayer, CentralRay, Light, Run, Scene, Surface};
use etendue_field::{Frame, Rectangle};
use faults::{Faults, show};
use glam::DVec3;
use jitter::jittered_squares;

/// Checks a scene file and resolves it to a scene; `memory` is what this machine can hold, in bytes.
///
/// # Errors
/// [`SceneError::Values`] with every fault found.
pub fn resolve(name: &str, file: SceneFile, memory: u64) -> Result<Scene, SceneError> {
    let mut faults = Faults::default();
    let scene = Resolver {
        faults: &mut faults,
    }
    .scene(name, file, memory);
    match scene {
        Some(scene) if faults.0.is_empty() => Ok(scene),
        _ => Err(SceneError::Values(faults.0)),
    }
}

/// Blockers a layer may hold: the prediction of more that are seen takes many minutes.
const MOST_BLOCKERS: u64 = 100_000;
/// Products of blockers of several layers a prediction may have to go through.
const MOST_PAIRS: f64 = 1e6;
/// Ten times the smallest p-value there is.
const LEAST_LEVEL: f64 = 5e-4;
/// Relative distance below which two planes across the path are one.
const SAME_PLANE: f64 = 1e-9;

struct Resolver<'a> {
    faults: &'a mut Faults,
}

impl Resolver<'_> {
    fn scene(&mut self, name: &str, file: SceneFile, memory: u64) -> Option<Scene> {
        let frame = self.frame(&file);
        let light = self.light(&file.light);
        self.run(&file.run);
        self.level(file.run.alpha, file.planes.len());
        self.layers(&file);
        // Without a frame no distance is known: check on with one that leaves the values as they are.
        let checked = frame.unwrap_or(Frame {
            origin: DVec3::ZERO,
            x: DVec3::X,
            y: DVec3::Y,
            d: DVec3::Z,
        });
        let surfaces: Vec<Surface> = file
            .surfaces
            .iter()
            .enumerate()
            .map(|(i, s)| self.surface(i, s, &checked))
            .collect();
        let length = self.length(&file, &surfaces);
        let blockers: Vec<BlockerLayer> = file
            .blockers
            .iter()
            .enumerate()
            .map(|(i, b)| self.blockers(i, b, &checked, length))
            .collect();
        self.names(&file, &blockers, &surfaces);
        let stops: Vec<Stop<'_>> = stops(&blockers, &surfaces);
        self.distinct(&stops);
        let planes = self.planes(&file, &checked, length, &stops);
        self.memory(&planes, file.run.batches, memory);

        let mut blockers = blockers;
        blockers.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        Some(Scene {
            name: name.to_owned(),
            path: CentralRay {
                frame: frame?,
                length,
            },
            light,
            blockers,
            surfaces,
            planes,
            run: Run {
                photons: file.run.photons,
                seed: file.run.seed,
                batches: file.run.batches,
                alpha: file.run.alpha,
                emission: file.run.emission,
            },
            file,
        })
    }

    fn frame(&mut self, file: &SceneFile) -> Option<Frame> {
        let LightFile::Rectangle { center, .. } = &file.light;
        let path = &file.path;
        self.faults.coordinates("path.direction", &path.direction);
        self.faults.coordinates("path.x_axis", &path.x_axis);
        let (d, x) = (DVec3::from(path.direction), DVec3::from(path.x_axis));
        let frame = Frame::new(DVec3::from(*center), d, x);
        if frame.is_none() && d.is_finite() && x.is_finite() {
            let allowed = "two directions that are not parallel, neither of length 0";
            self.faults.add(
                "path.direction and path.x_axis",
                format!("{d} and {x}"),
                allowed,
            );
        }
        frame
    }

    fn light(&mut self, light: &LightFile) -> Light {
        let LightFile::Rectangle {
            center,
            size,
            radiance,
        } = light;
        self.faults.coordinates("light.center", center);
        self.size("light", size);
        self.faults.positive("light.radiance", *radiance);
        Light {
            rectangle: Rectangle {
                center: [0.0; 2],
                size: *size,
            },
            radiance: *radiance,
        }
    }

    fn size(&mut self, of: &str, size: &[f64; 2]) {
        for (i, side) in size.iter().enumerate() {
            self.faults.positive(format!("{of}.size[{i}]"), *side);
        }
    }

    fn surface(&mut self, i: usize, surface: &SurfaceFile, frame: &Frame) -> Surface {
        let of = format!("surfaces[{i}]");
        self.faults
            .coordinates(&format!("{of}.center"), &surface.center);
        self.size(&of, &surface.size);
        self.faults
            .within(format!("{of}.albedo"), surface.albedo, 0.0..=1.0);
        let center = frame.to_local(DVec3::from(surface.center));
        self.ahead(&of, center.z);
        Surface {
            name: surface.name.clone(),
            distance: center.z,
            rectangle: Rectangle {
                center: [center.x, center.y],
                size: surface.size,
            },
            albedo: surface.albedo,
        }
    }

    /// A finite distance must be in front of the light; an infinite one is a fault of its center.
    fn ahead(&mut self, of: &str, distance: f64) {
        if distance <= 0.0 {
            let allowed = "a place in front of the light, along path.direction";
            self.faults.add(
                format!("{of}.center"),
                format!("at distance {distance} m from the light"),
                allowed,
            );
        }
    }

    /// The distance at which the central ray ends: that of the surface it visits.
    fn length(&mut self, file: &SceneFile, surfaces: &[Surface]) -> f64 {
        let [visit] = file.path.visits.as_slice() else {
            let allowed = "the name of one surface, on which the central ray ends";
            self.faults
                .add("path.visits", show(&file.path.visits), allowed);
            return f64::NAN;
        };
        let Some(surface) = surfaces.iter().find(|s| s.name == *visit) else {
            let known: Vec<&str> = surfaces.iter().map(|s| s.name.as_str()).collect();
            self.faults.add(
                "path.visits[0]",
                show(visit),
                format!("one of the surfaces: {}", known.join(", ")),
            );
            return f64::NAN;
        };
        if !surface.rectangle.contains(0.0, 0.0) && surface.distance.is_finite() {
            self.faults.add(
                "path.visits[0]",
                show(visit),
                "a surface that the central ray hits",
            );
        }
        for other in surfaces.iter().filter(|s| s.distance < surface.distance) {
            if other.rectangle.contains(0.0, 0.0) {
                let allowed = format!("{}, which the central ray hits first", show(&other.name));
                self.faults.add("path.visits[0]", show(visit), allowed);
            }
        }
        surface.distance
    }

    fn blockers(
        &mut self,
        i: usize,
        blockers: &BlockersFile,
        frame: &Frame,
        length: f64,
    ) -> BlockerLayer {
        let BlockersFile::JitteredSquares {
            name,
            center,
            count,
            pitch,
            fill,
            jitter,
            seed,
        } = blockers;
        let of = format!("blockers[{i}]");
        self.faults.coordinates(&format!("{of}.center"), center);
        let total = u64::from(count[0]) * u64::from(count[1]);
        if !(1..=MOST_BLOCKERS).contains(&total) {
            self.faults.add(
                format!("{of}.count"),
                format!("{} x {}", count[0], count[1]),
                format!("1 to {MOST_BLOCKERS} squares in all"),
            );
        }
        self.faults.positive(format!("{of}.pitch"), *pitch);
        self.faults
            .within(format!("{of}.fill"), *fill, f64::MIN_POSITIVE..=1.0);
        // Squares that may overlap would be counted twice by the prediction. Rounding must not refuse a
        // fill of 0.7 with a jitter of 0.3.
        if !(*jitter >= 0.0 && fill + jitter <= 1.0 + 1e-12) {
            self.faults.add(
                format!("{of}.jitter"),
                show(jitter),
                format!("0 to 1 − fill, which is {:.6}", 1.0 - fill),
            );
        }
        let center = frame.to_local(DVec3::from(*center));
        self.ahead(&of, center.z);
        if center.z >= length {
            self.faults.add(
                format!("{of}.center"),
                format!("at distance {} m from the light", center.z),
                format!("a place before the path ends, at {length} m"),
            );
        }
        let sound = self.faults.0.is_empty();
        BlockerLayer {
            name: name.clone(),
            distance: center.z,
            pitch: *pitch,
            rectangles: if sound {
                jittered_squares([center.x, center.y], *count, *pitch, *fill, *jitter, *seed)
            } else {
                Vec::new()
            },
        }
    }

    fn names(&mut self, file: &SceneFile, blockers: &[BlockerLayer], surfaces: &[Surface]) {
        let things = blockers
            .iter()
            .map(|b| &b.name)
            .chain(surfaces.iter().map(|s| &s.name));
        for repeated in repeated(things) {
            self.faults.add(
                "name",
                show(repeated),
                "a name no other blockers or surface has",
            );
        }
        // Some disks hold `Light` and `light` for one folder.
        let folders: Vec<String> = file.planes.iter().map(|p| p.name.to_lowercase()).collect();
        for repeated in repeated(folders.iter()) {
            self.faults
                .add("planes: name", show(repeated), "a name no other plane has");
        }
        let usable = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        for (i, plane) in file.planes.iter().enumerate() {
            let length = plane.name.chars().count();
            if !(1..=64).contains(&length) || !plane.name.chars().all(usable) {
                let allowed = "1 to 64 letters, digits, - and _: it names a folder";
                self.faults
                    .add(format!("planes[{i}].name"), show(&plane.name), allowed);
            }
        }
    }

    /// Two things in one plane: which one light meets first would be left to rounding.
    fn distinct(&mut self, stops: &[Stop<'_>]) {
        for pair in stops.windows(2) {
            if (pair[1].distance - pair[0].distance).abs() <= SAME_PLANE * pair[1].distance.abs() {
                self.faults.add(
                    format!("{} and {}", pair[0].name, pair[1].name),
                    format!("both at distance {} m", pair[1].distance),
                    "planes at different distances",
                );
            }
        }
    }

    fn run(&mut self, run: &RunFile) {
        if !(32..=1024).contains(&run.batches) {
            let allowed = "32 to 1024: errors come from the spread of batches";
            self.faults.add("run.batches", show(run.batches), allowed);
        }
        // A batch of one photon has a spread, one of none has not.
        let least = u64::from(run.batches);
        if !(least..=1_000_000_000_000).contains(&run.photons) {
            let allowed = format!("{least} (one for each batch) to 10^12");
            self.faults.add("run.photons", show(run.photons), allowed);
        }
        self.faults.within("run.alpha", run.alpha, 1e-6..=0.5);
    }

    /// The level of each plane must be one that a p-value can fall below.
    fn level(&mut self, alpha: f64, planes: usize) {
        let level = 1.0 - (1.0 - alpha).powf(1.0 / planes.max(1) as f64);
        if level < LEAST_LEVEL {
            let least = 1.0 - (1.0 - LEAST_LEVEL).powf(planes as f64);
            let allowed =
                format!("at least {least:.4} with {planes} planes: p is known to 1/20000");
            self.faults.add("run.alpha", show(alpha), allowed);
        }
    }

    /// A prediction multiplies the layers out.
    fn layers(&mut self, file: &SceneFile) {
        let squares = |b: &BlockersFile| {
            let BlockersFile::JitteredSquares { count, .. } = b;
            f64::from(count[0]) * f64::from(count[1])
        };
        let product: f64 = file.blockers.iter().map(squares).product();
        if product > MOST_PAIRS {
            let allowed =
                format!("at most {MOST_PAIRS:.0e} in all when the layers' squares are multiplied");
            self.faults
                .add("blockers: count", format!("{product:.1e}"), allowed);
        }
    }
}

/// Something that stands across the path.
struct Stop<'a> {
    name: &'a str,
    distance: f64,
    surface: bool,
}

/// Everything across the path, by distance.
fn stops<'a>(blockers: &'a [BlockerLayer], surfaces: &'a [Surface]) -> Vec<Stop<'a>> {
    let blockers = blockers.iter().map(|b| Stop {
        name: &b.name,
        distance: b.distance,
        surface: false,
    });
    let surfaces = surfaces.iter().map(|s| Stop {
        name: &s.name,
        distance: s.distance,
        surface: true,
    });
    let mut stops: Vec<Stop<'a>> = blockers.chain(surfaces).collect();
    stops.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    stops
}

fn repeated<'a>(names: impl Iterator<Item = &'a String>) -> Vec<&'a String> {
    let mut names: Vec<&String> = names.collect();
    names.sort();
    let mut twice: Vec<&String> = names
        .windows(2)
        .filter(|w| w[0] == w[1])
        .map(|w| w[0])
        .collect();
    twice.dedup();
    twice
}
