//! Intersects rays with geometries in local coordinates, and samples the areas of geometries.

use super::mesh::WorldMesh;
use super::ray::{Local, Ray, Spot};
use etendue_field::sincos_turns;
use etendue_sampling::{disc, sphere};
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// A geometry prepared for ray intersection.
#[derive(Debug)]
pub(crate) enum Form {
    Rectangle,
    Disc,
    Sphere,
    Cylinder,
    Mesh(Arc<WorldMesh>),
}

impl Form {
    /// The lowest and the highest corner of the bounding box of the geometry.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        match self {
            Self::Rectangle | Self::Disc => {
                [DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)]
            }
            Self::Sphere => [DVec3::NEG_ONE, DVec3::ONE],
            Self::Cylinder => [DVec3::new(-1.0, -1.0, 0.0), DVec3::ONE],
            Self::Mesh(mesh) => mesh.bounds,
        }
    }

    /// The first hit on a ray at distances strictly within bounds.
    #[inline]
    pub(super) fn first(&self, ray: &Ray, [from, until]: [f64; 2]) -> Option<Spot> {
        let Ray { from: start, along } = *ray;
        let within = |at: &f64| *at > from && *at < until;
        let distance = match self {
            Self::Rectangle | Self::Disc => {
                let at = -start.z / along.z;
                let place = (start + at * along).truncate();
                let is_on = match self {
                    Self::Disc => place.length_squared() <= 1.0,
                    _ => place.abs().max_element() <= 1.0,
                };
                (within(&at) && is_on).then_some(at)
            }
            Self::Sphere => {
                let both = roots(start, along, DVec3::ONE)?;
                both.into_iter().find(within)
            }
            Self::Cylinder => {
                let on = |at: &f64| (0.0..=1.0).contains(&(start.z + at * along.z));
                let both = roots(start, along, DVec3::new(1.0, 1.0, 0.0))?;
                both.into_iter().find(|at| within(at) && on(at))
            }
            Self::Mesh(mesh) => return mesh.first(ray, [from, until]),
        };
        let spot = Spot::default();
        distance.map(|distance| Spot { distance, ..spot })
    }

    /// Checks whether a ray hits the geometry at a distance strictly within bounds.
    #[inline]
    pub(super) fn is_occluded(&self, ray: &Ray, within: [f64; 2]) -> bool {
        match self {
            Self::Mesh(mesh) => mesh.is_occluded(ray, within),
            other => other.first(ray, within).is_some(),
        }
    }

    /// The point of the geometry at a hit; `place` is its position.
    #[inline]
    pub(super) fn local(&self, place: DVec3, spot: &Spot) -> Local {
        match self {
            Self::Rectangle | Self::Disc => self.flat(place.truncate()),
            Self::Sphere => ball(place),
            Self::Cylinder => tube(place),
            Self::Mesh(mesh) => mesh.local(spot.triangle as usize, spot.weights),
        }
    }

    #[inline]
    fn flat(&self, place: DVec2) -> Local {
        let (uv, along_u) = match self {
            Self::Disc => {
                let uv = DVec2::new(place.length(), turn(place));
                (uv, place.extend(0.0).try_normalize().unwrap_or(DVec3::X))
            }
            _ => (square_uv(place), DVec3::X),
        };
        Local {
            normal: DVec3::Z,
            shading: None,
            point: uv.into(),
            along_u,
        }
    }

    /// The areas, in the world, of the pieces of the geometry: its triangles, or the
    /// whole. Spheres and cylinders are scaled as described at [`etendue_world::Shape`].
    pub(crate) fn areas(&self, to_world: &DAffine3) -> Vec<f64> {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| to_world.transform_vector3(axis));
        let whole = match self {
            Self::Rectangle => 4.0 * x.cross(y).length(),
            Self::Disc => PI * x.cross(y).length(),
            Self::Sphere => 4.0 * PI * x.length_squared(),
            Self::Cylinder => TAU * x.length() * z.length(),
            Self::Mesh(mesh) => return mesh.areas(to_world).collect(),
        };
        vec![whole]
    }

    /// A point sampled uniformly by area on a piece.
    #[inline]
    pub(crate) fn sample(&self, piece: usize, [a, b]: [f64; 2]) -> (DVec3, Local) {
        match self {
            Self::Rectangle => {
                let place = 2.0 * DVec2::new(a, b) - 1.0;
                (place.extend(0.0), self.flat(place))
            }
            Self::Disc => {
                let place = disc(1.0, [a, b]);
                (place.extend(0.0), self.flat(place))
            }
            Self::Sphere => {
                let place = sphere([a, b]);
                (place, ball(place))
            }
            Self::Cylinder => {
                let (sin, cos) = sincos_turns(b);
                let place = DVec3::new(cos, sin, a);
                (place, tube(place))
            }
            Self::Mesh(mesh) => mesh.sample(piece, [a, b]),
        }
    }
}

/// The parameters of the two points of a ray at which the weighted squares of the
/// coordinates add up to 1.
fn roots(start: DVec3, along: DVec3, weights: DVec3) -> Option<[f64; 2]> {
    let a = (weights * along).dot(along);
    // Distances on the line are measured from the point that is nearest to the axis or the centre.
    // Therefore the distances are precise even for rays that start far away.
    let middle = -(weights * start).dot(along) / a;
    let nearest = start + middle * along;
    let left = 1.0 - (weights * nearest).dot(nearest);
    // For a ray along the axis of a cylinder, a is 0 and there is no hit.
    let half = (left / a).sqrt();
    (half.is_finite() && left >= 0.0).then_some([middle - half, middle + half])
}

/// The texture coordinates of a point of the square.
#[inline]
pub(super) fn square_uv(place: DVec2) -> DVec2 {
    0.5 * (place + 1.0)
}

/// The azimuth divided by 2π, from 0 to 1.
fn turn(place: DVec2) -> f64 {
    let turn = libm::atan2(place.y, place.x) / TAU;
    if turn < 0.0 { turn + 1.0 } else { turn }
}

fn ball(place: DVec3) -> Local {
    let uv = DVec2::new(
        turn(place.truncate()),
        libm::acos(place.z.clamp(-1.0, 1.0)) / PI,
    );
    round(place, uv)
}

fn tube(place: DVec3) -> Local {
    let uv = DVec2::new(turn(place.truncate()), place.z);
    round(place.with_z(0.0), uv)
}

fn round(normal: DVec3, uv: DVec2) -> Local {
    let along_u = DVec3::new(-normal.y, normal.x, 0.0);
    Local {
        normal,
        shading: None,
        point: uv.into(),
        along_u,
    }
}
