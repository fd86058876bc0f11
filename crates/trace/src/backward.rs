use crate::emit::{LAMBERTIAN, point, radiance};
use crate::obstacles::Obstacles;
use crate::proposal::Follower;
use crate::shares::Shares;
use crate::tracer::turned;
use etendue_field::random::{self, Stream};
use etendue_field::{Crossing, Ledger, Light, PhotonSource, Shape, Side, TwoPlane, VirtualPlane};
use etendue_scene::{Scene, Surface};

/// The backward tracer of a scene, the independent check of [`Tracer`](crate::Tracer).
///
/// For each plane on its own, and for each photon, it draws a ray in the plane's window, follows it back, and finds the
/// radiance that comes along it. Nothing is emitted, aimed or absorbed, and there is no ledger.
#[derive(Debug)]
pub struct Backward {
    light: Area,
    obstacles: Obstacles,
    lookers: Vec<Looker>,
    /// The surface that the central ray visits; `None` if it is a mesh.
    surface: Option<Surface>,
    shares: Shares,
    seed: u64,
}

/// A light that a ray can hit.
#[derive(Clone, Copy, Debug)]
struct Area {
    light: Light,
    shape: Shape,
}

/// A backward ray has no chance to hit a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no backward ray hits a point light: it has no radiance that one could find")]
pub struct PointLight;

/// How rays of one plane are drawn.
#[derive(Clone, Copy, Debug)]
struct Looker {
    distance: f64,
    side: Side,
    reflected: bool,
    position: [Follower; 2],
    slope: [Follower; 2],
    /// Whether slopes are drawn towards points of the light: where they are the narrower choice.
    to_light: bool,
}

impl Backward {
    /// The backward tracer of a scene.
    ///
    /// # Errors
    /// When the light is a point.
    pub fn new(scene: &Scene) -> Result<Self, PointLight> {
        let Light::Area { shape, .. } = scene.light else {
            return Err(PointLight);
        };
        let visited = |s: &&Surface| scene.file.path.visits.contains(&s.name);
        Ok(Self {
            light: Area {
                light: scene.light,
                shape,
            },
            obstacles: Obstacles::new(scene),
            lookers: scene
                .planes
                .iter()
                .map(|p| Looker::new(p, &shape))
                .collect(),
            surface: scene.surfaces.iter().find(visited).cloned(),
            shares: Shares::new(&scene.run),
            seed: scene.run.seed,
        })
    }

    /// The ray of one plane with this number, and what it stands for in radiance space.
    fn look(&self, looker: &Looker, plane: u32, index: u64) -> Crossing {
        let words = |block| random::words(self.seed, Stream::Backward, index, 2 * plane + block);
        let (r, s) = (words(0).map(random::unit), words(1).map(random::unit));
        let [x, y] = [0, 1].map(|axis| looker.position[axis].quantile(r[axis]));
        let mut density = looker.position[0].density(x) * looker.position[1].density(y);
        let [u, v] = if looker.to_light {
            let [x0, y0] = point(&self.light.shape, [r[2], r[3]]);
            density *= looker.distance * looker.distance / self.light.shape.area();
            [(x - x0) / looker.distance, (y - y0) / looker.distance]
        } else {
            let slopes = [0, 1].map(|axis| looker.slope[axis].quantile(r[2 + axis]));
            density *= looker.slope[0].density(slopes[0]) * looker.slope[1].density(slopes[1]);
            slopes
        };
        let ray = TwoPlane { x, y, u, v };
        let found = if looker.reflected {
            self.exitant(&ray, looker.distance, [s[0], s[1]])
        } else {
            self.incident(&ray, looker.distance, looker.side)
        };
        let weight = if density > 0.0 { found / density } else { 0.0 };
        Crossing { ray, weight }
    }

    /// The radiance that arrives along a ray of a plane at `distance`.
    fn incident(&self, ray: &TwoPlane, distance: f64, side: Side) -> f64 {
        let at_light = ray.travelled(-distance);
        let radiance = radiance(&self.light.light, &at_light);
        if radiance > 0.0 {
            radiance * self.obstacles.visibility(&at_light, distance, side)
        } else {
            0.0
        }
    }

    /// The radiance that left the surface along a ray of a plane at `distance`: albedo/π · E, the irradiance E from
    /// one point of the light, du dv = dA / length².
    fn exitant(&self, ray: &TwoPlane, distance: f64, r: [f64; 2]) -> f64 {
        let Some(surface) = &self.surface else {
            return 0.0;
        };
        let length = surface.distance;
        // The frame in which light arrives is this one turned.
        let [x, y] = turned(&ray.travelled(length - distance));
        if !surface.rectangle.contains(x, y) {
            return 0.0;
        }
        let [x0, y0] = point(&self.light.shape, r);
        let arriving = TwoPlane {
            x,
            y,
            u: (x - x0) / length,
            v: (y - y0) / length,
        };
        let secant_squared = arriving.secant_squared();
        let cosine = 1.0 / (secant_squared * secant_squared);
        let slopes = self.light.shape.area() / (length * length);
        let irradiance = self.incident(&arriving, length, Side::Before) * cosine * slopes;
        surface.albedo / LAMBERTIAN * irradiance
    }
}

impl Looker {
    fn new(plane: &VirtualPlane, shape: &Shape) -> Self {
        let w = &plane.window;
        let bounds = shape.bounds();
        let slopes = |axis: usize| bounds.size[axis] / plane.distance;
        let narrower = slopes(0) * slopes(1) < 4.0 * w.u.half_width() * w.v.half_width();
        Self {
            distance: plane.distance,
            side: plane.side,
            reflected: plane.reflections > 0,
            position: [Follower::new(&w.x), Follower::new(&w.y)],
            slope: [Follower::new(&w.u), Follower::new(&w.v)],
            to_light: plane.reflections == 0 && narrower,
        }
    }
}

/// Rays between two reports.
const BLOCK: usize = 4096;

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
        let range = self.shares.of(batch);
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
