//! Describes the surface points that a camera sees. It computes their light, and the distances of
//! the objects that they reflect. Renderers with adaptive sampling use these points.

use crate::numbers::{JOINT, PathNumbers};
use crate::paths::{LightSearch, Paths, TracedPath};
use crate::scatter::Reflects;
use crate::space::{Hit, Ray};
use etendue_sampling::sphere;
use etendue_transform::Net;
use etendue_transform::random::Stream;
use etendue_world::Look;
use glam::DVec3;

/// The hit of a camera ray.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Radiance that sources emit along the ray, W m⁻² sr⁻¹.
    pub emitted: f64,
    /// The point of a surface that the ray hits; `None` if the ray leaves the world.
    pub surface: Option<SurfaceHit>,
}

/// A visible surface point.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceHit {
    hit: Hit,
    /// The ray that sees the point.
    ray: Ray,
}

impl SurfaceHit {
    /// The index of the shape of the surface.
    #[must_use]
    pub fn shape(&self) -> usize {
        self.hit.shape
    }

    /// The position in the world.
    #[must_use]
    pub fn position(&self) -> DVec3 {
        self.hit.position
    }

    /// The distance along the ray.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.hit.distance
    }

    /// The shading normal, on the visible side.
    #[must_use]
    pub fn normal(&self) -> DVec3 {
        let normal = self.hit.frame.z_axis;
        if normal.dot(self.ray.along) > 0.0 {
            -normal
        } else {
            normal
        }
    }

    /// The mirror direction of the ray, of unit length.
    #[must_use]
    pub fn mirrored(&self) -> DVec3 {
        self.ray.along.reflect(self.normal())
    }

    /// The direction to the eye, in the frame of the surface.
    fn wo(&self) -> DVec3 {
        self.hit.frame.transpose() * -self.ray.along
    }
}

/// The nearness of a point to its blockers and reflected surroundings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Nearness {
    /// The mean of 1/distance, per metre, over the objects that the material reflects. For distant
    /// light, 1/distance is 0. The inverse of this mean is the harmonic mean of Durand et al. 2005,
    /// section 6.2.
    pub reflected: f64,
    /// The highest frequency of penumbrae, in cycles per metre perpendicular to the light. It is
    /// the inverse of the width of the penumbra, which is the region where light is partly blocked.
    pub shadow: f64,
}

impl Paths {
    /// Traces a camera ray to its first hit.
    #[must_use]
    pub fn view(&self, look: &Look) -> View {
        let ray = Ray::new(look.from, look.along);
        let hit = self.geometry.first(&ray, look.seen);
        View {
            emitted: self.shown(&ray, hit.as_ref(), 0),
            surface: hit.map(|hit| SurfaceHit { hit, ray }),
        }
    }

    /// The kind of reflection of the surface.
    #[must_use]
    pub fn reflects(&self, seen: &SurfaceHit) -> Reflects {
        self.scatter(&seen.hit).kind(&seen.hit.point, seen.wo())
    }

    /// The texture factors of base and lobe. A material with one part has only a base.
    #[must_use]
    pub fn factors(&self, seen: &SurfaceHit) -> [f64; 2] {
        self.scatter(&seen.hit).factors(&seen.hit.point, seen.wo())
    }

    /// The radiance, in W m⁻² sr⁻¹, that base and lobe scatter to the eye. The two
    /// radiances are means over `paths` paths. Also returns the variance of their sum, divided by
    /// the number of paths. The result depends only on the point, the seed and `number`.
    ///
    /// Paths of one point use a scrambled net for their first numbers, so the error of the mean is
    /// smaller than this variance suggests.
    #[must_use]
    pub fn shade(&self, seen: &SurfaceHit, paths: u32, seed: u64, number: u64) -> ([f64; 2], f64) {
        let net = Net::new(seed, Stream::Net, number, JOINT);
        let [mut base, mut mean, mut squares] = [0.0; 3];
        for path in 0..paths {
            let key = number * u64::from(paths) + u64::from(path);
            let numbers = PathNumbers::new(seed, key).of_net(&net, path);
            let parts = self.by_one_path(seen, 0, numbers);
            let radiance = parts[0] + parts[1];
            base += parts[0];
            let off = radiance - mean;
            mean += off / f64::from(path + 1);
            squares += off * (radiance - mean);
        }
        let count = f64::from(paths);
        base /= count;
        let variance = squares / (count * (count - 1.0).max(1.0));
        ([base, mean - base], variance)
    }

    /// Estimates, by one path, the direct light that base and lobe scatter to the eye, in W m⁻²
    /// sr⁻¹. The random numbers belong to point `index` of a net, which all calls with the same
    /// `number` share.
    #[must_use]
    pub fn direct(&self, seen: &SurfaceHit, seed: u64, number: u64, index: u32) -> [f64; 2] {
        let net = Net::new(seed, Stream::EvenNet, number, JOINT);
        let numbers = PathNumbers::new(seed, number).of_net(&net, index);
        self.by_one_path(seen, self.depth.saturating_sub(1), numbers)
    }

    /// Estimates the radiance of base and lobe by one path, which ends as if `before` surfaces were between
    /// the point and the eye.
    fn by_one_path(&self, seen: &SurfaceHit, before: u32, numbers: PathNumbers<'_>) -> [f64; 2] {
        let scatter = self.scatter(&seen.hit);
        let mut parts = [0.0; 2];
        let mut walk = TracedPath::new(0, (seen.ray, seen.hit), numbers);
        let walks = std::slice::from_mut(&mut walk);
        self.scattered(walks, before, LightSearch::Both, &mut |_, wi, light| {
            if light > 0.0 {
                let base = scatter.base_share(&seen.hit.point, wi, seen.wo());
                parts[0] += light * base;
                parts[1] += light * (1.0 - base);
            }
        });
        parts
    }

    /// The nearness of a point to the objects that it reflects and to its blockers. The
    /// function traces `rays` rays of each kind. Distances below `nearest` count as `nearest`.
    #[must_use]
    pub fn nearness(
        &self,
        seen: &SurfaceHit,
        rays: u32,
        nearest: f64,
        seed: u64,
        number: u64,
    ) -> Nearness {
        let net = Net::new(seed, Stream::EvenNet, number, JOINT);
        let scatter = self.scatter(&seen.hit);
        let [mut reflected, mut lit, mut blocked, mut sharp] = [0.0; 4];
        for ray in 0..rays {
            let mut numbers = PathNumbers::new(seed, number).of_net(&net, ray);
            if let Some(shadow) = self.shadow(seen, numbers.draw()) {
                if shadow.nearness > 0.0 {
                    blocked += shadow.light;
                    // The mean is geometric, so that a few very near blockers do not dominate the
                    // shadow.
                    sharp += shadow.light * libm::log(shadow.nearness.min(nearest.recip()));
                } else {
                    lit += shadow.light;
                }
            }
            reflected += scatter
                .sample(&seen.hit.point, seen.wo(), numbers.draw())
                .map_or(0.0, |bounce| {
                    let along = (seen.hit.frame * bounce.wi).normalize();
                    self.inverse_distance(seen, along, nearest)
                });
        }
        // A point that is fully lit or fully blocked is in no penumbra.
        let contrast = 4.0 * lit * blocked / (lit + blocked).powi(2);
        Nearness {
            reflected: reflected / f64::from(rays.max(1)),
            shadow: if contrast > 0.0 {
                contrast * libm::exp(sharp / blocked)
            } else {
                0.0
            },
        }
    }

    /// Returns 1/d', where d' is the harmonic mean of the distances to occluders (Durand et al.
    /// 2005, section 6.2). The `rays` rays are uniform over the hemisphere around the normal,
    /// whatever the material; the paper does not state their distribution. For a ray that hits
    /// nothing, 1/distance is 0. Distances below `nearest` count as `nearest`.
    #[must_use]
    pub fn harmonic_nearness(
        &self,
        seen: &SurfaceHit,
        rays: u32,
        nearest: f64,
        seed: u64,
        number: u64,
    ) -> f64 {
        let net = Net::new(seed, Stream::EvenNet, number, JOINT);
        let normal = seen.normal();
        let of = |ray: u32| {
            let mut numbers = PathNumbers::new(seed, number).of_net(&net, ray);
            let along = sphere(numbers.draw());
            // The opposite of a direction below the surface is above it.
            let along = along * along.dot(normal).signum();
            self.inverse_distance(seen, along, nearest)
        };
        (0..rays).map(of).sum::<f64>() / f64::from(rays.max(1))
    }

    /// Returns 1/distance of what a ray from the point hits, or 0 if it hits nothing.
    fn inverse_distance(&self, seen: &SurfaceHit, along: DVec3, nearest: f64) -> f64 {
        let ray = Ray::new(seen.hit.position, along);
        let hit = self.geometry.first(&ray, [0.0, f64::INFINITY]);
        hit.map_or(0.0, |hit| hit.distance.max(nearest).recip())
    }

    /// Samples a light, and finds what blocks it.
    fn shadow(&self, seen: &SurfaceHit, random: [f64; 4]) -> Option<Shadow> {
        let Hit {
            position: from,
            frame,
            point,
            ..
        } = seen.hit;
        let light = self.lights.sample(&self.geometry, from, random)?;
        let wi = frame.transpose() * light.toward;
        let value = light.weight * self.scatter(&seen.hit).value(&point, wi, seen.wo());
        if value <= 0.0 {
            return None;
        }
        let ray = Ray::new(from, light.toward);
        if self.geometry.is_free(&ray, light.distance) {
            return Some(Shadow {
                light: value,
                nearness: 0.0,
            });
        }
        let blocker = self.geometry.first(&ray, [0.0, light.distance])?.distance;
        // A sample represents a solid angle of about 1/density.
        let angle = light
            .density
            .map_or(POINT, |density| density.recip().sqrt());
        let width = angle.max(POINT) * blocker / (1.0 - blocker / light.distance);
        Some(Shadow {
            light: value,
            nearness: width.recip(),
        })
    }
}

/// Angle, in radians, that is assigned to point lights. With this angle, their shadows are sharp
/// enough for any picture.
const POINT: f64 = 1e-3;

struct Shadow {
    /// The light that the surface would reflect without the blocker.
    light: f64,
    /// The inverse of the penumbra width, per metre; 0 if nothing blocks the light.
    nearness: f64,
}
