//! The request of a fit: a scene file, its free fields, and a measurement.

use crate::fit::data::FitData;
use crate::fit::model::{FitModel, size};
use crate::fit::result::{Fitted, fit};
use crate::fit::search::FitStarts;
use crate::index::with_scene;
use crate::sweep::values::{number, real_value};
use crate::sweep::{given_twice, scene_at};
use etendue_pipeline::load::{self, SceneSource};
use etendue_pipeline::{Reporter, Work};
use etendue_scene::{RunFile, Scene};
use etendue_store::Failure;
use serde_json::{Value, json};

/// A scene with free fields.
#[derive(Clone, Debug)]
pub struct FitRequest {
    /// The scene, whose values are the first start.
    pub scene: SceneSource,
    /// Paths of the free fields.
    pub free: Vec<String>,
    /// Ranges of further starts, which replace ± 50 % of the value.
    pub ranges: Vec<(String, [f64; 2])>,
    /// Number of starts.
    pub starts: usize,
    /// Names of the planes that are compared; empty for all measured planes.
    pub planes: Vec<String>,
}

/// The half-width of the range of starts, as a share of the value.
const RANGE: f64 = 0.5;
/// The largest number of free fields.
const MAX_FIELDS: usize = 12;

impl FitRequest {
    /// Reads the scene with its free fields, and checks that they are numbers.
    pub fn read(&self) -> Result<(Scene, FitStarts), Failure> {
        let scene = load::scene(&self.scene, |_| ())?;
        if let Some(twice) = given_twice(self.free.iter().map(String::as_str)) {
            let free = self.scene.arguments.with("free", twice);
            return Err(Failure::bad_input(format!("{free} is given twice")));
        }
        if !(1..=MAX_FIELDS).contains(&self.free.len()) {
            return Err(Failure::bad_input(format!(
                "{} free fields; allowed: 1 to {MAX_FIELDS}",
                self.free.len()
            )));
        }
        let arguments = self.scene.arguments;
        let value = |path: &String| real_value(&scene, path, arguments.with("free", path));
        let values = self.free.iter().map(value);
        let values: Vec<f64> = values.collect::<Result<_, _>>()?;
        let known = |path: &String| self.free.contains(path);
        if let Some((path, _)) = self.ranges.iter().find(|(path, _)| !known(path)) {
            let range = arguments.with_one("range", path);
            return Err(Failure::bad_input(format!("{range} is not a free field")));
        }
        let ranges = self.free.iter().zip(&values).map(|(path, value)| {
            let given = self.ranges.iter().find(|(of, _)| of == path);
            let half = RANGE * size(*value);
            given.map_or([value - half, value + half], |(_, range)| *range)
        });
        let ranges = ranges.collect();
        let count = self.starts;
        Ok((
            scene,
            FitStarts {
                values,
                ranges,
                count,
            },
        ))
    }

    /// The scene in which the free fields have the given values. Its predictions are as accurate as
    /// a number of photons needs.
    pub(super) fn scene_at(&self, values: &[f64], photons: u64) -> Result<Scene, Failure> {
        let point = self
            .free
            .iter()
            .cloned()
            .zip(values.iter().copied())
            .collect();
        let set = |run: &mut RunFile| run.photons = photons;
        scene_at(&self.scene, &point, set)
    }

    /// Fits the scene to measured planes.
    pub fn run(
        &self,
        scene: &Scene,
        starts: &FitStarts,
        data: &FitData,
        reporter: &dyn Reporter,
    ) -> Result<Fitted, Failure> {
        let photons = data.photons.unwrap_or(scene.run.photons);
        let model = FitModel {
            scene_at: &|values| self.scene_at(values, photons),
            fields: &self.free,
            planes: &data.planes,
        };
        let bar = reporter.begin(Work::Steps {
            verb: "fitting",
            total: starts.descents(),
            things: "descents",
        });
        let test = (scene.run.alpha, scene.run.seed);
        fit(&model, data, starts, test, &|| bar.advance(1))
    }
}

/// The content of `fit.json`, without its list of files.
#[must_use]
pub fn index(scene: &Scene, fitted: &Fitted) -> Value {
    with_scene(json!(fitted), scene)
}

/// Parses a range of the form FIELD=A..B.
pub fn range(text: &str) -> Result<(String, [f64; 2]), String> {
    let parsed = || {
        let (path, range) = text.split_once('=')?;
        let (from, to) = range.split_once("..")?;
        let ends = [number(from).ok()?, number(to).ok()?];
        (ends[0] < ends[1]).then(|| (etendue_scene::dotted(path.trim()), ends))
    };
    parsed().ok_or_else(|| "must be FIELD=A..B, with numbers A below B".to_owned())
}
