//! A scene file that follows docs/scenes.md, with its central ray anywhere in the world, and the
//! resolved scene.

use super::vector::{Axes, Vector, aside, direction};
use crate::hostile::dice::Dice;
use etendue_field::Frame;
use etendue_scene::{Scene, SceneFile, resolve};
use std::path::Path;

/// The texts that together form a scene file. The light's center, the path's direction and its X
/// axis are random.
#[derive(Clone, Debug)]
pub(super) struct World {
    /// The frame at the light.
    pub(super) light: Axes,
    /// The X axis in the scene file, which need not be orthogonal to D.
    x_axis: Vector,
    pub(super) lamp: String,
    pub(super) blockers: String,
    pub(super) surfaces: String,
    /// Text of the further fields of the path; the text begins with a comma.
    pub(super) onwards: String,
    pub(super) planes: String,
}

impl World {
    /// Creates a scene with a point light and without occluders.
    pub(super) fn new(dice: &mut Dice) -> Self {
        let origin = direction(dice);
        let d = direction(dice);
        let tilt = dice.between(0.3, 2.8);
        let x_axis = aside(dice, d, tilt);
        Self {
            light: Axes::new(origin, d, x_axis),
            x_axis,
            lamp: format!("Point(center: {})", triple(origin)),
            blockers: String::new(),
            surfaces: String::new(),
            onwards: String::new(),
            planes: "(name: \"at\", at: Before(\"it\"))".to_owned(),
        }
    }

    /// Turns the central ray at the light to the direction `d`.
    pub(super) fn turn_to(&mut self, d: Vector) {
        self.light = Axes::new(self.light.origin, d, self.x_axis);
    }

    /// Adds a rectangle across the path.
    pub(super) fn with_wall(mut self, distance: f64) -> Self {
        let center = triple(self.light.point([0.0, 0.0, distance]));
        self.surfaces = format!("Rectangle(name: \"it\", center: {center}, size: (1, 1))");
        self
    }

    pub(super) fn scene(&self, folder: &Path) -> Scene {
        let text = format!(
            "(light: {}, blockers: [{}], surfaces: [{}], \
             path: (direction: {}, x_axis: {}, visits: [\"it\"]{}), planes: [{}], \
             window: (x: Hann(0.1), u: Hann(0.1)), \
             frequencies: (azimuths: 1, rho: (max: 5), nu: (max: 5)), \
             run: (photons: 1024, batches: 32))",
            self.lamp,
            self.blockers,
            self.surfaces,
            triple(self.light.d),
            triple(self.x_axis),
            self.onwards,
            self.planes,
        );
        let file = SceneFile::parse(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
        resolve("second", file, folder, u64::MAX).unwrap_or_else(|error| panic!("{error}: {text}"))
    }

    /// A point of the world in the coordinates of the resolved scene, which are coordinates
    /// in the frame at the light.
    pub(super) fn resolved(&self, point: Vector) -> Vector {
        self.light.coordinates(point)
    }
}

/// Formats numbers for a scene file.
pub(super) fn triple([a, b, c]: Vector) -> String {
    format!("({a:?}, {b:?}, {c:?})")
}

pub(super) fn pair([a, b]: [f64; 2]) -> String {
    format!("({a:?}, {b:?})")
}

/// The largest difference between two frames, over position and directions.
pub(super) fn frames_apart(fast: &Frame, axes: &Axes) -> f64 {
    let pairs = [
        (fast.origin, axes.origin),
        (fast.x, axes.x),
        (fast.y, axes.y),
        (fast.d, axes.d),
    ];
    let apart = pairs.map(|(a, b)| super::vector::distance(a.to_array(), b));
    apart.into_iter().fold(0.0, super::check::worse)
}
