//! The radiance of a ray at a plane in the first-order chain.

use super::incoming::IncomingLight;
use super::{back, brdf};
use crate::geometry::{AffineMap, Matrix};
use crate::light::LightPart;
use crate::obstacle::LegRay;
use crate::path::{PathChain, PathSystem, PreparedPath, ScatteringSurface};
use etendue_field::{Brdf, Frame, Lobe, Reflectance};
use glam::DVec3;
use std::f64::consts::TAU;

/// The first-order chain, prepared for the evaluation of radiance.
#[derive(Clone, Debug)]
pub(super) struct Linear<'a> {
    reflectance: &'a Reflectance,
    scatterer: &'a ScatteringSurface,
    /// The map from the light to local coordinates of the direction of incidence.
    onto: AffineMap<4>,
    /// The map from the plane to local coordinates of the outgoing direction.
    back: AffineMap<4>,
    /// The matrix that converts positions on the surface to positions in a plane. This plane is
    /// perpendicular to the light's axis and as far from the light as the surface.
    across: [[f64; 2]; 2],
    /// The matrix that converts angles at a point of the surface. It converts angles relative to
    /// the light's axis to angles on the surface.
    angles: Matrix<2>,
    /// The frame (T, B, N), given in the frame of the patch. It is used to look up BRDFs.
    frame: Frame,
}

impl<'a> Linear<'a> {
    pub(super) fn new(system: &'a PathSystem, chain: &'a PathChain) -> Option<Self> {
        let scatterer = &chain.scatterers[0];
        let distance = scatterer.frame.origin.z;
        let m = &chain.maps[0].matrix;
        let [[a, b], [c, d]] = [[m[0][0], m[0][1]], [m[1][0], m[1][1]]];
        let det = a * d - b * c;
        let across = [[d / det, -b / det], [-c / det, a / det]];
        // At a fixed position on the surface, a change of the slope u changes the position at the
        // light by −u times the distance.
        let slope = |row: usize, column: usize| m[row][2 + column] - distance * m[row][column];
        Some(Self {
            reflectance: system.scatterer().1,
            scatterer,
            onto: chain.maps[0],
            back: back(chain)?,
            across,
            angles: [[slope(2, 0), slope(2, 1)], [slope(3, 0), slope(3, 1)]],
            frame: system.scatterer().0.frame.decompose(&scatterer.frame),
        })
    }

    /// The point that represents a position (s, t) on the surface. The point is in the
    /// plane perpendicular to the light's axis.
    fn point(&self, [s, t, ..]: [f64; 4]) -> DVec3 {
        let [offset_s, offset_t, ..] = self.onto.offset;
        let (s, t) = (s - offset_s, t - offset_t);
        let [[a, b], [c, d]] = self.across;
        DVec3::new(a * s + b * t, c * s + d * t, self.scatterer.frame.origin.z)
    }

    /// The radiance that a part of the light causes along the ray with coordinates z at the
    /// plane, per unit of the part's measure: ℓ cos⁺ θ cos² φ ρ(θo − θr, φo − φr), where r is the
    /// mirror direction about the normal (docs/theory.md (41)).
    pub(super) fn radiance(&self, path: &PreparedPath<'_>, z: [f64; 4], part: LightPart) -> f64 {
        let local = self.back.apply(z);
        let point = self.point(local);
        let mut at_mask = path.at_mask();
        let passes = |ray: &LegRay, length| path.passes_beside(0, ray, length, &mut at_mask);
        let IncomingLight { slopes, weight } = path.incoming(point, part, passes);
        if weight <= 0.0 {
            return 0.0;
        }
        let [u, v] = slopes;
        // Slopes are converted exactly to angles by dω = cos φ dθ dφ = du dv cos³ and tan φ = v
        // cos θ.
        let across = (1.0 + u * u).sqrt();
        let (longitude, latitude) = (libm::atan(u), libm::atan(v / across));
        let per_angle = 1.0 / ((1.0 + u * u + v * v) * across);
        // The local angles of a ray that is parallel to the light's axis and hits the surface at
        // this position.
        let [_, _, theta, phi] = self.onto.apply([point.x, point.y, 0.0, 0.0]);
        let [[a, b], [c, d]] = self.angles;
        let (theta, phi) = (
            theta + a * longitude + b * latitude,
            phi + c * longitude + d * latitude,
        );
        let cosine = libm::cos(theta).max(0.0) * libm::cos(phi).powi(2);
        let irradiance = weight * per_angle * (a * d - b * c).abs() * cosine;
        let [s, t, to_theta, to_phi] = local;
        let at = self.frame.to_world(DVec3::new(s, t, 0.0));
        let mixture = self.reflectance.at(at.x, at.y);
        let incidence = self.scatterer.incidence;
        let sum = mixture.weighted().map(|(weight, brdf)| {
            weight * kernel(brdf, incidence, [theta, phi], [to_theta, to_phi])
        });
        irradiance * sum.sum::<f64>()
    }
}

/// The BRDF that the chain uses. Each of the last two arguments is a longitude and a
/// latitude: first of the direction from which light arrives, then of the direction towards which
/// it leaves. The lobe is the BRDF's lobe for the central ray, which arrives at the angle
/// `incidence`; it is a function of the angles from the mirror direction. The factors f and h
/// depend on the actual angles of incidence and departure.
pub(crate) fn kernel(
    brdf: &Brdf,
    incidence: f64,
    [from_theta, from_phi]: [f64; 2],
    [to_theta, to_phi]: [f64; 2],
) -> f64 {
    let cos_from = away(from_theta, from_phi).z;
    let factors = brdf::factors(brdf, cos_from, away(to_theta, to_phi).z);
    let [theta, phi] = [to_theta + from_theta, to_phi + from_phi];
    let lobe = match brdf.lobe {
        // A Phong lobe depends only on the cosine of the angle from the mirror direction, and its
        // Fresnel factor on the actual angle of incidence.
        Lobe::Phong { exponent } => {
            let cos = (libm::cos(theta) * libm::cos(phi)).max(0.0);
            let reflected = brdf.albedo * brdf::reflectance(brdf.fresnel, libm::cos(from_theta));
            reflected * (exponent + 1.0) / TAU * libm::pow(cos, exponent)
        }
        lobe if lobe.is_about_mirror() => {
            let to = away(theta - incidence, phi);
            brdf::lobe(brdf, DVec3::Z, away(incidence, 0.0), to)
        }
        _ => {
            let from = away(from_theta, from_phi);
            brdf::lobe(brdf, DVec3::Z, from, away(to_theta, to_phi))
        }
    };
    factors * lobe
}

/// The unit direction with a longitude and a latitude relative to the normal.
fn away(theta: f64, phi: f64) -> DVec3 {
    let ((sin, cos), (up, across)) = (libm::sincos(theta), libm::sincos(phi));
    DVec3::new(across * sin, up, across * cos)
}
