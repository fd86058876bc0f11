//! Aims the light of environments at the regions that planes see.

use crate::footprint_sampler::FootprintSampler;
use crate::plane_on_leg::PlaneOnLeg;
use crate::proposal::{DrawOrder, ProfileDensity, Proposal};
use crate::sky::Sky;
use etendue_field::{Environment, Orientation, Profile, TwoPlane, VirtualPlane};
use etendue_scene::{Emission, Scene};
use etendue_transform::random;

/// A mixture of several strategies to draw rays of light from an environment. All strategies have
/// equal weights. The density of the mixture is over (x, y, u, v) at the beginning of the first
/// leg.
///
/// Emission, aimed or plain, covers only rays that reach the window of some virtual plane,
/// because the flux of an environment through all space is infinite.
#[derive(Debug)]
pub(crate) struct FromSky {
    sky: Sky,
    strategies: Vec<SkyStrategy>,
}

#[derive(Debug)]
enum SkyStrategy {
    /// Draws positions and slopes by the profiles of the window of one virtual plane.
    Window([Proposal; 2]),
    /// Draws positions uniformly in the window of a virtual plane, and directions in proportion
    /// to the environment's radiance.
    Across {
        distance: f64,
        position: [ProfileDensity; 2],
    },
    /// Draws positions and angles by the window profiles of a virtual plane that lies on the
    /// first surface.
    Facing(Box<Facing>),
    /// Draws points of the first surface, and directions in proportion to the environment's
    /// radiance.
    Onto(FootprintSampler),
}

/// A virtual plane that records the light arriving on a surface.
#[derive(Debug)]
struct Facing {
    plane_on_leg: PlaneOnLeg,
    position: [ProfileDensity; 2],
    angle: [ProfileDensity; 2],
}

impl Facing {
    fn new(scene: &Scene, index: usize, plane: &VirtualPlane, aimed: bool) -> Self {
        let w = &plane.window;
        let follow = |profile: &Profile| {
            if aimed {
                ProfileDensity::new(profile)
            } else {
                ProfileDensity::constant(profile.half_width())
            }
        };
        Self {
            plane_on_leg: PlaneOnLeg::new(scene, index, plane),
            position: [&w.x, &w.y].map(follow),
            angle: [&w.u, &w.v].map(follow),
        }
    }

    /// Draws coordinates in the window and returns their ray, in the plane at the beginning of the
    /// leg. Returns `None` if the drawn coordinates belong to no ray.
    fn sample(&self, r: [f64; 4]) -> Option<TwoPlane> {
        let seen = TwoPlane {
            x: self.position[0].quantile(r[0]),
            y: self.position[1].quantile(r[1]),
            u: self.angle[0].quantile(r[2]),
            v: self.angle[1].quantile(r[3]),
        };
        let (ray, _) = self.plane_on_leg.leg_ray(&seen)?;
        Some(ray)
    }

    /// The density of [`Self::sample`] with respect to dx dy du dv in the plane at the
    /// beginning of the leg.
    fn density(&self, ray: &TwoPlane) -> f64 {
        let seen = || {
            let (seen, per_ray) = self.plane_on_leg.at_plane(ray, 1.0)?;
            let (_, area) = self.plane_on_leg.leg_ray(&seen)?;
            let place = self.position[0].density(seen.x) * self.position[1].density(seen.y);
            let angle = self.angle[0].density(seen.u) * self.angle[1].density(seen.v);
            Some(place * angle * per_ray / area)
        };
        seen().unwrap_or(0.0)
    }
}

impl FromSky {
    /// Aimed emission has two strategies for the window of each virtual plane on the first leg: one
    /// draws rays by the window's profiles, and the other draws directions by the environment. For
    /// each virtual plane on a later leg, aimed emission has a strategy for the part of the first
    /// surface that this plane sees. If a virtual plane lies on the first surface, aimed emission
    /// also has a strategy that draws rays by the profiles of that plane's window. Plain emission
    /// draws positions uniformly over three regions: the windows of the virtual planes on the first
    /// leg, the first surface, and the windows of virtual planes on that surface. Plain emission
    /// always draws directions in proportion to the environment's radiance.
    pub(crate) fn new(scene: &Scene, environment: &Environment) -> Self {
        let aimed = scene.run.emission == Emission::Aimed;
        let mut strategies = Vec::new();
        for (index, plane) in scene.planes.iter().enumerate() {
            if looks_across(plane) {
                strategies.extend(across(plane, aimed));
                continue;
            }
            if plane.leg == 0 {
                let facing = Facing::new(scene, index, plane, aimed);
                strategies.push(SkyStrategy::Facing(Box::new(facing)));
            }
            if aimed {
                strategies.extend(FootprintSampler::new(scene, Some(plane)).map(SkyStrategy::Onto));
            }
        }
        if !aimed && scene.planes.iter().any(|plane| !looks_across(plane)) {
            strategies.extend(FootprintSampler::new(scene, None).map(SkyStrategy::Onto));
        }
        Self {
            sky: Sky::new(environment),
            strategies,
        }
    }

    /// Draws a ray with eight random words. Returns `None` if the direction of the ray does not go
    /// forward.
    pub(crate) fn sample(&self, words: [[u32; 4]; 2]) -> Option<TwoPlane> {
        let [r, s] = words.map(|words| words.map(random::unit));
        // A direction takes four of the random words in every strategy.
        match self
            .strategies
            .get(random::index(words[1][3], self.strategies.len().max(1)))?
        {
            SkyStrategy::Window([along_x, along_y]) => {
                let [[x], [u]] = along_x.samples([[r[0]], [r[1]]]);
                let [[y], [v]] = along_y.samples([[r[2]], [r[3]]]);
                Some(TwoPlane { x, y, u, v })
            }
            SkyStrategy::Across { distance, position } => {
                let [u, v] = self.sky.slopes(r)?;
                let [x, y] = [0, 1].map(|axis| position[axis].quantile(s[axis]));
                Some(TwoPlane { x, y, u, v }.travelled(-distance))
            }
            SkyStrategy::Facing(facing) => facing.sample(r),
            SkyStrategy::Onto(ground) => {
                let [u, v] = self.sky.slopes(r)?;
                let point = ground.sample([s[0], s[1], s[2]]);
                let [x, y] = [point.x - point.z * u, point.y - point.z * v];
                Some(TwoPlane { x, y, u, v })
            }
        }
    }

    /// The density of [`Self::sample`] with respect to dx dy du dv.
    pub(crate) fn density(&self, ray: &TwoPlane) -> f64 {
        let by_sky = self.sky.slope_density(ray);
        let densities = self.strategies.iter().map(|strategy| match strategy {
            SkyStrategy::Window([along_x, along_y]) => {
                let [x] = along_x.densities([&[ray.x], &[ray.u]]);
                let [y] = along_y.densities([&[ray.y], &[ray.v]]);
                x * y
            }
            SkyStrategy::Across { distance, position } => {
                let TwoPlane { x, y, .. } = ray.travelled(*distance);
                by_sky * position[0].density(x) * position[1].density(y)
            }
            SkyStrategy::Facing(facing) => facing.density(ray),
            // A direction without light has density zero, so no ray is drawn along it.
            SkyStrategy::Onto(_) if by_sky <= 0.0 => 0.0,
            SkyStrategy::Onto(ground) => by_sky * ground.density(ray),
        });
        densities.sum::<f64>() / self.strategies.len() as f64
    }
}

/// Checks whether a virtual plane lies across the first leg. Such a virtual plane may see light
/// that has met no surface.
pub(crate) fn looks_across(plane: &VirtualPlane) -> bool {
    plane.leg == 0 && plane.orientation == Orientation::Orthogonal
}

/// The strategies that draw rays through the window of a virtual plane across the first
/// leg.
fn across(plane: &VirtualPlane, aimed: bool) -> Vec<SkyStrategy> {
    let (w, distance) = (&plane.window, plane.distance);
    let space = [&w.x, &w.y];
    if !aimed {
        let position = space.map(|profile| ProfileDensity::constant(profile.half_width()));
        return vec![SkyStrategy::Across { distance, position }];
    }
    let endless = [f64::NEG_INFINITY, f64::INFINITY];
    let slope = [&w.u, &w.v];
    let along = |axis: usize| {
        let (space, slope) = (
            ProfileDensity::new(space[axis]),
            ProfileDensity::new(slope[axis]),
        );
        Proposal::new(DrawOrder::Slope, distance, endless, space, slope)
    };
    let window = along(0).zip(along(1));
    let position = space.map(ProfileDensity::new);
    window
        .map(|(x, y)| SkyStrategy::Window([x, y]))
        .into_iter()
        .chain([SkyStrategy::Across { distance, position }])
        .collect()
}
