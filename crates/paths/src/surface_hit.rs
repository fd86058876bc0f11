//! Places that a camera sees: their light, and how near what they reflect is. Renderers that choose where to spend paths ask these.

use crate::numbers::{JOINT, PathNumbers};
use crate::paths::Paths;
use crate::scatter::Reflects;
use crate::space::{Hit, Ray};
use etendue_transform::Net;
use etendue_transform::random::Stream;
use etendue_world::Look;
use glam::DVec3;

/// What a look meets.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// What sources themselves send along it, W m⁻² sr⁻¹.
    pub emitted: f64,
    /// The surface there; `None` where the look leaves the world.
    pub surface: Option<SurfaceHit>,
}

/// A place of a surface that is seen.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceHit {
    hit: Hit,
    /// The ray that sees it.
    ray: Ray,
}

impl SurfaceHit {
    /// The number of its shape.
    #[must_use]
    pub fn shape(&self) -> usize {
        self.hit.shape
    }

    /// In the world.
    #[must_use]
    pub fn position(&self) -> DVec3 {
        self.hit.position
    }

    /// How far it is.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.hit.distance
    }

    /// The normal that materials scatter by, on the side that is seen.
    #[must_use]
    pub fn normal(&self) -> DVec3 {
        let normal = self.hit.frame.z_axis;
        if normal.dot(self.ray.along) > 0.0 {
            -normal
        } else {
            normal
        }
    }

    /// Where a mirror there would show light from, of unit length.
    #[must_use]
    pub fn mirrored(&self) -> DVec3 {
        let normal = self.normal();
        self.ray.along - 2.0 * self.ray.along.dot(normal) * normal
    }

    /// The way that light goes to the eye, in the frame of the surface.
    fn wo(&self) -> DVec3 {
        self.hit.frame.transpose() * -self.ray.along
    }
}

/// How near a place is to what stands before the light that it reflects.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Nearness {
    /// The mean of 1/distance over what its material reflects, per metre; light from far away counts as 0. Its inverse is the harmonic mean of Durand et
    /// al. 2005, section 6.2.
    pub reflected: f64,
    /// The highest frequency of half shadows there, cycles per metre across the light: one over the width of a half shadow, where light is blocked in part.
    pub shadow: f64,
}

impl Paths {
    /// What a look meets.
    #[must_use]
    pub fn view(&self, look: &Look) -> View {
        let ray = Ray {
            from: look.from,
            along: look.along,
        };
        let hit = self.geometry.first(&ray, look.seen);
        View {
            emitted: self.shown(&ray, hit.as_ref(), 0),
            surface: hit.map(|hit| SurfaceHit { hit, ray }),
        }
    }

    /// What the surface does to light, in a word.
    #[must_use]
    pub fn reflects(&self, seen: &SurfaceHit) -> Reflects {
        self.scatter(&seen.hit).kind(seen.hit.uv, seen.wo())
    }

    /// The factors of base and lobe there, as textures have them. What has one part only has that as its base.
    #[must_use]
    pub fn factors(&self, seen: &SurfaceHit) -> [f64; 2] {
        self.scatter(&seen.hit).factors(seen.hit.uv, seen.wo())
    }

    /// The radiance that the surface scatters to the eye, by its base and by its lobe, W m⁻² sr⁻¹: means of `paths` paths; and the variance of their sum
    /// over the number of paths. It is a function of the place, the seed and `number`.
    ///
    /// Paths of one place begin with the points of a scrambled net, which makes the mean better than that variance says.
    #[must_use]
    pub fn shade(&self, seen: &SurfaceHit, paths: u32, seed: u64, number: u64) -> ([f64; 2], f64) {
        let net = Net::new(seed, Stream::Net, number, JOINT);
        let scatter = self.scatter(&seen.hit);
        let [mut base, mut mean, mut squares] = [0.0; 3];
        for path in 0..paths {
            let key = number * u64::from(paths) + u64::from(path);
            let mut numbers = PathNumbers::new(seed, key).of_net(&net, path);
            let mut radiance = 0.0;
            self.scattered(seen.ray, seen.hit, 0, &mut numbers, &mut |wi, light| {
                if light > 0.0 {
                    radiance += light;
                    base += light * scatter.base_share(seen.hit.uv, wi, seen.wo());
                }
            });
            let off = radiance - mean;
            mean += off / f64::from(path + 1);
            squares += off * (radiance - mean);
        }
        let count = f64::from(paths);
        base /= count;
        let variance = squares / (count * (count - 1.0).max(1.0));
        ([base, mean - base], variance)
    }

    /// How near a place is to what it reflects and to what shadows it, by `rays` rays of each kind. What is nearer than `nearest` counts as there.
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
                    // Their geometric mean: few that are very near do not make the shadow of all.
                    sharp += shadow.light * libm::log(shadow.nearness.min(nearest.recip()));
                } else {
                    lit += shadow.light;
                }
            }
            reflected += scatter
                .sample(seen.hit.uv, seen.wo(), numbers.draw())
                .and_then(|bounce| {
                    let along = (seen.hit.frame * bounce.wi).normalize();
                    let from = seen.hit.position;
                    self.geometry
                        .first(&Ray { from, along }, [0.0, f64::INFINITY])
                })
                .map_or(0.0, |hit| hit.distance.max(nearest).recip());
        }
        // No half shadow has all light, or none.
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

    /// Light that is looked for at the lights, and what stands before it.
    fn shadow(&self, seen: &SurfaceHit, random: [f64; 4]) -> Option<Shadow> {
        let Hit {
            position: from,
            frame,
            uv,
            ..
        } = seen.hit;
        let light = self.lights.sample(&self.geometry, from, random)?;
        let wi = frame.transpose() * light.toward;
        let value = light.weight * self.scatter(&seen.hit).value(uv, wi, seen.wo());
        if value <= 0.0 {
            return None;
        }
        let ray = Ray {
            from,
            along: light.toward,
        };
        if self.geometry.is_free(&ray, light.distance) {
            return Some(Shadow {
                light: value,
                nearness: 0.0,
            });
        }
        let blocker = self.geometry.first(&ray, [0.0, light.distance])?.distance;
        // What is looked for this densely covers some 1/density of all directions.
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

/// Radians across what has no size: its shadows are sharp enough for any picture.
const POINT: f64 = 1e-3;

struct Shadow {
    /// What would be reflected of it.
    light: f64,
    /// One over the width of the half shadow, per metre; 0 where the way is free.
    nearness: f64,
}
