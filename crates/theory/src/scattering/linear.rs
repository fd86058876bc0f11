//! The radiance of a ray at a plane by the first-order chain.

use super::System;
use super::brdf;
use super::chain::Chain;
use super::incoming::{Incoming, Rule};
use crate::geometry::Map;
use crate::rays::Plane;
use etendue_field::{Brdf, Fresnel, Lobe};
use glam::DVec3;

/// The chain, ready to be evaluated.
#[derive(Clone, Debug)]
pub(super) struct Linear<'a> {
    system: &'a System,
    chain: &'a Chain,
    /// From the plane to local coordinates of where light goes.
    off: Map<4>,
    /// Positions on the surface to those at its distance across the light's axis, as a matrix.
    across: [[f64; 2]; 2],
    /// dθ dφ over du dv at a point of the surface.
    angles: f64,
    /// From the frame (T, B, N) to that of the patch: where the BRDF is looked up.
    frame: etendue_field::Frame,
}

impl<'a> Linear<'a> {
    pub(super) fn new(system: &'a System, chain: &'a Chain, _plane: &Plane) -> Option<Self> {
        let m = &chain.onto.matrix;
        let [[a, b], [c, d]] = [[m[0][0], m[0][1]], [m[1][0], m[1][1]]];
        let det = a * d - b * c;
        let across = [[d / det, -b / det], [-c / det, a / det]];
        // u at a point whose place across the axis stays: the light's place moves back by the distance.
        let slope =
            |row: usize, column: usize| m[row][2 + column] - chain.distance * m[row][column];
        let angles = slope(2, 0) * slope(3, 1) - slope(2, 1) * slope(3, 0);
        Some(Self {
            system,
            chain,
            off: chain.off.inverse()?,
            across,
            angles: angles.abs(),
            frame: system.patch.frame.decompose(&chain.frame),
        })
    }

    /// Local coordinates of the ray at z of the plane.
    pub(super) fn local(&self, z: [f64; 4]) -> [f64; 4] {
        self.off.apply(z)
    }

    /// The point across the light's axis that stands for a place (s, t).
    fn point(&self, [s, t, ..]: [f64; 4]) -> DVec3 {
        let [offset_s, offset_t, ..] = self.chain.onto.offset;
        let (s, t) = (s - offset_s, t - offset_t);
        let [[a, b], [c, d]] = self.across;
        DVec3::new(a * s + b * t, c * s + d * t, self.chain.distance)
    }

    /// All that shines on a place.
    pub(super) fn shines(&self, local: [f64; 4], rule: &Rule) -> Vec<Incoming> {
        self.system.incoming(self.point(local), rule)
    }

    /// The radiance that leaves, of what shines there: Σ ℓ cos⁺ θ cos² φ ρ(θo − θr, φo − φr), r being turned about the normal.
    pub(super) fn radiance(&self, local: [f64; 4], shines: &[Incoming]) -> f64 {
        let [s, t, theta, phi] = local;
        let at = self.frame.to_world(DVec3::new(s, t, 0.0));
        let brdf = self.system.reflectance.at(at.x, at.y);
        let point = self.point(local);
        let each = shines.iter().map(|incoming| {
            let [u, v] = incoming.slopes;
            let [x, y] = [
                point.x - self.chain.distance * u,
                point.y - self.chain.distance * v,
            ];
            let [_, _, from_theta, from_phi] = self.chain.onto.apply([x, y, u, v]);
            let cosine = from_theta.cos() * from_phi.cos().powi(2);
            if cosine <= 0.0 {
                return 0.0;
            }
            let kernel = self.kernel(&brdf, from_theta, [theta + from_theta, phi + from_phi]);
            incoming.weight * self.angles * cosine * kernel
        });
        each.sum()
    }

    /// The BRDF as it meets the central ray, at angles from the mirror direction; a factor of the angle of incidence stays one.
    fn kernel(&self, brdf: &Brdf, from: f64, [theta, phi]: [f64; 2]) -> f64 {
        let center = self.chain.incidence;
        let away = |theta: f64, phi: f64| {
            let ((sin, cos), (up, across)) = (theta.sin_cos(), phi.sin_cos());
            DVec3::new(across * sin, up, across * cos)
        };
        let factor = match brdf.lobe {
            Lobe::Lambertian | Lobe::Phong { .. } => brdf::reflectance(brdf.fresnel, from.cos()),
            Lobe::Beckmann { .. } | Lobe::Ggx { .. } => {
                return brdf::value(brdf, DVec3::Z, away(center, 0.0), away(theta - center, phi));
            }
        };
        let white = Brdf {
            fresnel: Fresnel::White,
            ..*brdf
        };
        let lobe = match brdf.lobe {
            // Its cosine is that of the angle from the mirror direction, wherever that is.
            Lobe::Phong { .. } => brdf::value(&white, DVec3::Z, DVec3::Z, away(theta, phi)),
            _ => brdf.albedo / std::f64::consts::PI,
        };
        factor * lobe
    }
}
