//! Paths of light through a world.

use crate::lights::LightSampler;
use crate::numbers::PathNumbers;
use crate::scatter::Scatter;
use crate::space::{Hit, Ray, SceneGeometry};
use etendue_world::World;
use glam::DVec3;

/// Paths of light through a world. They are traced back from the place where they are seen.
///
/// At each surface, direct light is sampled in two ways: from the lights and from the BSDF. The
/// power heuristic of multiple importance sampling weights the two results (Veach and Guibas 1995,
/// *Optimally combining sampling techniques*).
#[derive(Debug)]
pub struct Paths {
    pub(crate) geometry: SceneGeometry,
    pub(crate) lights: LightSampler,
    /// Whether some material is partly transparent.
    is_masked: bool,
    materials: Vec<Scatter>,
    of_shape: Vec<usize>,
    pub(crate) depth: u32,
    pub(crate) hides_sources: bool,
}

/// How a path finds lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LightSearch {
    /// By directions sampled from the lights, and by directions sampled from the BSDF.
    Both,
    /// Only by directions sampled from the BSDF.
    Bsdf,
}

/// Number of the surface at which Russian roulette begins. From this surface on, a path continues
/// only with a probability that depends on its throughput.
pub(crate) const ROULETTE: u32 = 6;

/// Maximum path length. It ends paths between mirrors; at this length, their throughput is below
/// the rounding error of a picture.
const LONGEST: u32 = 10_000;

/// A path that is traced back step by step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TracedPath<'a> {
    /// Distinguishes the path from others.
    number: usize,
    ray: Ray,
    hit: Hit,
    weight: f64,
    /// The direction in which the path has left its first hit.
    first: Option<DVec3>,
    /// The density of the ray's direction; `None` for a delta direction.
    density: Option<f64>,
    numbers: PathNumbers<'a>,
}

impl<'a> TracedPath<'a> {
    /// Begins a path at the hit of a ray.
    pub(crate) fn new(number: usize, (ray, hit): (Ray, Hit), numbers: PathNumbers<'a>) -> Self {
        Self {
            number,
            ray,
            hit,
            weight: 1.0,
            first: None,
            density: None,
            numbers,
        }
    }
}

impl Paths {
    /// The approximate memory that the hierarchies over a world take, in bytes.
    #[must_use]
    pub fn bytes(world: &World) -> f64 {
        SceneGeometry::bytes(world)
    }

    /// Creates the paths of a world whose shapes refer to existing materials.
    #[must_use]
    pub fn new(world: &World) -> Self {
        let geometry = SceneGeometry::new(world);
        let materials: Vec<Scatter> = world.materials.iter().map(Scatter::from).collect();
        Self {
            lights: LightSampler::new(world, &geometry),
            geometry,
            is_masked: materials.iter().any(Scatter::is_masked),
            materials,
            of_shape: world.shapes.iter().map(|shape| shape.material).collect(),
            depth: world.depth.unwrap_or(LONGEST).min(LONGEST),
            hides_sources: world.hides_sources,
        }
    }

    /// Estimates the radiance that arrives at the origin of a ray from distances within the visible
    /// range. The estimate follows one path and is unbiased. `before` is the number of surfaces
    /// between the origin and the camera.
    pub(crate) fn radiance(
        &self,
        ray: Ray,
        seen: [f64; 2],
        before: u32,
        search: LightSearch,
        numbers: PathNumbers<'_>,
    ) -> f64 {
        let hit = self.geometry.first(&ray, seen);
        let mut sum = self.shown(&ray, hit.as_ref(), before);
        if let Some(hit) = hit {
            let mut walk = TracedPath::new(0, (ray, hit), numbers);
            let walks = std::slice::from_mut(&mut walk);
            self.scattered(walks, before, search, &mut |_, _, light| sum += light);
        }
        sum
    }

    /// The radiance emitted by sources along a ray, as seen by a camera behind `before`
    /// surfaces.
    pub(crate) fn shown(&self, ray: &Ray, hit: Option<&Hit>, before: u32) -> f64 {
        if before > 0 || !self.hides_sources {
            self.emitted(ray, hit, None)
        } else {
            0.0
        }
    }

    /// Finds the radiance that hit surfaces scatters back along rays. `found` receives the parts
    /// that the path of each walk finds: the number of the walk, the incident direction in the
    /// frame of its first hit, and the radiance. `before` is the number of surfaces between the
    /// hits and the camera.
    ///
    /// All walks make a step before one makes the next. Their steps do not depend on each other, so
    /// a processor works on several at the same time.
    pub(crate) fn scattered(
        &self,
        mut walks: &mut [TracedPath<'_>],
        before: u32,
        search: LightSearch,
        found: &mut impl FnMut(usize, DVec3, f64),
    ) {
        walks = keep(walks, |walk| {
            let hit = walk.hit;
            if !self.passes(&hit, &mut walk.numbers) {
                return true;
            }
            walk.first = Some(hit.frame.transpose() * walk.ray.along);
            let next = self.geometry.behind(&walk.ray, &hit, f64::INFINITY);
            self.arrives(walk, next, search, found)
        });
        for met in before..self.depth {
            if walks.is_empty() {
                break;
            }
            if search == LightSearch::Both {
                PathNumbers::prepare(walks, |walk| &mut walk.numbers);
                for walk in &mut *walks {
                    let scatter = self.scatter(&walk.hit);
                    if !scatter.is_smooth() {
                        let wo = walk.hit.frame.transpose() * -walk.ray.along;
                        let random = walk.numbers.draw();
                        let (wi, light) = self.looked_for(&walk.hit, scatter, wo, random);
                        found(walk.number, walk.first.unwrap_or(wi), walk.weight * light);
                    }
                }
            }
            PathNumbers::prepare(walks, |walk| &mut walk.numbers);
            walks = keep(walks, |walk| {
                self.bounces(walk, met + 1 >= before + ROULETTE)
            });
            walks = keep(walks, |walk| {
                let next = self.geometry.first(&walk.ray, [0.0, f64::INFINITY]);
                self.arrives(walk, next, search, found)
            });
        }
    }

    /// Moves a path to the next surface that it does not pass. Reports the light of the sources on
    /// the way; returns false if the path leaves the world.
    fn arrives(
        &self,
        walk: &mut TracedPath<'_>,
        mut next: Option<Hit>,
        search: LightSearch,
        found: &mut impl FnMut(usize, DVec3, f64),
    ) -> bool {
        let density = walk.density.filter(|_| search == LightSearch::Both);
        let from = walk.first.unwrap_or(DVec3::Z);
        loop {
            let light = self.emitted(&walk.ray, next.as_ref(), density);
            found(walk.number, from, walk.weight * light);
            let Some(hit) = next else {
                return false;
            };
            walk.hit = hit;
            if !self.passes(&hit, &mut walk.numbers) {
                return true;
            }
            next = self.geometry.behind(&walk.ray, &hit, f64::INFINITY);
        }
    }

    /// The first hit of a ray that the ray does not pass.
    pub(crate) fn stopped(&self, ray: &Ray, numbers: &mut PathNumbers<'_>) -> Option<Hit> {
        let passes = |hit: &Hit| self.passes(hit, numbers);
        self.first_unless(ray, [0.0, f64::INFINITY], passes)
    }

    /// The first hit of a ray, at distances within bounds, with a surface that stops at
    /// least half of the light.
    pub(crate) fn mostly_stopped(&self, ray: &Ray, within: [f64; 2]) -> Option<Hit> {
        self.first_unless(ray, within, |hit| self.opacity(hit) < 0.5)
    }

    fn first_unless(
        &self,
        ray: &Ray,
        within: [f64; 2],
        mut passes: impl FnMut(&Hit) -> bool,
    ) -> Option<Hit> {
        let mut hit = self.geometry.first(ray, within)?;
        while passes(&hit) {
            hit = self.geometry.behind(ray, &hit, within[1])?;
        }
        Some(hit)
    }

    /// Decides whether light passes a partly transparent surface.
    fn passes(&self, hit: &Hit, numbers: &mut PathNumbers<'_>) -> bool {
        let opacity = self.opacity(hit);
        opacity < 1.0 && {
            let [drawn] = numbers.draw();
            drawn >= opacity
        }
    }

    /// The share of light that does not pass a surface unchanged.
    pub(crate) fn opacity(&self, hit: &Hit) -> f64 {
        if self.is_masked {
            self.scatter(hit).opacity(&hit.point)
        } else {
            1.0
        }
    }

    /// The share of light that passes along a ray up to a distance.
    #[inline]
    pub(crate) fn transmittance(&self, ray: &Ray, distance: f64) -> f64 {
        let opacity = |hit: &Hit| self.opacity(hit);
        self.geometry.transmittance(ray, distance, opacity)
    }

    /// Samples the direction in which a path continues; returns false if it ends.
    fn bounces(&self, walk: &mut TracedPath<'_>, has_roulette: bool) -> bool {
        let hit = &walk.hit;
        let wo = hit.frame.transpose() * -walk.ray.along;
        let random = walk.numbers.draw();
        let Some(bounce) = self.scatter(hit).sample(&hit.point, wo, random) else {
            return false;
        };
        walk.weight *= bounce.weight;
        let [survives] = walk.numbers.draw();
        if has_roulette {
            let share = walk.weight.min(0.95);
            if survives >= share {
                return false;
            }
            walk.weight /= share;
        }
        walk.ray = Ray::new(hit.position, (hit.frame * bounce.wi).normalize());
        walk.density = bounce.density;
        walk.first.get_or_insert(bounce.wi);
        true
    }

    /// The material at the hit.
    #[inline]
    pub(crate) fn scatter(&self, hit: &Hit) -> &Scatter {
        &self.materials[self.of_shape[hit.shape]]
    }

    /// Checks whether the world has distant light with a radiance from all directions.
    pub(crate) fn has_sky(&self) -> bool {
        self.lights.of_sky(DVec3::Z).next().is_some()
    }

    /// The light emitted along a ray that hits a light, with its weight in multiple
    /// importance sampling.
    #[inline]
    fn emitted(&self, ray: &Ray, hit: Option<&Hit>, last: Option<f64>) -> f64 {
        let weighted = |(radiance, looked): (f64, f64)| match last {
            Some(last) => radiance * mis_weight(last, looked),
            None => radiance,
        };
        match hit {
            Some(hit) => weighted(self.lights.of_hit(ray.from, ray.along, hit)),
            None => self.lights.of_sky(ray.along).map(weighted).sum(),
        }
    }

    /// Samples a light. Returns the light that this finds, and its incident direction in the frame
    /// of the hit.
    #[inline]
    fn looked_for(
        &self,
        hit: &Hit,
        scatter: &Scatter,
        wo: DVec3,
        random: [f64; 4],
    ) -> (DVec3, f64) {
        let Some(light) = self.lights.sample(&self.geometry, hit.position, random) else {
            return (DVec3::Z, 0.0);
        };
        let wi = hit.frame.transpose() * light.toward;
        let (value, density) = scatter.value_and_density(&hit.point, wi, wo);
        if value <= 0.0 {
            return (wi, 0.0);
        }
        let ray = Ray::new(hit.position, light.toward);
        let transmittance = self.transmittance(&ray, light.distance);
        if transmittance <= 0.0 {
            return (wi, 0.0);
        }
        let mis_weight = light
            .density
            .map_or(1.0, |looked| mis_weight(looked, density));
        (wi, value * light.weight * mis_weight * transmittance)
    }
}

/// Moves the kept items to the front, and returns them.
fn keep<T: Copy>(items: &mut [T], mut is_kept: impl FnMut(&mut T) -> bool) -> &mut [T] {
    let mut count = items.len();
    let mut i = 0;
    while i < count {
        if is_kept(&mut items[i]) {
            i += 1;
        } else {
            count -= 1;
            items[i] = items[count];
        }
    }
    &mut items[..count]
}

/// The weight of a direction with density `own` in multiple importance sampling, where the
/// other sampling strategy has density `other`. This is the power heuristic with exponent 2. Rare
/// directions of a BSDF that find a small light get almost no weight, so a pixel without such
/// directions is not too dark.
fn mis_weight(own: f64, other: f64) -> f64 {
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}
