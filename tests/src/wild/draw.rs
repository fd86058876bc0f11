//! Random choices of a scene: values, their extremes, and the frame.

use crate::hostile::dice::Dice;
use etendue_field::Frame;
use glam::DVec3;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// The random choices for one scene, in the order in which they are used.
pub(super) struct SceneDraw {
    dice: Dice,
    /// On average, one of this many drawn values is extreme. If the number is 0, no value is
    /// extreme.
    rarity: usize,
    /// The scale of all lengths in the scene, metres.
    pub(super) unit: f64,
    /// The frame at the light; all other objects are drawn in the coordinates of this frame.
    pub(super) frame: Frame,
    /// The folder for pictures and meshes of the scene.
    pub(super) folder: PathBuf,
    /// The number of picture and mesh files written so far.
    pub(super) inputs: usize,
}

/// Units of length, some of which make all lengths of a scene tiny or huge. Results of a scene
/// must not depend on the unit of length.
const UNITS: [f64; 4] = [1e-3, 1e-2, 1e2, 1e4];
/// The range of lengths permitted in a scene file, metres.
const LENGTHS: [f64; 2] = [1e-9, 1e9];

/// The number of the first picture of added features. Pictures of the scene have smaller numbers.
const ADDED: usize = 1000;

impl SceneDraw {
    pub(super) fn new(seed: u64, index: u64, folder: &Path) -> Self {
        let mut draw = Self {
            dice: Dice::new(seed, index),
            rarity: 0,
            unit: 1.0,
            frame: Frame::IDENTITY,
            folder: folder.to_owned(),
            inputs: 0,
        };
        // Scenes with many extreme values are mostly dark, so some scenes have no extreme values.
        draw.rarity = *draw.pick(&[0, 20, 5, 5]);
        if draw.is_extreme() {
            draw.unit = *draw.pick(&UNITS);
        }
        if draw.one_in(3) {
            draw.frame = draw.some_frame();
        }
        draw
    }

    /// Returns other random choices for the scene with this index for this seed: for features that
    /// are added to it. `own` is different for each feature.
    pub(super) fn apart(own: u64, (seed, index): (u64, u64), folder: &Path) -> Self {
        let of_scene = Self::new(seed, index, folder);
        Self {
            unit: of_scene.unit,
            frame: of_scene.frame,
            inputs: ADDED,
            ..Self::new(seed ^ own, index, folder)
        }
    }

    fn some_frame(&mut self) -> Frame {
        let [d, x] = [(); 2].map(|()| self.direction());
        let origin = 3.0 * self.unit * self.direction();
        Frame::new(origin, d, x).unwrap_or(Frame::IDENTITY)
    }

    /// A random direction, uniformly distributed over the sphere.
    pub(super) fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = self.between(0.0, TAU).sin_cos();
        let r = (1.0 - z * z).sqrt();
        rounded_vector(DVec3::new(r * cos, r * sin, z))
    }

    /// Whether no value of the scene is extreme.
    pub(super) fn is_usual(&self) -> bool {
        self.rarity == 0
    }

    pub(super) fn is_extreme(&mut self) -> bool {
        self.rarity > 0 && self.dice.one_in(self.rarity)
    }

    /// One of the given extreme values, or a usual value.
    pub(super) fn extreme_or<T: Copy>(
        &mut self,
        extremes: &[T],
        usual: impl FnOnce(&mut Self) -> T,
    ) -> T {
        if self.is_extreme() {
            *self.pick(extremes)
        } else {
            usual(self)
        }
    }

    pub(super) fn one_in(&mut self, n: usize) -> bool {
        self.dice.one_in(n)
    }

    pub(super) fn below(&mut self, n: usize) -> usize {
        self.dice.below(n)
    }

    pub(super) fn pick<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        self.dice.pick(all)
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.dice.between(low, high)
    }

    /// A random integer from `low` to `high`, both included.
    pub(super) fn whole(&mut self, low: u32, high: u32) -> u32 {
        let more = self.below((high - low + 1) as usize);
        low + u32::try_from(more).unwrap_or(0)
    }

    /// A positive number, with a uniformly distributed logarithm, from the range `usual`
    /// or, as an extreme value, from the legal range.
    pub(super) fn value(&mut self, usual: [f64; 2], legal: [f64; 2]) -> f64 {
        let [low, high] = if self.is_extreme() { legal } else { usual };
        rounded(self.between(low.ln(), high.ln()).exp()).clamp(low, high)
    }

    /// A length that is drawn as [`Self::value`] draws numbers, and multiplied by the
    /// unit of the scene.
    pub(super) fn length(&mut self, usual: [f64; 2], legal: [f64; 2]) -> f64 {
        let [low, high] = LENGTHS;
        (self.unit * self.value(usual, legal)).clamp(low, high)
    }

    /// The given number with a random sign.
    pub(super) fn signed(&mut self, x: f64) -> f64 {
        if self.one_in(2) { -x } else { x }
    }

    /// Converts a point from coordinates in the frame at the light to world coordinates.
    pub(super) fn place(&self, local: DVec3) -> [f64; 3] {
        self.frame.to_world(local).to_array()
    }

    /// Converts a direction from components in the frame at the light to world coordinates.
    pub(super) fn along(&self, local: DVec3) -> [f64; 3] {
        self.frame.vector_to_world(local).to_array()
    }
}

/// Rounds a number to four digits, so that scene files stay readable.
pub(super) fn rounded(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}

fn rounded_vector(v: DVec3) -> DVec3 {
    DVec3::from(v.to_array().map(rounded))
}
