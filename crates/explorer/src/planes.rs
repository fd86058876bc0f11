//! Spectra and light fields at the planes along the path, computed by `etendue_theory`.

use crate::gloss::{blurred_projection, blurred_slices};
use crate::parts::{grid, lobe, shapes, square, window};
use crate::plane::PathPlace;
use crate::rays;
use crate::setup::{SettingKey, Setup};
use etendue_field::{Mask, Projection, ProjectionGrid, Slices};
use etendue_theory::{Chain, Operator, Source, projection, slices};

impl PathPlace {
    /// The spectrum slice at azimuth 0.
    #[must_use]
    pub fn spectrum(self, setup: &Setup) -> Slices {
        let (window, grid) = (window(setup), grid(setup));
        match self {
            Self::Curved => on_the_surface(&slices(&imaged(setup, 1.0), &window, &grid)),
            Self::Blurred | Self::Glossy => {
                let chain = imaged(setup, if self == Self::Glossy { 2.0 } else { 1.0 });
                let mut found = blurred_slices(&chain, &lobe(setup), &window, &grid);
                // The reflected ray goes straight back, so (x, u) becomes (−x, −u), and light is
                // multiplied by the albedo.
                let albedo = setup.get(SettingKey::Albedo);
                found.half.mapv_inplace(|value| value.conj() * albedo);
                found
            }
            _ => slices(&self.chain(setup), &window, &grid),
        }
    }

    /// The light field in (x, u) with this many cells along each axis, its values in rows
    /// of constant x.
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
                found.values *= setup.get(SettingKey::Albedo);
                found
            }
            _ => projection(&self.chain(setup), &window, &cells),
        }
    }

    /// Predicts spectrum and light field on a glossy receiver by nets of rays, as `etendue
    /// predict` does. Returns `None` for other planes, whose predictions are not first-order
    /// approximations.
    #[must_use]
    pub fn followed(self, setup: &Setup) -> Option<(Slices, Projection)> {
        let found = rays::followed(self, setup)?;
        Some((found.slices, found.projection))
    }

    /// The chain of operators before this plane, between parallel planes.
    fn chain(self, setup: &Setup) -> Chain {
        let (blockers, receiver) = (
            setup.get(SettingKey::Distance),
            setup.get(SettingKey::Travel),
        );
        let mut operators = Vec::new();
        if self != Self::Light {
            operators.push(travel("light", "blockers", blockers));
        }
        if !matches!(self, Self::Light | Self::Travelled) {
            if setup.get(SettingKey::Fill) > 0.0 {
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
            let albedo = setup.get(SettingKey::Albedo);
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

fn travel(from: &str, to: &str, distance: f64) -> Operator {
    Operator::Travel {
        from: from.to_owned(),
        to: to.to_owned(),
        distance,
    }
}

/// The chain of the light that arrives at the receiver; the last step of the chain adds
/// `times` · curvature · position to the slopes.
fn imaged(setup: &Setup, times: f64) -> Chain {
    let chain = PathPlace::Arrived.chain(setup);
    let power = times * setup.get(SettingKey::Curvature);
    chain
        .imaged(power)
        .expect("an even light and opaque blockers")
}

/// Slices in the frame of the surface, in which only positions are reversed: S(ρ, ν) is the
/// previous S(−ρ, ν).
fn on_the_surface(before: &Slices) -> Slices {
    let mut after = before.clone();
    let last = before.grid.nu.count() - 1;
    for ((k, m, n), value) in after.half.indexed_iter_mut() {
        *value = before.half[[k, m, last - n]].conj();
    }
    after
}
