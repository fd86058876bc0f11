mod connected;
mod end;
mod reflected;

use crate::bounce::at;
use crate::emit::{LAMBERTIAN, by_cosine, point, radiance};
use crate::form::Form;
use crate::obstacles::{Around, Obstacles, direction, ray_through, start};
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
    /// In the frame at the light.
    frame: Frame,
    obstacles: Obstacles,
    /// The surface at its beginning; `None` for the first.
    leaves: Option<Leaves>,
    /// What it ends on.
    ends: Option<Object>,
}

/// The surface that light leaves at the beginning of a leg.
#[derive(Debug)]
struct Leaves {
    object: Object,
    /// In the frame of the leg.
    targets: Targets<()>,
    how: How,
    rounding: f64,
}

/// How light leaves a surface.
#[derive(Debug)]
enum How {
    /// Diffusely, from pieces of which points can be drawn.
    Diffuse { albedo: f64, pieces: Pieces },
    /// By a BRDF that may vary over a patch, in the frame of the leg.
    Reflects {
        patch: Patch,
        reflectance: Box<Reflectance>,
    },
    /// Turned; the lens's frame, in the frame of the leg.
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
#[derive(Clone, Copy, Debug)]
struct Looker {
    leg: usize,
    station: Station,
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
        let lookers = planes.map(|(i, p)| Looker::new(Station::new(scene, i, p), p, &light));
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
                density *= looker.station.distance * looker.station.distance / shape.area();
                [
                    (x - x0) / looker.station.distance,
                    (y - y0) / looker.station.distance,
                ]
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
        let is_ahead = looker.leg > 0 || looker.station.is_ahead([x, y]);
        let on_leg = looker.station.leg_ray(&ray);
        let on_leg = on_leg.filter(|_| density > 0.0 && is_ahead);
        let Some((on_leg, area)) = on_leg else {
            return Crossing { ray, weight: 0.0 };
        };
        let found = self.incident(looker.leg, &on_leg, End::of(&looker.station), 1, &words);
        Crossing {
            ray,
            weight: area * found / density,
        }
    }

    /// The radiance that arrives at the end of a ray of a leg, given where the leg begins; `block` numbers the random
    /// numbers of the next surface on its way back.
    fn incident(
        &self,
        leg: usize,
        ray: &TwoPlane,
        end: End,
        block: u32,
        words: &impl Fn(u32) -> [f64; 4],
    ) -> f64 {
        let this = &self.legs[leg];
        let (distance, side) = end.at();
        let Some(leaves) = &this.leaves else {
            let radiance = self.light.radiance(ray);
            if radiance <= 0.0 {
                return 0.0;
            }
            let visible = this
                .obstacles
                .visibility(ray, 0.0, distance, side, |what| what.is(this.ends));
            return radiance * visible;
        };
        let Some((begin, target)) = leaves.targets.last(ray, end.of_line()) else {
            return 0.0;
        };
        let from = begin + leaves.rounding;
        let ignored = |object| Some(object) == this.ends || object == leaves.object;
        let visible = this
            .obstacles
            .visibility(ray, from, distance, side, |what| {
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
                let normal = this
                    .frame
                    .vector_to_world(normal.dot(along).signum() * normal);
                let point = this.frame.to_world(point);
                visible * albedo / LAMBERTIAN
                    * self.irradiance(leg - 1, point, normal, block, words)
            }
            How::Reflects { patch, reflectance } => {
                let facing = target.normal(point);
                if along.dot(facing) <= 0.0 {
                    return 0.0;
                }
                let frame = Frame::IDENTITY.turned_to(this.frame.vector_to_world(facing));
                let to = frame.vector_to_local(this.frame.vector_to_world(along));
                let brdf = at(patch, reflectance, point);
                if brdf.albedo() <= 0.0 {
                    return 0.0;
                }
                let reflection = Reflection {
                    brdf,
                    point: this.frame.to_world(point),
                    frame,
                    to: to.normalize(),
                };
                visible * self.reflected(leg - 1, &reflection, block, words)
            }
            How::Turned { lens, event } => {
                let facing = target.normal(point);
                let Some(came) = event.turned(lens, facing, point, -along) else {
                    return 0.0;
                };
                let to_front = along.dot(facing) > 0.0;
                let factor = radiance_factor(lens, *event, to_front, along, came);
                let before = self.legs[leg - 1].frame.decompose(&this.frame);
                let end = before.to_world(point);
                let Some(ray) = ray_through(end, before.vector_to_world(-came)) else {
                    return 0.0;
                };
                visible * factor * self.arriving(leg - 1, &ray, end.z, block, words)
            }
        }
    }

    /// The radiance that arrives along a ray at a point, `end` along the leg, of the surface that ends it: of a hollow or a bulky one, another part
    /// may stand in the way.
    fn arriving(
        &self,
        leg: usize,
        ray: &TwoPlane,
        end: f64,
        block: u32,
        words: &impl Fn(u32) -> [f64; 4],
    ) -> f64 {
        // Light begins in the plane across the central ray at its centre.
        if leg == 0 && end <= 0.0 {
            return 0.0;
        }
        let this = &self.legs[leg];
        if !matches!(this.ends, Some(Object::Surface(_))) {
            let leaves = this.leaves.as_ref();
            let from = leaves.map_or(0.0, |leaves| {
                let left = leaves.targets.last(ray, end);
                left.map_or(0.0, |(at, _)| at + leaves.rounding)
            });
            if this.obstacles.is_behind(this.ends, ray, from, end) {
                return 0.0;
            }
        }
        self.incident(leg, ray, End::Surface(end), block, words)
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
        let pieces = match &self.legs[leg].leaves {
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
                    let found = self.arriving(leg, &ray, point.z, block + 1, words);
                    cosine.max(0.0) * irradiance * found
                });
            }
            (None, Source::Sky(sky)) => {
                return sky.irradiance(point, normal, r, |ray, end| {
                    self.arriving(leg, ray, end, block + 1, words)
                });
            }
        };
        let this = &self.legs[leg];
        let [end, begin] = [point, from].map(|p| this.frame.to_local(p));
        let way = end - begin;
        let cosines = way.dot(this.frame.vector_to_local(facing)).abs()
            * -way.dot(this.frame.vector_to_local(normal));
        let Some(ray) = ray_through(end, way).filter(|_| cosines > 0.0) else {
            return 0.0;
        };
        // What stands nearer on the same line is not the point that was drawn.
        let nearer = |leaves: &Leaves| {
            leaves
                .targets
                .last(&ray, end.z)
                .is_none_or(|(at, _)| at > begin.z + leaves.rounding)
        };
        if this.leaves.as_ref().is_some_and(nearer) {
            return 0.0;
        }
        // cos θ cos θ' dA / r².
        let solid = cosines * area / way.length_squared().powi(2);
        solid * self.arriving(leg, &ray, end.z, block + 1, words)
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
        let this = &self.legs[leg].frame;
        let end = this.to_local(point);
        let Some(ray) = ray_through(end, this.vector_to_local(-towards)) else {
            return 0.0;
        };
        LAMBERTIAN * self.arriving(leg, &ray, end.z, block + 1, words)
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
        let this = &scene.path.legs[leg];
        let ends = scene.path.ends_at(leg).map(|hit| hit.object);
        Self {
            frame: this.frame,
            obstacles: Obstacles::new(scene, this),
            leaves: this.leaves.map(|hit| Leaves::new(scene, this, hit.object)),
            ends,
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
    fn new(station: Station, plane: &VirtualPlane, light: &Source) -> Self {
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
            station,
            position: [Follower::new(&w.x), Follower::new(&w.y)],
            slope: [Follower::new(&w.u), Follower::new(&w.v)],
            to_light: plane.leg == 0 && narrower && plane.orientation == Orientation::Orthogonal,
        }
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
