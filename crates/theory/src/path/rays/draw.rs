//! Sampling of the light's rays. Rays are sampled either by the light's emission or by target
//! points at the plane.
//!
//! To first order, the linearisation about the central ray maps a ray of the light to its landing
//! point. A target position or slope in the window therefore determines which ray of the light to
//! follow. The ray is then followed to its actual landing point. The sampling density of rays is
//! known exactly, wherever the rays land. If the window is narrower than the error of the
//! linearisation, only few rays that are sampled by targets land in the window. For a narrow window
//! all four coordinates of rays are therefore sampled in the window, and the rays are followed back
//! through the exact geometry.

use super::AT_LIGHT;
use super::backward::Back;
use super::emission::EmissionMeasure;
use crate::geometry::{AffineMap, Matrix};
use crate::light::{LightPart, LightParts};
use crate::nets::{DIMENSIONS, LinearDensity, Target};
use crate::path::PathSystem;
use crate::plane::Plane;
use etendue_field::Window;
use glam::DVec3;

/// The strategy for sampling rays. No strategy is best for every scene, so all strategies are
/// tried on each scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RayStrategy {
    /// Rays are sampled by the picture of the light.
    Picture,
    /// Rays are sampled by positions at the plane. The rays of an area light are also sampled by
    /// points of the light, and the rays of an environment by directions.
    Positions,
    /// Rays are sampled by slopes at the plane. As for [`Self::Positions`], the rays of an area
    /// light are also sampled by points of the light, and the rays of an environment by directions.
    Slopes,
    /// Rays of a light with extent are sampled by positions and slopes at the plane.
    Plane,
}

impl RayStrategy {
    pub(super) const ALL: [Self; 4] = [Self::Positions, Self::Slopes, Self::Picture, Self::Plane];
}

/// Samples rays (x, y, u, v) of the light.
#[derive(Clone, Debug)]
pub(super) struct RaySampler<'a> {
    emission: EmissionMeasure,
    /// Parts of the light, which give the two outer coordinates of a ray.
    parts: LightParts<'a>,
    by: By<'a>,
}

#[derive(Clone, Debug)]
enum By<'a> {
    Picture([LinearDensity; 2]),
    /// Positions at a plane that light reaches directly from the source.
    Straight {
        positions: Box<[LinearDensity; 2]>,
        plane: Plane,
    },
    /// Two target coordinates at the plane.
    Aim {
        targets: [Target; 2],
        /// The two target coordinates of the point where the central ray lands.
        center: [f64; 2],
        /// Derivatives of the target coordinates with respect to the outer coordinates. The outer
        /// coordinates are sampled at the light.
        outer: Matrix<2>,
        inverse: Matrix<2>,
        determinant: f64,
    },
    /// All four coordinates of the target ray at the plane are sampled, and the target is followed
    /// back exactly.
    Back {
        window: Box<[LinearDensity; 4]>,
        back: Back<'a>,
    },
    /// All four coordinates of the target ray at the plane are sampled, and the target is mapped
    /// back to first order.
    Map {
        targets: Box<[Target; 4]>,
        map: AffineMap<4>,
        determinant: f64,
    },
}

impl<'a> RaySampler<'a> {
    /// The sampler of a strategy, or `None` if `jacobian` does not determine the ray for a
    /// target. `center` is the point where the central ray lands, and `jacobian` is the derivative
    /// of the landing point with respect to the ray. If no plane is given, all rays are assumed to
    /// land at their targets.
    #[expect(
        clippy::too_many_lines,
        reason = "the coordinates by which each kind of light is aimed, side by side"
    )]
    pub(super) fn new(
        (system, plane): (&'a PathSystem, Option<&Plane>),
        window: &Window,
        (center, jacobian): &([f64; 4], Matrix<4>),
        strategy: RayStrategy,
    ) -> Option<Self> {
        let emission = system.emission();
        let met = plane.filter(|plane| plane.is_arriving() && system.visited == 0);
        let normal = met.map_or(DVec3::NEG_Z, |plane| plane.frame.d);
        let parts = LightParts::new(&system.light, normal)?;
        let profiles = [window.x, window.y, window.u, window.v];
        let aim = |row: usize| {
            let block = |columns: [usize; 2]| -> Matrix<2> {
                crate::geometry::from_fn(|i, j| jacobian[row + i][columns[j]])
            };
            let aimed = AffineMap::linear(block(emission.inner));
            if !tells_apart(&aimed) {
                return None;
            }
            Some(By::Aim {
                targets: [0, 1].map(|i| Target::new(&profiles[row + i])),
                center: [center[row], center[row + 1]],
                outer: block(emission.outer()),
                inverse: aimed.inverse()?.matrix,
                determinant: aimed.det().abs(),
            })
        };
        let by = match strategy {
            RayStrategy::Picture => By::Picture(system.picture_densities()?),
            RayStrategy::Positions => match (&parts, plane) {
                (LightParts::Sky(..), Some(plane)) if system.visited == 0 => By::Straight {
                    positions: Box::new(
                        [window.x, window.y].map(|profile| LinearDensity::of(&profile)),
                    ),
                    plane: *plane,
                },
                _ => aim(0)?,
            },
            RayStrategy::Slopes => aim(2)?,
            RayStrategy::Plane => {
                // Rays from one point have two coordinates, which cannot fill the plane's four.
                if matches!(parts, LightParts::Whole) {
                    return None;
                }
                if let Some(plane) = plane {
                    let back = Back::new(system, plane);
                    let window = Box::new(profiles.map(|profile| LinearDensity::of(&profile)));
                    let by = By::Back { window, back };
                    return Some(Self {
                        emission,
                        parts,
                        by,
                    });
                }
                let rays = AffineMap {
                    matrix: *jacobian,
                    offset: *center,
                };
                if !tells_apart(&rays) {
                    return None;
                }
                By::Map {
                    targets: Box::new(profiles.map(|profile| Target::new(&profile))),
                    map: rays.inverse()?,
                    determinant: rays.det().abs(),
                }
            }
        };
        Some(Self {
            emission,
            parts,
            by,
        })
    }

    /// A ray and its sampling density in the emission's coordinates, or `None` if the
    /// light does not emit the ray.
    pub(super) fn draw(&self, at: &[f64; DIMENSIONS]) -> Option<([f64; 4], f64)> {
        let [a, b, c, d, ..] = *at;
        let placed = |outer: [f64; 2], inner: [f64; 2]| {
            let mut ray = [0.0; 4];
            for i in 0..2 {
                ray[self.emission.outer()[i]] = outer[i];
                ray[self.emission.inner[i]] = inner[i];
            }
            ray
        };
        match &self.by {
            By::Picture([first, second]) => {
                let [s, t] = [first.quantile(a), second.quantile(b)];
                Some((placed([0.0; 2], [s, t]), first.value(s) * second.value(t)))
            }
            By::Straight { positions, plane } => {
                let (slopes, of_light) = self.outer([c, d])?;
                let [[x, of_x], [y, of_y]] = [positions[0].draw(a), positions[1].draw(b)];
                let (point, normal) = plane.point([x, y])?;
                let along = DVec3::new(slopes[0], slopes[1], 1.0);
                let start = point - point.z * along;
                // `spread` is dx dy at the light divided by dx dy at the plane; both are
                // projections of the same surface area.
                let spread = (normal.dot(along) / normal.dot(plane.frame.d)).abs();
                let density = of_x * of_y * of_light / spread;
                // A ray that meets the surface from behind has met the front of the surface at
                // another point before.
                let is_hidden = plane.is_arriving() && normal.dot(along) >= 0.0;
                let arrives = point.z > -AT_LIGHT && !is_hidden;
                arrives.then(|| (placed(slopes, [start.x, start.y]), density))
            }
            By::Aim {
                targets: [first, second],
                center,
                outer,
                inverse,
                determinant,
            } => {
                let (drawn, of_light) = self.outer([c, d])?;
                let [s, t] = [first.quantile(a), second.quantile(b)];
                let from = crate::geometry::times(outer, &drawn);
                let left = [s - center[0] - from[0], t - center[1] - from[1]];
                let ray = placed(drawn, crate::geometry::times(inverse, &left));
                let density = first.value(s) * second.value(t) * determinant * of_light;
                Some((ray, density))
            }
            By::Back { window, back } => {
                let drawn: [[f64; 2]; 4] = std::array::from_fn(|i| window[i].draw(at[i]));
                let (ray, spread) = back.ray(drawn.map(|[z, _]| z))?;
                let density: f64 = drawn.iter().map(|[_, density]| density).product();
                self.emits(&ray).then_some((ray, density * spread))
            }
            By::Map {
                targets,
                map,
                determinant,
            } => {
                let shares = [a, b, c, d];
                let z: [f64; 4] = std::array::from_fn(|i| targets[i].quantile(shares[i]));
                let ray = map.apply(z);
                let density: f64 = (0..4).map(|i| targets[i].value(z[i])).product();
                self.emits(&ray).then_some((ray, density * determinant))
            }
        }
    }

    /// Checks whether a ray starts at a point that belongs to the light.
    fn emits(&self, [x, y, ..]: &[f64; 4]) -> bool {
        match &self.parts {
            LightParts::Points(shape) => shape.contains(*x, *y),
            LightParts::Whole | LightParts::Sky(..) => true,
        }
    }

    /// The two outer coordinates of a ray and their density, or `None` if the ray does not
    /// leave the light's plane towards positive z.
    fn outer(&self, at: [f64; 2]) -> Option<([f64; 2], f64)> {
        let (part, density) = self.parts.draw(at)?;
        Some(match part {
            LightPart::Whole => ([0.0; 2], density),
            LightPart::Point(position) => (position, density),
            // dω = cos³ du dv.
            LightPart::Sky { slopes, cosine, .. } => (slopes, density * cosine.powi(3)),
        })
    }
}

/// Checks whether a map is well conditioned. At a focus the map is ill-conditioned, because it
/// takes some direction in ray space nearly to zero.
fn tells_apart<const N: usize>(map: &AffineMap<N>) -> bool {
    let size = |row: &[f64; N]| row.iter().map(|x| x * x).sum::<f64>().sqrt();
    let most: f64 = map.matrix.iter().map(size).product();
    map.det().abs() > 1e-8 * most
}
