//! The light, blockers, lobe, window and frequencies of a setup.

use crate::setup::{SettingKey, Setup};
use etendue_field::{FrequencyAxis, Light, Profile, Rectangle, Shape, SliceGrid, Window, whole};
use etendue_theory::shading::PlanarLobe;
use etendue_transform::random::{self, Stream};

/// Length of a slat along Y, metres: larger than any window.
pub(crate) const SLAT: f64 = 8.0;
/// Number of cells of a picture along each axis, as in the command.
pub const CELLS: usize = 64;

/// Maximum number of frequencies to each side of zero: more are too slow for interaction.
const MAX_FREQUENCIES: usize = 160;

/// The light.
pub(crate) fn square(setup: &Setup) -> Light {
    let square = Rectangle {
        center: [0.0; 2],
        size: [setup.get(SettingKey::Width); 2],
    };
    Light::Area {
        shape: Shape::Rectangle(square),
        radiance: 1.0,
        exponent: 0.0,
    }
}

/// The receiver's lobe.
#[must_use]
pub fn lobe(setup: &Setup) -> PlanarLobe {
    PlanarLobe::Phong {
        exponent: setup.get(SettingKey::Exponent),
    }
}

/// The position of a blocker along an axis, in pitches from the centre.
pub(crate) fn place(i: u32, count: u32) -> f64 {
    f64::from(i) - 0.5 * (f64::from(count) - 1.0)
}

/// The number of blockers along an axis.
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "1 to 41"
)]
pub(crate) fn count(setup: &Setup) -> u32 {
    setup.get(SettingKey::Count).round() as u32
}

/// The seed of the jitter.
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "0 to 2³²"
)]
pub(crate) fn seed(setup: &Setup) -> u64 {
    setup.get(SettingKey::Seed).round() as u64
}

/// The blockers, with positions relative to the central ray.
pub(crate) fn shapes(setup: &Setup) -> Vec<Shape> {
    let count = count(setup);
    let [pitch, fill, jitter] =
        [SettingKey::Pitch, SettingKey::Fill, SettingKey::Jitter].map(|key| setup.get(key));
    let middle = -setup.get(SettingKey::Position);
    if !setup.is(SettingKey::Squares) {
        let slat = |i| Rectangle {
            center: [middle + place(i, count) * pitch, 0.0],
            size: [fill * pitch, SLAT],
        };
        return (0..count).map(|i| Shape::Rectangle(slat(i))).collect();
    }
    let at = |i: u32, word: u32| pitch * (place(i, count) + jitter * (random::unit(word) - 0.5));
    let pairs = (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
    pairs
        .map(|(i, j)| {
            let index = u64::from(i) * u64::from(count) + u64::from(j);
            let words = random::words(seed(setup), Stream::Jitter, index, 0);
            Shape::Rectangle(Rectangle {
                center: [middle + at(i, words[0]), at(j, words[1])],
                size: [fill * pitch; 2],
            })
        })
        .collect()
}

/// The window of all planes.
#[must_use]
pub(crate) fn window(setup: &Setup) -> Window {
    let [x, u] =
        [SettingKey::WindowX, SettingKey::WindowU].map(|key| Profile::Hann(setup.get(key)));
    Window { x, y: x, u, v: u }
}

/// The frequencies of all planes.
#[must_use]
pub fn grid(setup: &Setup) -> SliceGrid {
    let axis = |most: SettingKey, step: SettingKey, half_width: SettingKey| {
        // The spacing is never wider than the window requires.
        let spacing = setup.get(step).min(0.5 / setup.get(half_width));
        let half = whole((setup.get(most) / spacing - 1e-9).ceil()).min(MAX_FREQUENCIES);
        FrequencyAxis { half, spacing }
    };
    SliceGrid {
        azimuths: 1,
        rho: axis(SettingKey::RhoMax, SettingKey::RhoStep, SettingKey::WindowX),
        nu: axis(SettingKey::NuMax, SettingKey::NuStep, SettingKey::WindowU),
    }
}
