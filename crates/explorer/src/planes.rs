//! What is looked at along the path, and its numbers: each a call of `etendue_theory`.

use crate::rays;
use crate::setup::{Key, Setup};
use etendue_field::random::{self, Stream};
use etendue_field::{
    FrequencyAxis, Light, Mask, Profile, Projection, ProjectionGrid, Rectangle, Shape, SliceGrid,
    Slices, Window, whole,
};
use etendue_theory::shading::Lobe;
use etendue_theory::{
    Chain, Operator, Source, blurred_projection, blurred_slices, projection, slices,
};

/// Length of a slat along Y, metres: more than any window sees.
pub(crate) const SLAT: f64 = 8.0;
/// Cells of a picture along each axis, as the command has them.
pub const CELLS: usize = 64;

/// Most frequencies to each side of zero: more take too long to be dragged.
const MOST: usize = 160;

/// A place on the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// At the light.
    Light,
    /// Before the blockers.
    Travelled,
    /// After them.
    Blocked,
    /// At the receiver.
    Arrived,
    /// There, times the factor of the cosine.
    Irradiance,
    /// Light that leaves the diffuse receiver.
    Diffuse,
    /// On the glossy receiver, in the frames of its local normals.
    Curved,
    /// There, after the lobe.
    Blurred,
    /// Light that leaves the glossy receiver.
    Glossy,
}

impl Plane {
    /// Those of a scene, in the order of light.
    #[must_use]
    pub fn all(setup: &Setup) -> Vec<Self> {
        let mut all = vec![Self::Light, Self::Travelled, Self::Blocked, Self::Arrived];
        all.extend(if setup.is(Key::Glossy) {
            vec![Self::Curved, Self::Blurred, Self::Glossy]
        } else {
            vec![Self::Irradiance, Self::Diffuse]
        });
        all
    }

    /// Its name in the scene file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Travelled => "before_blockers",
            Self::Blocked => "after_blockers",
            Self::Arrived => "receiver",
            Self::Irradiance => "irradiance",
            Self::Diffuse | Self::Glossy => "leaving",
            Self::Curved => "curvature",
            Self::Blurred => "reflection",
        }
    }

    /// Whether it takes more time than a picture has, so that it is made in the background.
    #[must_use]
    pub fn is_slow(self) -> bool {
        matches!(self, Self::Irradiance | Self::Diffuse)
    }

    /// The slice at azimuth 0.
    #[must_use]
    pub fn spectrum(self, setup: &Setup) -> Slices {
        let (window, grid) = (window(setup), grid(setup));
        match self {
            Self::Curved => on_the_surface(&slices(&imaged(setup, 1.0), &window, &grid)),
            Self::Blurred | Self::Glossy => {
                let chain = imaged(setup, if self == Self::Glossy { 2.0 } else { 1.0 });
                let mut found = blurred_slices(&chain, &lobe(setup), &window, &grid);
                // Straight back (x, u) is (−x, −u), and the albedo stays behind.
                let albedo = setup.get(Key::Albedo);
                found.half.mapv_inplace(|value| value.conj() * albedo);
                found
            }
            _ => slices(&self.chain(setup), &window, &grid),
        }
    }

    /// The light field in (x, u) as so many cells along each axis, its values in rows of constant x.
    #[must_use]
    pub fn field(self, setup: &Setup, cells: usize) -> Projection {
        let window = window(setup);
        let cells = ProjectionGrid::new(&window, cells);
        match self {
            Self::Curved => {
                let mut found = projection(&imaged(setup, 1.0), &window, &cells);
                found.values.invert_axis(ndarray::Axis(0));
                found
            }
            Self::Blurred | Self::Glossy => {
                let chain = imaged(setup, if self == Self::Glossy { 2.0 } else { 1.0 });
                let mut found = blurred_projection(&chain, &lobe(setup), &window, &cells);
                found.values.invert_axis(ndarray::Axis(0));
                found.values.invert_axis(ndarray::Axis(1));
                found.values *= setup.get(Key::Albedo);
                found
            }
            _ => projection(&self.chain(setup), &window, &cells),
        }
    }

    /// Both as `etendue predict` has them on a glossy receiver, by nets of rays; `None` elsewhere,
    /// where nothing is first-order.
    #[must_use]
    pub fn followed(self, setup: &Setup) -> Option<(Slices, Projection)> {
        let found = rays::followed(self, setup)?;
        Some((found.slices, found.projection))
    }

    /// What light meets before it arrives here, between parallel planes.
    fn chain(self, setup: &Setup) -> Chain {
        let (blockers, receiver) = (setup.get(Key::Distance), setup.get(Key::Travel));
        let mut operators = Vec::new();
        if self != Self::Light {
            operators.push(travel("light", "blockers", blockers));
        }
        if !matches!(self, Self::Light | Self::Travelled) {
            if setup.get(Key::Fill) > 0.0 {
                operators.push(Operator::Visibility {
                    name: "blockers".to_owned(),
                    mask: Mask::Opaque {
                        shapes: shapes(setup),
                        half_planes: Vec::new(),
                    },
                });
            }
            if self != Self::Blocked {
                operators.push(travel("blockers", "receiver", receiver - blockers));
            }
        }
        let name = || "receiver".to_owned();
        if matches!(self, Self::Irradiance | Self::Diffuse) {
            operators.push(Operator::Cosine { name: name() });
        }
        if self == Self::Diffuse {
            let albedo = setup.get(Key::Albedo);
            operators.push(Operator::Diffuse {
                name: name(),
                albedo,
            });
        }
        Chain {
            source: Source {
                name: "light".to_owned(),
                light: square(setup),
            },
            operators,
        }
    }
}

/// The light.
pub(crate) fn square(setup: &Setup) -> Light {
    let square = Rectangle {
        center: [0.0; 2],
        size: [setup.get(Key::Width); 2],
    };
    Light::Area {
        shape: Shape::Rectangle(square),
        radiance: 1.0,
        exponent: 0.0,
    }
}

fn travel(from: &str, to: &str, distance: f64) -> Operator {
    Operator::Travel {
        from: from.to_owned(),
        to: to.to_owned(),
        distance,
    }
}

/// The light that arrives at the receiver, its slopes moved by some times curvature times position.
fn imaged(setup: &Setup, times: f64) -> Chain {
    let chain = Plane::Arrived.chain(setup);
    let power = times * setup.get(Key::Curvature);
    chain
        .imaged(power)
        .expect("an even light and opaque blockers")
}

/// On the surface positions are turned round and directions are not: S(ρ, ν) is S(−ρ, ν) before.
fn on_the_surface(before: &Slices) -> Slices {
    let mut after = before.clone();
    let last = before.grid.nu.count() - 1;
    for ((k, m, n), value) in after.half.indexed_iter_mut() {
        *value = before.half[[k, m, last - n]].conj();
    }
    after
}

/// The receiver's lobe.
#[must_use]
pub fn lobe(setup: &Setup) -> Lobe {
    Lobe::Phong {
        exponent: setup.get(Key::Exponent),
    }
}

/// Where blockers stand along an axis, in pitches from the middle.
pub(crate) fn place(i: u32, count: u32) -> f64 {
    f64::from(i) - 0.5 * (f64::from(count) - 1.0)
}

/// How many blockers there are along an axis.
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "1 to 41"
)]
pub(crate) fn count(setup: &Setup) -> u32 {
    setup.get(Key::Count).round() as u32
}

/// The seed of the jitter.
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "0 to 2³²"
)]
pub(crate) fn seed(setup: &Setup) -> u64 {
    setup.get(Key::Seed).round() as u64
}

/// The blockers, from the central ray.
pub(crate) fn shapes(setup: &Setup) -> Vec<Shape> {
    let count = count(setup);
    let [pitch, fill, jitter] = [Key::Pitch, Key::Fill, Key::Jitter].map(|key| setup.get(key));
    let middle = -setup.get(Key::Position);
    if !setup.is(Key::Squares) {
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
    let [x, u] = [Key::WindowX, Key::WindowU].map(|key| Profile::Hann(setup.get(key)));
    Window { x, y: x, u, v: u }
}

/// Their frequencies.
#[must_use]
pub fn grid(setup: &Setup) -> SliceGrid {
    let axis = |most: Key, step: Key, half_width: Key| {
        // Never wider than the window asks for.
        let spacing = setup.get(step).min(0.5 / setup.get(half_width));
        let half = whole((setup.get(most) / spacing - 1e-9).ceil()).min(MOST);
        FrequencyAxis { half, spacing }
    };
    SliceGrid {
        azimuths: 1,
        rho: axis(Key::RhoMax, Key::RhoStep, Key::WindowX),
        nu: axis(Key::NuMax, Key::NuStep, Key::WindowU),
    }
}
