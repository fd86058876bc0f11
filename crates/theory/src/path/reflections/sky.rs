//! Samples rays of an environment by the environment's radiance and by the window.
//!
//! A direction is sampled first, then a position. If the first surface scatters light, the position
//! is on this surface; otherwise the position is at the light. Some directions are sampled by the
//! radiance of the environment, so no bright lobe of the environment is missed. The other
//! directions are sampled by the guide, so no narrow lobe of a BRDF is missed.

use super::aim::DirectionCoordinates;
use super::guide::{Conditional, Gaussian, GuideMixture, HeavyTailedGaussian};
use crate::path::local;
use crate::path::rays::AT_LIGHT;
use crate::path::{ScatteringSurface, towards};
use crate::sky::SkyDensity;
use etendue_field::{Environment, Frame};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// The share of directions that follow the guide, if there is one.
const GUIDED: f64 = 0.5;

/// Samples rays of an environment.
#[derive(Debug)]
pub(super) struct SkyRays<'a> {
    environment: &'a Environment,
    radiance: SkyDensity<'a>,
    /// Directions that reach the window, if the guide determines any.
    guide: Option<HeavyTailedGaussian>,
    /// Two Gaussians of the positions from which light reaches the window: the first for a given
    /// direction, the second for all directions.
    positions: (Conditional, Option<Gaussian<2>>),
    coordinates: Coordinates,
    aim: DirectionCoordinates,
}

/// The two coordinates of a direction.
#[derive(Debug)]
enum Coordinates {
    /// Longitude and latitude, at a scattering surface, of the direction from which light comes.
    Angles(Frame),
    /// Slopes at the light.
    Slopes,
}

/// A ray (x, y, u, v) at the light, its density in these coordinates, and the point of the first
/// surface at which the ray is aimed.
pub(super) type SkyRay = ([f64; 4], f64, Option<DVec3>);

impl<'a> SkyRays<'a> {
    /// Returns `None` if the environment is dark. `guide` describes the light at the first
    /// scatterer if `aim` is a position on this scatterer; otherwise `guide` describes the rays at
    /// the light. If the first scatterer is diffuse, `has_lobe` is false, and the guide does not
    /// restrict directions.
    pub(super) fn new(
        environment: &'a Environment,
        guide: &Gaussian<4>,
        (first, has_lobe): (&ScatteringSurface, bool),
        aim: DirectionCoordinates,
    ) -> Option<Self> {
        let on_surface = matches!(aim, DirectionCoordinates::Patch { .. });
        let (coordinates, normal) = if on_surface {
            (Coordinates::Angles(first.frame), first.frame.d)
        } else {
            (Coordinates::Slopes, DVec3::NEG_Z)
        };
        Some(Self {
            environment,
            radiance: SkyDensity::new(environment, normal)?,
            guide: has_lobe
                .then(|| HeavyTailedGaussian::new(&guide.marginal([2, 3])))
                .flatten(),
            positions: (
                guide.given([2, 3])?,
                (on_surface && has_lobe).then(|| guide.marginal([0, 1])),
            ),
            coordinates,
            aim,
        })
    }

    /// The ray for a point of the unit cube; `None` if the ray does not go forward.
    pub(super) fn draw(&self, [a, b, c, d]: [f64; 4]) -> Option<SkyRay> {
        let of_sky = |at| {
            -self
                .environment
                .frame
                .vector_to_world(self.radiance.draw(at))
        };
        let direction = match &self.guide {
            Some(guide) if c < GUIDED => self.coordinates.direction(guide.draw([c / GUIDED, d]))?,
            Some(_) => of_sky([(c - GUIDED) / (1.0 - GUIDED), d]),
            None => of_sky([c, d]),
        };
        let forward = direction.z;
        if forward <= 0.0 {
            return None;
        }
        let (at, steradians) = self.coordinates.of(direction);
        let from = self.environment.origin_of(direction);
        let radiance = self.environment.map.radiance(from);
        let by_radiance = self.radiance.density(from, radiance);
        let per_steradian = self.guide.map_or(by_radiance, |guide| {
            (1.0 - GUIDED) * by_radiance + GUIDED * guide.density(at) / steradians
        });
        let (given, all) = &self.positions;
        let share = if all.is_some() { 0.5 } else { 1.0 };
        let counted = |positions: Gaussian<2>| self.aim.counted(&positions);
        let positions = GuideMixture::new([
            (share, Some(counted(given.at(at)))),
            (1.0 - share, all.map(counted)),
        ])?;
        let position = positions.draw([a, b]);
        let per_area = positions.density(position);
        let target = self.aim.target(position);
        let [u, v] = [direction.x / forward, direction.y / forward];
        let ([x, y], per_area) = match (target, &self.aim) {
            (Some(target), DirectionCoordinates::Patch { patch, .. }) if target.z > -AT_LIGHT => {
                // The factor is dx dy at the light, divided by the area of the coordinates on the
                // patch.
                let normal = patch.normal(target);
                let spread = (normal.dot(direction) / normal.dot(patch.frame.d)).abs() / forward;
                let start = target - target.z * DVec3::new(u, v, 1.0);
                ([start.x, start.y], per_area / spread)
            }
            (Some(_), _) => return None,
            (None, _) => (position, per_area),
        };
        // dω = cos³ du dv.
        let density = per_area * per_steradian * forward.powi(3);
        Some(([x, y, u, v], density, target))
    }
}

impl Coordinates {
    /// The direction of light with the given coordinates; `None` if the light comes from
    /// behind the surface.
    fn direction(&self, at: [f64; 2]) -> Option<DVec3> {
        match self {
            Self::Angles(frame) => {
                let is_in_front = at.iter().all(|angle| angle.abs() < FRAC_PI_2);
                is_in_front.then(|| -towards(frame, frame.d, at))
            }
            Self::Slopes => Some(DVec3::new(at[0], at[1], 1.0).normalize()),
        }
    }

    /// The coordinates of a direction of light, and the solid angle in steradians per unit
    /// of the coordinates. The light may come from behind, because a diffuse surface also scatters
    /// light from behind.
    fn of(&self, direction: DVec3) -> ([f64; 2], f64) {
        match self {
            Self::Angles(frame) => {
                let [.., theta, phi] = local(frame, frame.origin, frame.d, -direction);
                // dω = cos φ dθ dφ.
                ([theta, phi], libm::cos(phi))
            }
            Self::Slopes => {
                let z = direction.z;
                ([direction.x / z, direction.y / z], z.powi(3))
            }
        }
    }
}
