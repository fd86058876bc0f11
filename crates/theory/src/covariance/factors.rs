//! Covariances of the factors that multiply a light field, and of the lobes with which a light
//! field is convolved.
//!
//! The covariance of a factor f is the second moment of its power spectrum, ∫ f'²/(4π² ∫ f²), if
//! this moment exists. The power spectrum of a factor with edges has no second moment, so a
//! Gaussian with the variance of the factor replaces the factor.

use crate::geometry::{Matrix, diagonal};
use crate::shading::PlanarLobe;
use etendue_field::{Grating, Lobe, Mask, Profile, Shape, Window};
use std::f64::consts::PI;

/// The covariance of a Gaussian exp(−t²/2s), in cycles per unit, squared.
fn gaussian(variance: f64) -> f64 {
    1.0 / (8.0 * PI * PI * variance)
}

/// The covariance of the Gaussian with the variance r²/3 that replaces an opening of
/// half-width r.
fn opening(half_width: f64) -> f64 {
    gaussian(half_width * half_width / 3.0)
}

/// The covariance of one profile of a window, in cycles per unit, squared. The covariance
/// is 1/12h² for a Hann profile of half-width h, and 1/4πw² for a Gaussian exp(−πt²/w²) without
/// truncation. A box profile has edges, so a Gaussian of the same variance replaces the box.
#[must_use]
pub fn profile(profile: &Profile) -> f64 {
    match *profile {
        Profile::Hann(half) => 1.0 / (12.0 * half * half),
        Profile::Box(half) => opening(half),
        Profile::Gaussian { width, .. } => 1.0 / (4.0 * PI * width * width),
    }
}

/// The covariance of the window of a plane.
#[must_use]
pub fn window(window: &Window) -> Matrix<4> {
    let Window { x, y, u, v } = window;
    diagonal([x, y, u, v].map(profile))
}

/// The covariance of a cosine grating ½(1 + m cos(2πft + p)), in cycles per unit, squared.
/// The covariance is the variance f² m²/(2 + m²) of the grating's three spectral lines, weighted by
/// their power. If the replicas of the light's spectrum do not overlap, the covariance adds to the
/// covariance of the light.
#[must_use]
pub fn grating(grating: &Grating) -> f64 {
    let square = grating.modulation * grating.modulation;
    grating.frequency * grating.frequency * square / (2.0 + square)
}

/// The covariance of a mask, in the coordinates of its own plane. An opaque mask is
/// treated as an opening about the central ray. The opening is the largest disc about the central
/// ray that contains no shape; half-planes narrow the opening along their axis. (The course notes
/// of Belcour 2016 use the largest unoccluded disc.) The hole of an aperture is treated as a
/// Gaussian with the covariance of the hole's area. Returns `None` if the mask blocks the central
/// ray or has an edge on the central ray.
#[must_use]
pub fn mask(mask: &Mask) -> Option<Matrix<4>> {
    let mut factor = [[0.0; 4]; 4];
    match mask {
        Mask::Grating(lines) => factor[lines.axis][lines.axis] = grating(lines),
        Mask::Aperture(hole) => {
            if hole.clearance(0.0, 0.0) <= 0.0 {
                return None;
            }
            let [[a, b], [_, d]] = hole.moments().covariance;
            let scale = 8.0 * PI * PI * (a * d - b * b);
            (factor[0][0], factor[1][1]) = (d / scale, a / scale);
            (factor[0][1], factor[1][0]) = (-b / scale, -b / scale);
        }
        Mask::Opaque {
            shapes,
            half_planes,
        } => {
            let blocked = shapes.iter().any(|shape| shape.contains(0.0, 0.0))
                || half_planes.iter().any(|half| half.contains(0.0, 0.0));
            if blocked {
                return None;
            }
            let disc = shapes.iter().map(distance).fold(f64::INFINITY, f64::min);
            for (axis, row) in factor.iter_mut().enumerate().take(2) {
                let edges = half_planes.iter().filter(|half| half.axis == axis);
                let nearest = edges.map(|half| half.edge.abs()).fold(disc, f64::min);
                row[axis] = opening(nearest);
            }
        }
    }
    Some(factor)
}

/// The distance from the central ray to the nearest point of a shape; the ray must not
/// pass through the shape.
fn distance(shape: &Shape) -> f64 {
    match shape {
        Shape::Rectangle(rectangle) => {
            let gap = |axis: usize| rectangle.center[axis].abs() - 0.5 * rectangle.size[axis];
            libm::hypot(gap(0).max(0.0), gap(1).max(0.0))
        }
        Shape::Disc(disc) => libm::hypot(disc.center[0], disc.center[1]) - disc.radius,
    }
}

/// The covariance of the cosine factor cos⁺θ cos²φ on a surface: 1/4π² cycles² along the
/// longitude θ and 1/3π² cycles² along the latitude φ.
#[must_use]
pub fn cosine() -> Matrix<4> {
    let square = PI * PI;
    diagonal([0.0, 0.0, 0.25 / square, 1.0 / (3.0 * square)])
}

/// The covariance of the factor G = (1 + u² + v²)⁻² over slopes: 0.3/π² cycles² along each
/// of u and v.
#[must_use]
pub fn slope_cosine() -> Matrix<4> {
    let along = 0.3 / (PI * PI);
    diagonal([0.0, 0.0, along, along])
}

/// The covariance of a lobe over (θ, φ), in radians squared, for light that arrives at the
/// angle θ₀ to the normal. Returns `None` for Lambert's lobe, which is uniform over all
/// directions.
///
/// A microfacet that is tilted by τ turns light by 2τ in the plane of incidence, and by 2τ cos θ₀
/// perpendicular to this plane. Shadowing, the Fresnel factor and the factor 1/(4 cos θi cos θo)
/// are omitted.
#[must_use]
pub fn lobe(lobe: &Lobe, theta0: f64) -> Option<Matrix<4>> {
    let along = PlanarLobe::of(*lobe)?.variance();
    let across = match lobe {
        Lobe::Phong { .. } => along,
        _ => along * libm::cos(theta0).powi(2),
    };
    Some(diagonal([0.0, 0.0, along, across]))
}
