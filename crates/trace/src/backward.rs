mod connected;
mod end;
mod reflected;

use crate::bounce::at;
use crate::emit::{LAMBERTIAN, by_cosine, point, radiance};
use crate::form::Form;
use crate::heading::{Both, Heading};
use crate::obstacles::{Around, Obstacles, direction, start};
use crate::pieces::Pieces;
use crate::proposal::Follower;
use crate::shares::{BLOCK, Shares};
use crate::sky::Sky;
use crate::station::Station;
use crate::targets::{Target, Targets};
use crate::tracer::rounding;
use connected::connection;
pub use connected::finds;
use end::End;
use etendue_field::random::{self, Stream};
use etendue_field::{
    Crossing, Frame, Ledger, Light, Orientation, Patch, PhotonSource, Reflectance, Shape, Specular,
    TwoPlane, VirtualPlane,
};
use etendue_scene::{Event, Object, PatchObject, Scene};
use glam::DVec3;
use reflected::Reflection;

/// The backward tracer of a scene, the independent check of [`Tracer`](crate::Tracer).
///
/// For each plane on its own, and for each photon, it draws a ray in the plane's window, follows it back, and finds the
/// radiance that comes along it. Nothing is emitted, aimed or absorbed, and there is no ledger.
#[derive(Debug)]
pub struct Backward {
    light: Source,
    legs: Vec<Leg>,
    lookers: Vec<Looker>,
    shares: Shares,
    seed: u64,
}

/// What a ray can find where the path begins.
#[derive(Debug)]
enum Source {
    /// A light that it hits.
    Area { light: Light, shape: Shape },
    /// Light from far away.
    Sky(Sky),
    /// A point, a projector or a beam, towards which rays are drawn.
    Narrow(Light),
}

/// A leg of the path, looked along from its end.
#[derive(Debug)]
struct Leg {
    courses: Both<Course>,
    /// What it ends on.
    ends: Option<Object>,
}

/// What light meets that goes one way on a leg.
#[derive(Debug)]
struct Course {
    /// In the frame at the light.
    frame: Frame,
    obstacles: Obstacles,
    /// The surface at its beginning; `None` for the first.
    leaves: Option<Leaves>,
}

/// A ray along which light of a leg may come, in the frame of its way.
#[derive(Clone, Copy, Debug)]
struct Incoming {
    leg: usize,
    heading: Heading,
    ray: TwoPlane,
}

/// The surface that light leaves at the beginning of a leg.
#[derive(Debug)]
struct Leaves {
    object: Object,
    /// In the frame of the course.
    targets: Targets<()>,
    how: How,
    rounding: f64,
}

/// How light leaves a surface.
#[derive(Debug)]
enum How {
    /// Diffusely, from pieces of which points can be drawn.
    Diffuse { albedo: f64, pieces: Pieces },
    /// By a BRDF that may vary over a patch, in the frame of the course.
    Reflects {
        patch: Patch,
        reflectance: Box<Reflectance>,
    },
    /// Turned; the lens's frame, in the frame of the course.
    Turned { lens: Frame, event: Specular },
}

/// A plane to which something turns the light of a point: no backward ray finds it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no ray traced back from {plane} finds the light: it is a point there, or a point or a beam that \
     a mirror, an interface or a lens turns first; measure it by photons"
)]
pub struct LightNotFound {
    plane: String,
}

/// How rays of one plane are drawn.
#[derive(Debug)]
struct Looker {
    leg: usize,
    stations: Both<Station>,
    position: [Follower; 2],
    slope: [Follower; 2],
    /// Whether slopes are drawn towards points of the light: where they are the narrower choice.
    to_light: bool,
}

impl Backward {
    /// The backward tracer of a scene.
    ///
    /// # Errors
    /// When rays from a plane cannot find the light (see [`finds`]).
    pub fn new(scene: &Scene) -> Result<Self, LightNotFound> {
        if let Some(plane) = scene.planes.iter().find(|plane| !finds(scene, plane)) {
            let plane = plane.name.clone();
            return Err(LightNotFound { plane });
        }
        let light = match &scene.light {
            Light::Area { shape, .. } => Source::Area {
                light: scene.light.clone(),
                shape: *shape,
            },
            Light::Environment { environment } => Source::Sky(Sky::new(environment)),
            Light::Point { .. }
            | Light::Projector { .. }
            | Light::Beam { .. }
            | Light::Rays { .. } => Source::Narrow(scene.light.clone()),
        };
        let planes = scene.planes.iter().enumerate();
        let lookers = planes.map(|(i, p)| Looker::new(scene, i, p, &light));
        let lookers = lookers.collect();
        Ok(Self {
            light,
            legs: (0..scene.path.legs.len())
                .map(|leg| Leg::new(scene, leg))
                .collect(),
            lookers,
            shares: Shares::new(&scene.run),
            seed: scene.run.seed,
        })
    }

    /// The ray of one plane with this number, and what it stands for in radiance space.
    fn look(&self, looker: &Looker, plane: u32, index: u64) -> Crossing {
        // One block for the ray, one for each surface on its way.
        let blocks = u32::try_from(self.legs.len().max(2)).unwrap_or(u32::MAX);
        let words = |block| {
            let block = blocks * plane + block;
            random::words(self.seed, Stream::Backward, index, block).map(random::unit)
        };
        let r = words(0);
        let [x, y] = [0, 1].map(|axis| looker.position[axis].quantile(r[axis]));
        let mut density = looker.position[0].density(x) * looker.position[1].density(y);
        if let (Source::Narrow(light), 0) = (&self.light, looker.leg) {
            let (u, v) = (0.0, 0.0);
            let dark = Crossing {
                ray: TwoPlane { x, y, u, v },
                weight: 0.0,
            };
            let seen = self.look_at_light(looker, light, [x, y], density);
            return seen.unwrap_or(dark);
        }
        let by_window = |[u, v]: [f64; 2]| looker.slope[0].density(u) * looker.slope[1].density(v);
        let in_window = |r: [f64; 2]| [0, 1].map(|axis| looker.slope[axis].quantile(r[axis]));
        let [u, v] = match &self.light {
            Source::Area { shape, .. } if looker.to_light => {
                let [x0, y0] = point(shape, [r[2], r[3]]);
                let distance = looker.stations.along.distance;
                density *= distance * distance / shape.area();
                [(x - x0) / distance, (y - y0) / distance]
            }
            Source::Sky(sky) if looker.to_light => {
                // Half of them by the environment; its directions go forward or nowhere.
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
        let is_ahead = looker.leg > 0 || looker.stations.along.is_ahead([x, y]);
        let on_leg = looker.leg_ray(&ray);
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

    /// The radiance that arrives at the end of a ray; `block` numbers the random
    /// numbers of the next surface on its way back.
    fn incident(
        &self,
        incoming: &Incoming,
        end: End,
        block: u32,
        words: &impl Fn(u32) -> [f64; 4],
    ) -> f64 {
        let Incoming { leg, heading, ray } = incoming;
        let this = &self.legs[*leg];
        let Some(Course {
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
        let Some((begin, target)) = leaves.targets.last(ray, end.of_line()) else {
            return 0.0;
        };
        let from = begin + leaves.rounding;
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
            How::Diffuse { albedo, .. } => {
                // It was left on the side it goes away from.
                let normal = target.normal(point);
                let normal = frame.vector_to_world(normal.dot(along).signum() * normal);
                let point = frame.to_world(point);
                visible * albedo / LAMBERTIAN
                    * self.irradiance(*leg - 1, point, normal, block, words)
            }
            How::Reflects { patch, reflectance } => {
                let facing = target.normal(point);
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
            How::Turned { lens, event } => {
                let facing = target.normal(point);
                let Some(came) = event.turned(lens, facing, point, -along) else {
                    return 0.0;
                };
                let to_front = along.dot(facing) > 0.0;
                let factor = radiance_factor(lens, *event, to_front, along, came);
                let [point, came] = [frame.to_world(point), frame.vector_to_world(-came)];
                visible * factor * self.along(*leg - 1, point, came, block, words)
            }
        }
    }

    /// The radiance that arrives in a direction at a point of the surface that ends a leg, both in the frame at the light.
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
            let incoming = Incoming { leg, heading, ray };
            self.arriving(&incoming, heading.turned(point).z, block, words)
        })
    }

    /// The radiance that arrives along a ray at a point, `end` along the way, of the surface that ends its leg: of a hollow or a bulky one, another part
    /// may stand in the way.
    fn arriving(
        &self,
        incoming: &Incoming,
        end: f64,
        block: u32,
        words: &impl Fn(u32) -> [f64; 4],
    ) -> f64 {
        let Incoming { leg, heading, ray } = incoming;
        // Light begins in the plane across the central ray at its centre.
        if *leg == 0 && end <= 0.0 {
            return 0.0;
        }
        let this = &self.legs[*leg];
        let Some(course) = this.courses.of(*heading) else {
            return 0.0;
        };
        if !matches!(this.ends, Some(Object::Surface(_))) {
            let from = course.leaves.as_ref().map_or(0.0, |leaves| {
                let left = leaves.targets.last(ray, end);
                left.map_or(0.0, |(at, _)| at + leaves.rounding)
            });
            if course.obstacles.is_behind(this.ends, ray, from, end) {
                return 0.0;
            }
        }
        self.incident(incoming, End::Surface(end), block, words)
    }

    /// The irradiance at a point, with its normal, at the end of a leg, from one point of what light leaves at its beginning;
    /// in the frame at the light.
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
            Some(Leaves {
                how: How::Diffuse { pieces, .. },
                ..
            }) => Some(pieces),
            Some(_) => return self.through_turn(leg, point, normal, r, block, words),
        };
        let (from, facing, area) = match (pieces, &self.light) {
            (Some(pieces), _) => {
                let (from, facing) = pieces.point([r[0], r[1], r[2]]);
                (from, facing, pieces.area())
            }
            (None, Source::Area { shape, .. }) => {
                let [x, y] = self::point(shape, [r[0], r[1]]);
                (DVec3::new(x, y, 0.0), DVec3::Z, shape.area())
            }
            (None, Source::Narrow(light)) => {
                return connection(light, point).map_or(0.0, |(ray, irradiance)| {
                    let cosine = -direction(&ray).normalize().dot(normal);
                    let incoming = Incoming::from_light(ray);
                    let found = self.arriving(&incoming, point.z, block + 1, words);
                    cosine.max(0.0) * irradiance * found
                });
            }
            (None, Source::Sky(sky)) => {
                return sky.irradiance(point, normal, r, |ray, end| {
                    self.arriving(&Incoming::from_light(*ray), end, block + 1, words)
                });
            }
        };
        let way = point - from;
        let cosines = way.dot(facing).abs() * -way.dot(normal);
        let frame = &this.along.frame;
        let [end, begin] = [point, from].map(|p| frame.to_local(p));
        let Some((heading, ray)) = Heading::of(end, end - begin).filter(|_| cosines > 0.0) else {
            return 0.0;
        };
        let [end, begin] = [end, begin].map(|p| heading.turned(p).z);
        // What stands nearer on the same line is not the point that was drawn.
        let nearer = |leaves: &Leaves| {
            leaves
                .targets
                .last(&ray, end)
                .is_none_or(|(at, _)| at > begin + leaves.rounding)
        };
        let leaves = this.of(heading).and_then(|course| course.leaves.as_ref());
        if leaves.is_some_and(nearer) {
            return 0.0;
        }
        // cos θ cos θ' dA / r².
        let solid = cosines * area / way.length_squared().powi(2);
        let incoming = Incoming { leg, heading, ray };
        solid * self.arriving(&incoming, end, block + 1, words)
    }
}

impl Backward {
    /// The irradiance at a point behind a mirror, an interface or a lens, from one direction, drawn by the cosine.
    fn through_turn(
        &self,
        leg: usize,
        point: DVec3,
        normal: DVec3,
        r: [f64; 4],
        block: u32,
        words: &impl Fn(u32) -> [f64; 4],
    ) -> f64 {
        let towards = by_cosine([r[0], r[1]]);
        let towards = Frame::IDENTITY.turned_to(normal).vector_to_world(towards);
        LAMBERTIAN * self.along(leg, point, -towards, block + 1, words)
    }
}

impl Incoming {
    /// A ray of the light.
    fn from_light(ray: TwoPlane) -> Self {
        Self {
            leg: 0,
            heading: Heading::Along,
            ray,
        }
    }
}

/// Radiance after over before a turn at a point, light going along `along` and having come against `came`: (n'/n)² at an interface; at
/// a lens, which is no thing of optics, what keeps flux in two-plane coordinates.
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

impl Leg {
    fn new(scene: &Scene, leg: usize) -> Self {
        Self {
            courses: Both::new(scene, leg, |_, this| Course {
                frame: this.frame,
                obstacles: Obstacles::new(scene, this),
                leaves: this.leaves.map(|hit| Leaves::new(scene, this, hit.object)),
            }),
            ends: scene.path.ends_at(leg).map(|hit| hit.object),
        }
    }
}

impl Leaves {
    fn new(scene: &Scene, leg: &etendue_scene::Leg, object: Object) -> Self {
        let around = Around(leg.frame);
        let target = |form| Target { form, tag: () };
        let diffuse = |albedo, pieces| How::Diffuse { albedo, pieces };
        let (targets, how) = match object {
            Object::Surface(i) => {
                let surface = &scene.surfaces[i];
                let [a, b, _, d] = surface.corners();
                (
                    vec![target(around.surface(surface))],
                    diffuse(surface.albedo, Pieces::One([a, b, d])),
                )
            }
            Object::Mesh(i) => {
                let mesh = &scene.meshes[i];
                let how = if let Some(smooth) = &mesh.smooth {
                    let (lens, event) = (Frame::IDENTITY, smooth.event);
                    How::Turned { lens, event }
                } else {
                    let pieces = Pieces::triangles(&mesh.triangles);
                    diffuse(mesh.albedo.unwrap_or(0.0), pieces)
                };
                (vec![target(around.mesh(mesh))], how)
            }
            Object::Patch(i) => {
                let PatchObject { patch, event, .. } = &scene.patches[i];
                let patch = patch.seen_from(&leg.frame);
                let how = match event {
                    Event::Specular(event) => How::Turned {
                        lens: patch.frame,
                        event: *event,
                    },
                    Event::Reflects(reflectance) => How::Reflects {
                        patch,
                        reflectance: Box::new(reflectance.clone()),
                    },
                };
                (vec![target(Form::Smooth(Box::new(patch)))], how)
            }
        };
        Self {
            object,
            targets: Targets::new(&targets, 0.0),
            how,
            rounding: rounding(leg),
        }
    }
}

impl Source {
    /// Radiance along a ray that nothing stands in the way of; of light without extent per du dv or
    /// dx dy.
    fn radiance(&self, ray: &TwoPlane) -> f64 {
        match self {
            Self::Area { light, .. } | Self::Narrow(light) => radiance(light, ray),
            Self::Sky(sky) => sky.radiance(ray),
        }
    }
}

impl Looker {
    fn new(scene: &Scene, index: usize, plane: &VirtualPlane, light: &Source) -> Self {
        let w = &plane.window;
        let narrower = match light {
            Source::Area { shape, .. } => {
                let bounds = shape.bounds();
                let slopes = |axis: usize| bounds.size[axis] / plane.distance;
                slopes(0) * slopes(1) < 4.0 * w.u.half_width() * w.v.half_width()
            }
            Source::Sky(_) => true,
            Source::Narrow(_) => false,
        };
        Self {
            leg: plane.leg,
            stations: Both::new(scene, plane.leg, |heading, leg| {
                Station::of(heading, leg, scene, index, plane)
            }),
            position: [Follower::new(&w.x), Follower::new(&w.y)],
            slope: [Follower::new(&w.u), Follower::new(&w.v)],
            to_light: plane.leg == 0 && narrower && plane.orientation == Orientation::Orthogonal,
        }
    }

    /// The ray of the leg that the plane has as `seen`, where it is looked at, and dA over dx dy there; `None` if there is none.
    fn leg_ray(&self, seen: &TwoPlane) -> Option<(Incoming, End, f64)> {
        let headings = [Heading::Along, Heading::Against];
        headings.into_iter().find_map(|heading| {
            let station = self.stations.of(heading)?;
            let (ray, area) = station.leg_ray(seen)?;
            let end = station.crossing(&ray, f64::NEG_INFINITY)?;
            let leg = self.leg;
            let incoming = Incoming { leg, heading, ray };
            Some((incoming, End::Plane(end, station.side), area))
        })
    }
}

impl PhotonSource for Backward {
    fn emitted(&self, batch: u32) -> u64 {
        self.shares.count(batch)
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        for part in 0..self.parts(batch) {
            self.emit_part(batch, part, record, progress);
        }
        Ledger::default()
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
            for ((plane, looker), number) in self.lookers.iter().enumerate().zip(0..) {
                let looks = (start..end).map(|index| self.look(looker, number, index));
                crossings.extend(looks.filter(|crossing| crossing.weight > 0.0));
                record(plane, &crossings);
                crossings.clear();
            }
            progress(end - start);
        }
        Ledger::default()
    }
}
