//! Resolves a scene file to a checked scene.

mod blockers;
mod dark_rectangles;
mod faults;
mod fields;
mod hole;
mod jitter;
mod light;
mod limits;
mod meshes;
mod names;
mod normals;
mod obstacles;
mod other_lights;
mod overlap;
mod patches;
mod path;
mod pictures;
mod planes;
mod rays;
mod reflectance;
mod surfaces;
mod triangles;

use crate::read::read_below;
use crate::scene::{CentralRay, Object, RunSettings, Scene};
use etendue_field::{Frame, tidy};
use etendue_scenefile::SceneError;
use etendue_scenefile::limits::{INPUT_BYTES, MAX_NUMBER};
use etendue_scenefile::number;
use etendue_scenefile::{Color, RunFile, SceneFile};
use faults::{Faults, show, vector};
use glam::DVec3;
use obstacles::Things;
use std::collections::BTreeMap;
use std::path::Path;

/// Checks a scene file and resolves it to a scene. The paths of meshes and pictures are relative to
/// `folder`. `memory` is the memory of this machine, in bytes.
///
/// # Errors
/// [`SceneError::Values`] with every fault found. If the scene has more objects than
/// [`crate::limits`] allow, only these faults are reported.
pub fn resolve(
    name: &str,
    file: SceneFile,
    folder: &Path,
    memory: u64,
) -> Result<Scene, SceneError> {
    let mut faults = Faults::default();
    let scene = Resolver {
        faults: &mut faults,
        folder,
        color: file.run.color,
        memory,
        inputs: BTreeMap::new(),
        pictures: 0,
    }
    .scene(name, file);
    match scene {
        Some(scene) if faults.all.is_empty() => Ok(scene),
        _ => Err(SceneError::Values(faults.once())),
    }
}

/// The lowest allowed significance level of a test: ten times the smallest possible p-value.
const LEAST_LEVEL: f64 = 5e-4;
/// Two planes across the path count as the same if the relative difference between their distances
/// is below this limit.
const SAME_PLANE: f64 = 1e-9;

struct Resolver<'a> {
    faults: &'a mut Faults,
    folder: &'a Path,
    /// The number of each colour that is measured.
    color: Color,
    /// The memory of this machine, in bytes.
    memory: u64,
    /// The BLAKE3 hashes of the files that were read, by the names of these files in the scene.
    inputs: BTreeMap<String, String>,
    /// The memory to read all pictures, in bytes.
    pictures: usize,
}

impl Resolver<'_> {
    fn scene(&mut self, name: &str, file: SceneFile) -> Option<Scene> {
        if !self.counts(&file) {
            return None;
        }
        for fault in file.numbers_out_of_range() {
            self.faults.add(fault.field, fault.value, fault.allowed);
        }
        self.name_of_scene(name);
        let frame = self.frame(&file);
        self.run(&file.run, 1 + file.other_lights.len());
        self.level(file.run.alpha, file.planes.len());
        // If the frame is unknown or too far away, the checks continue with the identity frame,
        // which leaves all values unchanged.
        let is_allowed = |frame: &Frame| frame.origin.abs().cmple(DVec3::splat(MAX_NUMBER)).all();
        let checked = frame.filter(is_allowed).unwrap_or(Frame::IDENTITY);
        let light = self.light(&file.light, &checked);
        let surfaces = self.surfaces(&file, &checked);
        let meshes = self.meshes(&file, &checked);
        let patches = self.patches(&file, &checked);
        let mut blockers = self.blockers(&file, &checked);
        self.layers(&file.light, &blockers);
        let things = Things {
            blockers: &blockers,
            surfaces: &surfaces,
            meshes: &meshes,
            patches: &patches,
        };
        let path = self.path(&file, checked, &light, things);
        self.ends(&file, &blockers, path.first_hit());
        let stops = stops(&path, things);
        self.names(&file, &stops);
        self.distinct(&file, &stops);
        let planes = self.planes(&file, &path, &stops);
        self.memory(&planes, file.run.batches);

        blockers.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        frame?;
        let mut scene = Scene {
            name: name.to_owned(),
            path,
            light,
            other_lights: Vec::new(),
            blockers,
            surfaces,
            meshes,
            patches,
            planes,
            inputs: std::mem::take(&mut self.inputs),
            picture_bytes: self.pictures,
            run: RunSettings {
                photons: file.run.photons,
                seed: file.run.seed,
                batches: file.run.batches,
                alpha: file.run.alpha,
                resolution: file.run.resolution,
                emission: file.run.emission,
                sampling: file.run.sampling,
            },
            against: None,
            file,
        };
        scene.other_lights = self.other_lights(&scene);
        scene.inputs.append(&mut self.inputs);
        Some(scene)
    }

    /// The bytes of a file named in the scene.
    fn named_file(&mut self, of: &str, name: &str) -> Option<Vec<u8>> {
        match read_below(self.folder, name, INPUT_BYTES) {
            Ok(bytes) => {
                let hash = blake3::hash(&bytes).to_hex().to_string();
                self.inputs.insert(name.to_owned(), hash);
                Some(bytes)
            }
            Err(error) => {
                let allowed = "a regular file of at most 1 GiB in the folder of the scene file or below \
                    it, after links are followed, and without `..`";
                self.faults
                    .add(of, format!("{} ({error})", show(name)), allowed);
                None
            }
        }
    }

    fn frame(&mut self, file: &SceneFile) -> Option<Frame> {
        let path = &file.path;
        let (d, x) = (DVec3::from(path.direction), DVec3::from(path.x_axis));
        let frame = Frame::new(DVec3::from(file.light.center()), d, x);
        if frame.is_none() && d.is_finite() && x.is_finite() {
            let allowed = "two directions that are not parallel, neither of length 0";
            self.faults.add(
                "path.direction and path.x_axis",
                format!("{} and {}", vector(&path.direction), vector(&path.x_axis)),
                allowed,
            );
        }
        frame
    }

    /// Refuses two flat objects in one plane, because rounding would decide which object light
    /// meets first.
    fn distinct(&mut self, file: &SceneFile, stops: &[PathStop<'_>]) {
        let mut flat: Vec<&PathStop<'_>> = stops.iter().filter(|s| s.is_flat()).collect();
        flat.sort_by(|a, b| a.extent[0].total_cmp(&b.extent[0]));
        for pair in flat.windows(2) {
            let distance = pair[1].extent[0];
            if (distance - pair[0].extent[0]).abs() <= SAME_PLANE * distance.abs() {
                let [a, b] = [0, 1].map(|i| fields::fields(file, pair[i].name).next());
                let [a, b] = [a, b].map(Option::unwrap_or_default);
                self.faults.add_on_path(
                    format!("{a}.center and {b}.center"),
                    format!("both at distance {} m", tidy(distance)),
                    "planes at different distances",
                );
            }
        }
    }

    fn run(&mut self, run: &RunFile, lights: usize) {
        // Each batch needs at least one photon of each light, and one photon suffices to estimate
        // noise.
        let least = u64::from(run.batches) * lights as u64;
        if !(least..=1_000_000_000_000).contains(&run.photons) {
            let each = if lights > 1 {
                "batch and light"
            } else {
                "batch"
            };
            let allowed = format!("{least} (one for each {each}) to 10^12");
            self.faults.add("run.photons", show(run.photons), allowed);
        }
    }

    /// Checks that a p-value can fall below the level of each plane.
    fn level(&mut self, alpha: f64, planes: usize) {
        let level = 1.0 - libm::pow(1.0 - alpha, 1.0 / planes.max(1) as f64);
        if level < LEAST_LEVEL {
            let least = 1.0 - libm::pow(1.0 - LEAST_LEVEL, planes as f64);
            let allowed = format!(
                "at least {least:.4} with {planes} planes, because p is known only to 1/20000"
            );
            self.faults.add("run.alpha", number(alpha), allowed);
        }
    }
}

/// An object of the scene. A plane can be placed before or after this object.
struct PathStop<'a> {
    name: &'a str,
    /// The smallest and the largest distance of the object along the first leg; the two are equal
    /// for a flat object.
    extent: [f64; 2],
    /// Whether light can leave the object.
    surface: bool,
    /// The index of the leg that ends on the object, if the path visits the object.
    ends: Option<usize>,
}

impl PathStop<'_> {
    fn is_flat(&self) -> bool {
        self.extent[0].total_cmp(&self.extent[1]).is_eq()
    }
}

/// All objects of a scene, sorted by distance.
fn stops<'a>(path: &CentralRay, things: Things<'a>) -> Vec<PathStop<'a>> {
    let ends = |object: Object| {
        let mut legs = 0..path.legs.len();
        legs.find(|leg| path.ends_at(*leg).is_some_and(|hit| hit.object == object))
    };
    let blockers = things.blockers.iter().map(|b| PathStop {
        name: &b.name,
        extent: [b.distance; 2],
        surface: false,
        ends: None,
    });
    let surfaces = things.surfaces.iter().enumerate().map(|(i, s)| PathStop {
        name: &s.name,
        extent: extent(&s.corners()),
        surface: true,
        ends: ends(Object::Surface(i)),
    });
    let meshes = things.meshes.iter().enumerate().map(|(i, m)| PathStop {
        name: &m.name,
        extent: m.extent,
        surface: !m.is_black(),
        ends: ends(Object::Mesh(i)),
    });
    let patches = things.patches.iter().enumerate().map(|(i, p)| PathStop {
        name: &p.name,
        extent: extent(&p.patch.corners()),
        surface: true,
        ends: ends(Object::Patch(i)),
    });
    let stops = blockers.chain(surfaces).chain(meshes).chain(patches);
    let mut stops: Vec<PathStop<'a>> = stops.collect();
    stops.sort_by(|a, b| a.extent[0].total_cmp(&b.extent[0]));
    stops
}

/// The smallest and the largest z coordinate of the given points.
fn extent(points: &[DVec3]) -> [f64; 2] {
    let low = points.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max);
    [low, high]
}
