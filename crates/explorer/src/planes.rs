//! Spectra and light fields at the planes along the path: each a call of `etendue_theory`.

use crate::parts::{grid, lobe, shapes, square, window};
use crate::plane::PathPlace;
use crate::rays;
use crate::setup::{Setting, Setup};
use etendue_field::{Mask, Projection, ProjectionGrid, Slices};
use etendue_theory::{
    Chain, Operator, Source, blurred_projection, blurred_slices, projection, slices,
};

impl PathPlace {
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
                let albedo = setup.get(Setting::Albedo);
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
                found.values *= setup.get(Setting::Albedo);
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
        let (blockers, receiver) = (setup.get(Setting::Distance), setup.get(Setting::Travel));
        let mut operators = Vec::new();
        if self != Self::Light {
            operators.push(travel("light", "blockers", blockers));
        }
        if !matches!(self, Self::Light | Self::Travelled) {
            if setup.get(Setting::Fill) > 0.0 {
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
            let albedo = setup.get(Setting::Albedo);
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

/// The light that arrives at the receiver, its slopes moved by some times curvature times position.
fn imaged(setup: &Setup, times: f64) -> Chain {
    let chain = PathPlace::Arrived.chain(setup);
    let power = times * setup.get(Setting::Curvature);
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
