//! Draws directions in proportion to the radiance of an environment.

use crate::line::{direction, ray_through};
use crate::sampling::LAMBERTIAN;
use etendue_field::{Environment, EnvironmentMap, SphericalGaussian, TwoPlane};
use etendue_sampling::{DiscreteDistribution, LatLongSampler, about, cosine_hemisphere, polar};
use etendue_transform::random::{self, Stream};
use glam::DVec3;

/// An environment, with a strategy to draw the directions in which its light travels.
#[derive(Clone, Debug)]
pub(crate) struct Sky {
    environment: Environment,
    choice: Choice,
    /// The share of slopes that are drawn in proportion to the cosine instead of the environment's
    /// radiance. If most light of the environment goes backwards, a strategy that follows the
    /// radiance alone would draw forward directions too rarely.
    by_cosine: f64,
}

/// The distribution from which directions are drawn.
#[derive(Clone, Debug)]
enum Choice {
    /// Lobes, each selected with a probability in proportion to its flux.
    Lobes(Vec<SphericalGaussian>, DiscreteDistribution),
    Map(LatLongSampler),
}

/// The number of directions that are drawn to estimate the share of directions that go forward.
const TRIED: u64 = 1000;
/// The largest allowed share of slopes that are drawn by the cosine. The limit ensures that some
/// directions are drawn by the environment.
const MOST_BY_COSINE: f64 = 0.9;
const LEAST_BY_COSINE: f64 = 0.1;

impl Sky {
    pub(crate) fn new(environment: &Environment) -> Self {
        let choice = match &environment.map {
            EnvironmentMap::Lobes(lobes) => {
                let flux = lobes.iter().map(SphericalGaussian::integral);
                Choice::Lobes(lobes.clone(), DiscreteDistribution::new(flux))
            }
            EnvironmentMap::LatLong(map) => Choice::Map(LatLongSampler::new(map)),
        };
        let mut sky = Self {
            environment: environment.clone(),
            choice,
            by_cosine: 0.0,
        };
        let tried = (0..TRIED).map(|i| random::words(0, Stream::Even, i, 0).map(random::unit));
        let forward = tried.filter(|r| sky.sample(*r).z > FORWARD).count();
        let share = forward as f64 / TRIED as f64;
        sky.by_cosine = (1.0 - 2.0 * share).clamp(LEAST_BY_COSINE, MOST_BY_COSINE);
        sky
    }

    /// A unit direction in which light travels, in the frame at the light, drawn with
    /// four random numbers in (0, 1).
    pub(crate) fn sample(&self, r: [f64; 4]) -> DVec3 {
        let from = match &self.choice {
            Choice::Lobes(lobes, flux) => {
                let lobe = &lobes[flux.sample(r[0])];
                let squared = lobe.width * lobe.width;
                // This value is 1 − cos γ, where γ is the angle to the axis of the lobe.
                let fall = -squared * libm::log1p(r[1] * libm::expm1(-2.0 / squared));
                about(lobe.from, polar(fall.clamp(0.0, 2.0), r[2]))
            }
            Choice::Map(map) => map.sample(r),
        };
        -self.environment.frame.vector_to_world(from)
    }

    /// The density of [`Self::sample`] per steradian.
    pub(crate) fn density(&self, along: DVec3) -> f64 {
        let from = self.environment.origin_of(along);
        match &self.choice {
            Choice::Lobes(_, flux) => self.environment.map.radiance(from) / flux.total(),
            Choice::Map(map) => map.density(from),
        }
    }

    /// The slopes of a drawn direction; `None` if the direction does not go forward.
    pub(crate) fn slopes(&self, r: [f64; 4]) -> Option<[f64; 2]> {
        let along = if r[0] < self.by_cosine {
            cosine_hemisphere([r[2], r[1]])
        } else {
            let first = (r[0] - self.by_cosine) / (1.0 - self.by_cosine);
            self.sample([first, r[1], r[2], r[3]])
        };
        (along.z > FORWARD).then(|| [along.x / along.z, along.y / along.z])
    }

    /// The density of [`Self::slopes`] with respect to du dv.
    #[inline]
    pub(crate) fn slope_density(&self, ray: &TwoPlane) -> f64 {
        let secant_squared = ray.secant_squared();
        let by_cosine = 1.0 / (LAMBERTIAN * secant_squared.sqrt());
        let by_light = self.density(direction(ray));
        let density = self.by_cosine * by_cosine + (1.0 - self.by_cosine) * by_light;
        density / (secant_squared * secant_squared.sqrt())
    }

    /// The radiance along a ray, in the frame at the light.
    #[inline]
    pub(crate) fn radiance(&self, ray: &TwoPlane) -> f64 {
        radiance(&self.environment, ray)
    }

    /// Estimates the irradiance at a point with a given normal from one direction. The direction is
    /// drawn by the cosine or by the environment, with equal probability. `incident` returns the
    /// radiance that arrives along a ray at a given distance on the first leg.
    pub(crate) fn irradiance(
        &self,
        point: DVec3,
        normal: DVec3,
        r: [f64; 4],
        incident: impl FnOnce(&TwoPlane, f64) -> f64,
    ) -> f64 {
        let towards = if r[3] < 0.5 {
            about(normal, cosine_hemisphere([r[0], r[1]]))
        } else {
            -self.sample([r[0], r[1], r[2], 2.0 * r[3] - 1.0])
        };
        let cosine = towards.dot(normal);
        let Some(ray) = ray_through(point, -towards).filter(|_| cosine > 0.0) else {
            return 0.0;
        };
        // The estimate uses the balance heuristic of one sample (Veach and Guibas 1995).
        let density = 0.5 * (cosine / LAMBERTIAN + self.density(-towards));
        cosine * incident(&ray, point.z) / density
    }
}

/// The radiance of an environment along a ray, in the frame at the light.
#[inline]
pub(crate) fn radiance(environment: &Environment, ray: &TwoPlane) -> f64 {
    if ray.secant_squared() * FORWARD * FORWARD < 1.0 {
        environment.radiance(direction(ray))
    } else {
        0.0
    }
}

/// Light goes forward if the cosine of the angle between its direction and the central ray exceeds
/// this limit.
const FORWARD: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::{Frame, LatLong};
    use etendue_sampling::chi_square::SphereCells;
    use std::sync::Arc;

    fn environments() -> Vec<Environment> {
        let lobe = |from: DVec3, width, radiance| SphericalGaussian {
            from: from.normalize(),
            radiance,
            width,
        };
        let lobes = vec![
            lobe(DVec3::new(0.3, 0.5, -1.0), 0.3, 2.0),
            lobe(DVec3::NEG_Y, 0.8, 0.5),
            lobe(DVec3::X, 1000.0, 0.1),
        ];
        // The map has bright pixels at its left edge, where longitude wraps around, and at the
        // poles.
        let map = LatLong::from_fn(12, 7, |d| {
            let edge = d.z < -0.8 && d.x > 0.0;
            if edge { 4.0 } else { 0.2 * d.y * d.y }
        });
        let frame = Frame::new(
            DVec3::ZERO,
            DVec3::new(0.3, -0.4, 0.8),
            DVec3::new(1.0, 0.2, 0.0),
        );
        [
            EnvironmentMap::Lobes(lobes),
            EnvironmentMap::LatLong(Arc::new(map)),
        ]
        .map(|map| Environment {
            frame: frame.unwrap(),
            map,
        })
        .to_vec()
    }

    #[test]
    fn directions_follow_the_density() {
        for environment in environments() {
            let sky = Sky::new(&environment);
            let numbers =
                (0..100_000).map(|i| random::words(5, Stream::Photon, i, 0).map(random::unit));
            let directions: Vec<DVec3> = numbers.map(|r| sky.sample(r)).collect();
            let cells = SphereCells::new(DVec3::X, directions.iter().copied());
            let drawn = directions.into_iter().map(Some);
            let found = cells.compare(drawn, |along| sky.density(along));
            assert!(found.agrees(), "{found:?}");
        }
    }
}
