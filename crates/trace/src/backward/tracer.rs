//! The backward tracer: draws rays in the window of each plane and traces them to the light.

use super::connected::{connection, finds};
use super::end::End;
use super::leg::{BackwardCourse, BackwardLeg, IncomingRay, LeftSurface, Scattering};
use super::plane_sampler::PlaneSampler;
use super::reflected::Reflection;
use super::source::TracedLight;
use crate::batch_ranges::{BLOCK, BatchRanges};
use crate::bounce::at;
use crate::brdf;
use crate::heading::Heading;
use crate::line::{direction, start};
use crate::sampling::{LAMBERTIAN, point};
use etendue_field::{
    Crossing, Frame, Ledger, Light, PhotonSource, Specular, TwoPlane, facet_ratio,
};
use etendue_sampling::{about, cosine_hemisphere};
use etendue_scene::{Object, Scene};
use etendue_transform::random::{self, Stream};
use glam::DVec3;

/// The backward tracer of a scene, which checks [`Tracer`](crate::Tracer) independently.
///
/// For each photon of the run and each virtual plane, this tracer draws a ray in the plane's
/// window. It traces the ray back to the light and finds the radiance that arrives along the ray.
/// It emits and absorbs no photons, so it has no ledger.
#[derive(Debug)]
pub struct Backward {
    light: TracedLight,
    legs: Vec<BackwardLeg>,
    samplers: Vec<PlaneSampler>,
    shares: BatchRanges,
    seed: u64,
}

/// The error for a virtual plane at which no backward ray finds the light, for example because a
/// mirror deflects the light of a point source.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no ray traced back from {plane} finds the light: the plane lies at a point light, or a mirror, an interface or a lens deflects the light of a point or a beam; measure this plane with photons"
)]
pub struct LightNotFound {
    plane: String,
}

impl Backward {
    /// Builds the backward tracer of a scene.
    ///
    /// # Errors
    /// When rays from a plane cannot find the light (see [`finds`]).
    pub fn new(scene: &Scene) -> Result<Self, LightNotFound> {
        if let Some(plane) = scene.planes.iter().find(|plane| !finds(scene, plane)) {
            let plane = plane.name.clone();
            return Err(LightNotFound { plane });
        }
        let light = TracedLight::new(&scene.light);
        let planes = scene.planes.iter().enumerate();
        let samplers = planes.map(|(i, p)| PlaneSampler::new(scene, i, p, &light));
        let samplers = samplers.collect();
        Ok(Self {
            light,
            legs: (0..scene.path.legs.len())
                .map(|leg| BackwardLeg::new(scene, leg))
                .collect(),
            samplers,
            shares: BatchRanges::new(&scene.run),
            seed: scene.run.seed,
        })
    }

    /// The radiance that crosses plane number `plane` along a ray, in W m⁻² sr⁻¹, times dA /
    /// dx dy on a curved surface. The ray is given in the coordinates of the plane.
    ///
    /// If light is scattered on its way, the result is an unbiased estimate, and `index` selects its
    /// random numbers. Otherwise, the result is exact. At a plane on the first leg, light without
    /// extent has no finite radiance, and the result has no meaning.
    ///
    /// # Panics
    ///
    /// Panics if the scene has no such plane.
    #[must_use]
    pub fn radiance(&self, plane: usize, ray: &TwoPlane, index: u64) -> f64 {
        let sampler = &self.samplers[plane];
        let plane = u32::try_from(plane).unwrap_or(u32::MAX);
        let is_ahead = sampler.leg > 0 || sampler.planes_on_leg.along.is_ahead([ray.x, ray.y]);
        let on_leg = sampler.leg_ray(ray).filter(|_| is_ahead);
        on_leg.map_or(0.0, |(on_leg, end, area)| {
            let words = |block| self.random_numbers(plane, index, block);
            area * self.incident(&on_leg, end, 1, &words)
        })
    }

    /// Four random numbers of ray number `index` of one plane. The ray itself uses block 0,
    /// and each surface that it meets uses a further block.
    fn random_numbers(&self, plane: u32, index: u64, block: u32) -> [f64; 4] {
        let blocks = u32::try_from(self.legs.len().max(2)).unwrap_or(u32::MAX);
        let block = blocks * plane + block;
        random::words(self.seed, Stream::Backward, index, block).map(random::unit)
    }

    /// The ray with number `index` of one plane, and the weight of this ray in radiance
    /// space.
    fn sample(&self, sampler: &PlaneSampler, plane: u32, index: u64) -> Crossing {
        let words = |block| self.random_numbers(plane, index, block);
        let r = words(0);
        let [x, y] = [0, 1].map(|axis| sampler.position[axis].quantile(r[axis]));
        let mut density = sampler.position[0].density(x) * sampler.position[1].density(y);
        if let (TracedLight::Narrow(light), 0) = (&self.light, sampler.leg) {
            let (u, v) = (0.0, 0.0);
            let dark = Crossing {
                ray: TwoPlane { x, y, u, v },
                weight: 0.0,
            };
            let seen = self.look_at_light(sampler, light, [x, y], density);
            return seen.unwrap_or(dark);
        }
        let by_window =
            |[u, v]: [f64; 2]| sampler.slope[0].density(u) * sampler.slope[1].density(v);
        let in_window = |r: [f64; 2]| [0, 1].map(|axis| sampler.slope[axis].quantile(r[axis]));
        let [u, v] = match &self.light {
            TracedLight::Area { shape, .. } if sampler.to_light => {
                let [x0, y0] = point(shape, [r[2], r[3]]);
                let distance = sampler.planes_on_leg.along.distance;
                density *= distance * distance / shape.area();
                [(x - x0) / distance, (y - y0) / distance]
            }
            TracedLight::Sky(sky) if sampler.to_light => {
                // Half of the rays draw their slopes in proportion to the environment's radiance.
                // Directions that do not go forward are discarded.
                let drawn = if r[2] < 0.5 {
                    sky.slopes(words(1))
                } else {
                    Some(in_window([2.0 * r[2] - 1.0, r[3]]))
                };
                let [u, v] = drawn.unwrap_or([f64::INFINITY; 2]);
                let by_sky = drawn.map_or(0.0, |_| sky.slope_density(&TwoPlane { x, y, u, v }));
                density *= 0.5 * (by_sky + by_window([u, v]));
                [u, v]
            }
            _ => {
                let slopes = in_window([r[2], r[3]]);
                density *= by_window(slopes);
                slopes
            }
        };
        let ray = TwoPlane { x, y, u, v };
        let is_ahead = sampler.leg > 0 || sampler.planes_on_leg.along.is_ahead([x, y]);
        let on_leg = sampler.leg_ray(&ray);
        let on_leg = on_leg.filter(|_| density > 0.0 && is_ahead);
        let Some((on_leg, end, area)) = on_leg else {
            return Crossing { ray, weight: 0.0 };
        };
        let found = self.incident(&on_leg, end, 1, &words);
        Crossing {
            ray,
            weight: area * found / density,
        }
    }

    /// The radiance that arrives at the end point of a ray. `block` selects the random
    /// numbers of the next surface on the way back to the light.
    #[expect(
        clippy::too_many_lines,
        reason = "the function has a case for each kind of surface"
    )]
    fn incident(
        &self,
        incoming: &IncomingRay,
        end: End,
        block: u32,
        words: &impl Fn(u32) -> [f64; 4],
    ) -> f64 {
        let IncomingRay { leg, heading, ray } = incoming;
        let this = &self.legs[*leg];
        let Some(BackwardCourse {
            frame,
            obstacles,
            leaves,
        }) = this.courses.of(*heading)
        else {
            return 0.0;
        };
        let (distance, side) = end.at();
        let Some(leaves) = leaves else {
            let radiance = self.light.radiance(ray);
            if radiance <= 0.0 {
                return 0.0;
            }
            let visible = obstacles.visibility(ray, 0.0, distance, side, |what| what.is(this.ends));
            return radiance * visible;
        };
        let Some((begin, primitive)) = leaves.primitives.last(ray, end.of_line()) else {
            return 0.0;
        };
        let from = begin + leaves.rounding;
        if matches!(end, End::OnSurface(_)) && distance <= from {
            return 0.0;
        }
        let ignored = |object| Some(object) == this.ends || object == leaves.object;
        let visible = obstacles.visibility(ray, from, distance, side, |what| {
            what.object().is_some_and(ignored)
        });
        if visible <= 0.0 {
            return 0.0;
        }
        let along = direction(ray);
        let point = start(ray) + begin * along;
        match &leaves.how {
            Scattering::Diffuse { albedo, .. } => {
                // The normal points to the side to which the light travels.
                let normal = primitive.normal(point);
                let normal = frame.vector_to_world(normal.dot(along).signum() * normal);
                let point = frame.to_world(point);
                visible * albedo / LAMBERTIAN
                    * self.irradiance(*leg - 1, point, normal, block, words)
            }
            Scattering::Reflects { patch, reflectance } => {
                let facing = primitive.normal(point);
                if along.dot(facing) <= 0.0 {
                    return 0.0;
                }
                let at_point = Frame::IDENTITY.turned_to(frame.vector_to_world(facing));
                let to = at_point.vector_to_local(frame.vector_to_world(along));
                let brdf = at(patch, reflectance, point);
                if brdf.albedo() <= 0.0 {
                    return 0.0;
                }
                let reflection = Reflection {
                    brdf,
                    point: frame.to_world(point),
                    frame: at_point,
                    to: to.normalize(),
                };
                visible * self.reflected(*leg - 1, &reflection, block, words)
            }
            Scattering::Turned { lens, event } => {
                let facing = primitive.normal(point);
                let Some(came) = event.turned(lens, facing, point, -along) else {
                    return 0.0;
                };
                let to_front = along.dot(facing) > 0.0;
                // Photons have this ratio by themselves, because each of them keeps its flux.
                let by_facet = primitive.facet_normal().map_or(1.0, |facet| {
                    let ratio = facet_ratio(facet, facing, came, along).abs();
                    if ratio.is_finite() { ratio } else { 0.0 }
                });
                let factor = by_facet * radiance_factor(lens, *event, to_front, along, came);
                let [point, came] = [frame.to_world(point), frame.vector_to_world(-came)];
                visible * factor * self.along(*leg - 1, point, came, block, words)
            }
        }
    }

    /// The radiance that arrives in a direction at a point of the surface that ends a leg.
    /// The direction and the point are in the frame at the light.
    fn along(
        &self,
        leg: usize,
        point: DVec3,
        direction: DVec3,
        block: u32,
        words: &impl Fn(u32) -> [f64; 4],
    ) -> f64 {
        let frame = &self.legs[leg].courses.along.frame;
        let [point, direction] = [frame.to_local(point), frame.vector_to_local(direction)];
        Heading::of(point, direction).map_or(0.0, |(heading, ray)| {
            let incoming = IncomingRay { leg, heading, ray };
            self.arriving(&incoming, heading.turned(point).z, block, words)
        })
    }

    /// The radiance that arrives along a ray at a point of the surface that ends its leg.
    /// The point is at the distance `end`. If the surface is concave or solid, another part of it
    /// may block this ray.
    fn arriving(
        &self,
        incoming: &IncomingRay,
        end: f64,
        block: u32,
        words: &impl Fn(u32) -> [f64; 4],
    ) -> f64 {
        let IncomingRay { leg, heading, ray } = incoming;
        // Light begins in the plane through the light's centre, across the central ray.
        if *leg == 0 && end <= 0.0 {
            return 0.0;
        }
        let this = &self.legs[*leg];
        let Some(course) = this.courses.of(*heading) else {
            return 0.0;
        };
        if !matches!(this.ends, Some(Object::Surface(_))) {
            let from = course.leaves.as_ref().map_or(0.0, |leaves| {
                let left = leaves.primitives.last(ray, end);
                left.map_or(0.0, |(at, _)| at + leaves.rounding)
            });
            if course.obstacles.is_behind(this.ends, ray, from, end) {
                return 0.0;
            }
        }
        self.incident(incoming, End::Surface(end), block, words)
    }

    /// The irradiance at a point with a given normal at the end of a leg. The light comes
    /// from one point of the surface, or of the light source, at the beginning of the leg. All
    /// vectors are in the frame at the light.
    fn irradiance(
        &self,
        leg: usize,
        point: DVec3,
        normal: DVec3,
        block: u32,
        words: &impl Fn(u32) -> [f64; 4],
    ) -> f64 {
        let r = words(block);
        let this = &self.legs[leg].courses;
        let pieces = match &this.along.leaves {
            None => None,
            Some(LeftSurface {
                how: Scattering::Diffuse { pieces, .. },
                ..
            }) => Some(pieces),
            Some(_) => return self.through_turn(leg, point, normal, r, block, words),
        };
        let (from, facing, area) = match (pieces, &self.light) {
            (Some(pieces), _) => {
                let (from, facing) = pieces.point([r[0], r[1], r[2]]);
                (from, facing, pieces.area())
            }
            (None, TracedLight::Area { shape, .. }) => {
                let [x, y] = self::point(shape, [r[0], r[1]]);
                (DVec3::new(x, y, 0.0), DVec3::Z, shape.area())
            }
            (None, TracedLight::Narrow(light)) => {
                return connection(light, point).map_or(0.0, |(ray, irradiance)| {
                    let cosine = -direction(&ray).normalize().dot(normal);
                    let incoming = IncomingRay::from_light(ray);
                    let found = self.arriving(&incoming, point.z, block + 1, words);
                    cosine.max(0.0) * irradiance * found
                });
            }
            (None, TracedLight::Sky(sky)) => {
                return sky.irradiance(point, normal, r, |ray, end| {
                    self.arriving(&IncomingRay::from_light(*ray), end, block + 1, words)
                });
            }
        };
        let way = point - from;
        let radiance_per_flux = way.dot(facing).abs() * -way.dot(normal);
        let frame = &this.along.frame;
        let [end, begin] = [point, from].map(|p| frame.to_local(p));
        let Some((heading, ray)) =
            Heading::of(end, end - begin).filter(|_| radiance_per_flux > 0.0)
        else {
            return 0.0;
        };
        let [end, begin] = [end, begin].map(|p| heading.turned(p).z);
        // A nearer point of the same surface on the line hides the point that was drawn.
        let nearer = |leaves: &LeftSurface| {
            leaves
                .primitives
                .last(&ray, end)
                .is_none_or(|(at, _)| at > begin + leaves.rounding)
        };
        let leaves = this.of(heading).and_then(|course| course.leaves.as_ref());
        if leaves.is_some_and(nearer) {
            return 0.0;
        }
        // The irradiance is the radiance times cos θ cos θ' dA / r².
        let solid = radiance_per_flux * area / way.length_squared().powi(2);
        let incoming = IncomingRay { leg, heading, ray };
        solid * self.arriving(&incoming, end, block + 1, words)
    }
}

impl Backward {
    /// The irradiance at a point behind a mirror, an interface or a lens, estimated from
    /// one direction that is drawn in proportion to the cosine.
    fn through_turn(
        &self,
        leg: usize,
        point: DVec3,
        normal: DVec3,
        r: [f64; 4],
        block: u32,
        words: &impl Fn(u32) -> [f64; 4],
    ) -> f64 {
        let towards = about(normal, cosine_hemisphere([r[0], r[1]]));
        LAMBERTIAN * self.along(leg, point, -towards, block + 1, words)
    }
}

/// Returns the ratio of the radiance after a deflection to the radiance before it, for light that
/// arrives along `came` and leaves along `along`. At an interface, the ratio is (n'/n)². At an
/// ideal lens, the ratio follows from the conservation of flux in two-plane coordinates.
fn radiance_factor(
    lens: &Frame,
    event: Specular,
    to_front: bool,
    along: DVec3,
    came: DVec3,
) -> f64 {
    match event {
        Specular::Mirror => 1.0,
        Specular::Refraction { front, back } => {
            let ratio = if to_front { front / back } else { back / front };
            ratio * ratio
        }
        Specular::ThinLens { .. } => {
            let cosine = |v: DVec3| v.dot(lens.d).abs() / v.length();
            (cosine(came) / cosine(along)).powi(4)
        }
    }
}

impl Backward {
    /// The radiance reflected at the end of a leg, estimated from one direction. On later
    /// legs, the direction is drawn by the lobe of the BRDF. On the first leg, half of the
    /// directions are drawn by the lobe, and half of them towards a point of the light. The
    /// estimate is divided by the density of this mixture. This weighting is the balance heuristic
    /// of Veach and Guibas (1995) for one sample.
    fn reflected(
        &self,
        leg: usize,
        at: &Reflection<'_>,
        block: u32,
        words: &impl Fn(u32) -> [f64; 4],
    ) -> f64 {
        let r = words(block);
        let Reflection {
            brdf, frame, to, ..
        } = at;
        let sees_light = self.legs[leg].courses.along.leaves.is_none();
        // No drawn direction would meet a light without extent.
        if let (TracedLight::Narrow(light), true) = (&self.light, sees_light) {
            return connection(light, at.point).map_or(0.0, |(ray, irradiance)| {
                let from = frame.vector_to_local(-direction(&ray).normalize());
                let carried = brdf::sum(brdf, from, *to) * from.z.max(0.0);
                let incoming = IncomingRay::from_light(ray);
                let found = self.arriving(&incoming, at.point.z, block + 1, words);
                carried * irradiance * found
            });
        }
        let from = if sees_light && r[2] < 0.5 {
            let towards = match &self.light {
                TracedLight::Area { shape, .. } => {
                    let [x, y] = point(shape, [r[0], r[1]]);
                    DVec3::new(x, y, 0.0) - at.point
                }
                TracedLight::Narrow(_) => return 0.0,
                TracedLight::Sky(sky) => -sky.sample([r[0], r[1], 2.0 * r[2], r[3]]),
            };
            frame.vector_to_local(towards).normalize()
        } else {
            brdf::towards(brdf, *to, [r[0], r[1]])
        };
        let carried = brdf::sum(brdf, from, *to) * from.z;
        let towards = frame.vector_to_world(from);
        let by_lobe = brdf::densities(brdf, *to, from);
        let density = if sees_light {
            0.5 * (by_lobe + self.light.density_towards(at.point, towards))
        } else {
            by_lobe
        };
        if carried > 0.0 {
            carried / density * self.along(leg, at.point, -towards, block + 1, words)
        } else {
            0.0
        }
    }
}

impl Backward {
    /// The radiance that a light without extent causes at a virtual plane on the first leg.
    /// Draws a point in the plane's window; one direction leads from it to the light.
    fn look_at_light(
        &self,
        sampler: &PlaneSampler,
        light: &Light,
        [x, y]: [f64; 2],
        density: f64,
    ) -> Option<Crossing> {
        let plane_on_leg = &sampler.planes_on_leg.along;
        let (point, normal, area) = plane_on_leg.point([x, y])?;
        let (at_light, _) = connection(light, point)?;
        let along = DVec3::new(at_light.u, at_light.v, 1.0);
        // The ratio of dA to du dv at the light. For distant light, dA is divided by dx dy.
        let cosine = along.dot(normal).abs();
        let per_ray = if light.is_distant() {
            cosine
        } else {
            cosine / (point.z * point.z)
        };
        let nothing = |_| [0.0; 4];
        // A virtual plane on a surface records all light that arrives at the surface, in the
        // backward tracer as in the forward tracer.
        let end = End::at_plane(plane_on_leg, point.z);
        let found = self.incident(&IncomingRay::from_light(at_light), end, 1, &nothing);
        let weight = found * per_ray * area / density;
        let (ray, weight) = plane_on_leg.at_plane(&at_light, weight)?;
        Some(Crossing { ray, weight })
    }
}

impl PhotonSource for Backward {
    fn emitted(&self, batch: u32) -> u64 {
        self.shares.count(batch)
    }

    fn parts(&self, batch: u32) -> u32 {
        self.shares.parts(batch)
    }

    fn emit_part(
        &self,
        batch: u32,
        part: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let range = self.shares.part(batch, part);
        let mut crossings = Vec::with_capacity(BLOCK);
        for start in range.clone().step_by(BLOCK) {
            let end = range.end.min(start + BLOCK as u64);
            for ((plane, sampler), number) in self.samplers.iter().enumerate().zip(0..) {
                let looks = (start..end).map(|index| self.sample(sampler, number, index));
                crossings.extend(looks.filter(|crossing| crossing.weight > 0.0));
                record(plane, &crossings);
                crossings.clear();
            }
            progress(end - start);
        }
        Ledger::default()
    }
}
