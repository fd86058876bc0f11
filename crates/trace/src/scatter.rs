use crate::emit::LAMBERTIAN;
use crate::obstacles::direction;
use crate::proposal::{Aim, Follower};
use crate::reach::{outline, reach};
use etendue_field::{Frame, Profile, TwoPlane, random};
use etendue_scene::{Emission, Scene};
use glam::DVec3;
use std::f64::consts::TAU;

/// How light leaves the surface at the beginning of a leg, diffusely: a density over slopes at each of its
/// points, and a way to sample it. Rays are in the frame of the leg.
#[derive(Clone, Debug)]
pub(crate) struct Scatterer {
    /// One aim for each plane on this leg or a later one, along X and along Y; `None` for plain scattering.
    aims: Vec<Option<[Aim; 2]>>,
}

/// Slopes towards a surface are bounded by its size alone.
const ANY_SLOPE: f64 = 1e6;

impl Scatterer {
    /// `None` when no plane looks at light that has come to this leg.
    pub(crate) fn new(scene: &Scene, leg: usize) -> Option<Self> {
        let this = &scene.path.legs[leg];
        let origins: Vec<DVec3> = outline(scene, this.leaves?.object)
            .iter()
            .map(|p| this.frame.to_local(*p))
            .collect();
        let is_ahead = origins.iter().all(|p| p.z < 0.99 * this.length);
        let planes = scene.planes.iter().filter(|p| p.leg >= leg);
        let aims: Vec<_> = planes
            .map(|plane| {
                let w = &plane.window;
                if scene.run.emission == Emission::Plain {
                    None
                } else if plane.leg == leg {
                    let d = scene.path.along(plane);
                    Some([
                        Aim::new(d, &w.x, Follower::new(&w.u)),
                        Aim::new(d, &w.y, Follower::new(&w.v)),
                    ])
                } else {
                    let half = reach(scene, plane, leg, &origins).filter(|_| is_ahead)?;
                    let slope = Follower::cosine(ANY_SLOPE);
                    Some(half.map(|half| Aim::new(this.length, &Profile::Box(half), slope)))
                }
            })
            .collect();
        (!aims.is_empty()).then_some(Self { aims })
    }

    /// A ray that leaves a point, where the surface has this normal, and its density with respect to du dv over n · (u, v, 1);
    /// `None` when the chosen plane cannot be reached from there, or the ray leaves behind the surface.
    #[inline]
    pub(crate) fn sample(
        &self,
        point: DVec3,
        normal: DVec3,
        words: [u32; 4],
    ) -> Option<(TwoPlane, f64)> {
        let r = words.map(random::unit);
        let from = point.z;
        let [u, v] = match &self.aims[random::index(words[2], self.aims.len())] {
            Some([along_x, along_y]) => [
                along_x.sample(point.x, from, r[0])?,
                along_y.sample(point.y, from, r[1])?,
            ],
            None => {
                let (sin, cos) = (TAU * r[1]).sin_cos();
                let slope = (r[0] / (1.0 - r[0])).sqrt();
                let local = DVec3::new(slope * cos, slope * sin, 1.0);
                let leaves = Frame::IDENTITY.turned_to(normal).vector_to_world(local);
                if leaves.z <= 0.0 {
                    return None;
                }
                [leaves.x / leaves.z, leaves.y / leaves.z]
            }
        };
        let ray = TwoPlane {
            x: point.x - from * u,
            y: point.y - from * v,
            u,
            v,
        };
        let cosine = normal.dot(direction(&ray));
        if cosine <= 0.0 {
            return None;
        }
        let secant_squared = ray.secant_squared();
        let plain = 1.0 / (LAMBERTIAN * secant_squared * secant_squared);
        let densities = self.aims.iter().map(|aim| match aim {
            Some([a, b]) => a.density(point.x, from, u) * b.density(point.y, from, v) / cosine,
            None => plain,
        });
        let density = densities.sum::<f64>() / self.aims.len() as f64;
        (density > 0.0).then_some((ray, density))
    }
}
