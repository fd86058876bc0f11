use crate::bvh::Target;
use crate::emit::{Emitter, LAMBERTIAN};
use crate::obstacles::{Meeting, Obstacles, direction, start};
use crate::scatter::Scatterer;
use crate::shares::Shares;
use etendue_field::random::{self, Stream};
use etendue_field::{Crossing, Frame, Ledger, PhotonSource, Side, TwoPlane};
use etendue_scene::{Object, Scene};
use glam::DVec3;

/// The forward tracer of a scene.
///
/// A photon leaves the light and crosses the planes in front of what it meets first; gratings on the way take
/// their share of it. Blockers absorb it, a surface absorbs 1 − albedo of it. What the surface at the end of a leg reflects
/// crosses the planes on the next one, and so on; anything else it meets ends it.
#[derive(Debug)]
pub struct Tracer {
    emitter: Emitter,
    legs: Vec<Leg>,
    planes: usize,
    shares: Shares,
    seed: u64,
}

/// A leg of the path, as photons see it.
#[derive(Debug)]
struct Leg {
    /// In the frame at the light.
    frame: Frame,
    obstacles: Obstacles,
    stations: Vec<Station>,
    /// How light begins the leg; `None` for the first.
    scatterer: Option<Scatterer>,
    /// What the leg begins and ends on.
    leaves: Option<Object>,
    ends: Option<Object>,
    /// Distances that are zero but for rounding.
    rounding: f64,
}

/// Where a plane stands on its leg.
#[derive(Clone, Copy, Debug)]
struct Station {
    plane: usize,
    distance: f64,
    side: Side,
}

/// Photons traced between two reports.
const BLOCK: usize = 4096;

impl Tracer {
    /// The tracer of a scene.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        // Legs beyond the last plane are of no interest.
        let last = scene.planes.iter().map(|plane| plane.leg).max();
        let legs = (0..=last.unwrap_or(0)).map(|leg| Leg::new(scene, leg));
        Self {
            emitter: Emitter::new(scene),
            legs: legs.collect(),
            planes: scene.planes.len(),
            shares: Shares::new(&scene.run),
            seed: scene.run.seed,
        }
    }

    /// The life of one photon.
    #[inline]
    fn photon(&self, index: u64, crossings: &mut [Vec<Crossing>], ledger: &mut Ledger) {
        let words = |block| random::words(self.seed, Stream::Photon, index, block);
        let ray = self.emitter.sample([words(0), words(1)]);
        let weight = self.emitter.weight(&ray);
        // Drawn in the bounds of a disc, but beside it: it is counted, and carries nothing anywhere.
        if weight <= 0.0 {
            return;
        }
        let flux = weight / cosines(&ray);
        let first = &self.legs[0];
        let met = first.obstacles.first(&ray, 0.0);
        first.record(&ray, 0.0, weight, met, crossings);

        ledger.emitted += flux;
        let end = met.map_or(f64::INFINITY, |(distance, _)| distance);
        let arrives = flux * first.obstacles.transmittance(&ray, 0.0, end, Side::Before);
        ledger.absorbed += flux - arrives;
        match met {
            None => ledger.escaped += arrives,
            Some((distance, target)) => match target.tag {
                Meeting::Blocker => ledger.absorbed += arrives,
                Meeting::Surface { albedo, .. } => {
                    ledger.stopped += albedo * arrives;
                    ledger.absorbed += (1.0 - albedo) * arrives;
                    let arrival = Arrival {
                        ray,
                        distance,
                        target,
                        flux: arrives,
                    };
                    self.onwards(arrival, words, crossings);
                }
            },
        }
    }

    /// The later legs of a photon that meets something on the first.
    fn onwards<'a>(
        &'a self,
        mut arrival: Arrival<'a>,
        words: impl Fn(u32) -> [u32; 4],
        crossings: &mut [Vec<Crossing>],
    ) {
        for (legs, block) in self.legs.windows(2).zip(2..) {
            let [this, next] = legs else { return };
            let Meeting::Surface { albedo, .. } = arrival.target.tag else {
                return;
            };
            let Some(scatterer) = &next.scatterer else {
                return;
            };
            if albedo <= 0.0 || !arrival.target.tag.is(this.ends) {
                return;
            }
            let (point, normal) = next.hit(this, &arrival);
            let Some((ray, density)) = scatterer.sample(point, normal, words(block)) else {
                return;
            };
            // Radiance albedo/π · E, and a photon's flux is E at its point.
            let weight = albedo * arrival.flux / (LAMBERTIAN * density);
            let from = point.z + next.rounding;
            let met = next.obstacles.first(&ray, from);
            if met.is_some_and(|(_, target)| target.tag.is(next.leaves)) {
                return;
            }
            next.record(&ray, from, weight, met, crossings);
            let Some((distance, target)) = met else {
                return;
            };
            let passes = next
                .obstacles
                .transmittance(&ray, from, distance, Side::Before);
            let flux = weight / cosines(&ray) * passes;
            arrival = Arrival {
                ray,
                distance,
                target,
                flux,
            };
        }
    }
}

/// A photon at the end of a leg.
struct Arrival<'a> {
    ray: TwoPlane,
    distance: f64,
    target: &'a Target<Meeting>,
    flux: f64,
}

/// (1 + u² + v²)² = 1/cos⁴θ: radiance space over flux.
fn cosines(ray: &TwoPlane) -> f64 {
    let secant_squared = ray.secant_squared();
    secant_squared * secant_squared
}

impl Leg {
    fn new(scene: &Scene, leg: usize) -> Self {
        let this = &scene.path.legs[leg];
        let planes = scene.planes.iter().enumerate();
        let stations = planes.filter(|(_, p)| p.leg == leg).map(|(i, p)| Station {
            plane: i,
            distance: scene.path.along(p),
            side: p.side,
        });
        Self {
            frame: this.frame,
            obstacles: Obstacles::new(scene, this),
            stations: stations.collect(),
            scatterer: Scatterer::new(scene, leg),
            leaves: this.leaves.map(|hit| hit.object),
            ends: scene.path.ends_at(leg).map(|hit| hit.object),
            rounding: rounding(this),
        }
    }

    /// Where a photon that arrives on the leg before begins this one, and the normal there on the side it came from.
    fn hit(&self, before: &Self, arrival: &Arrival<'_>) -> (DVec3, DVec3) {
        let (from, along) = (start(&arrival.ray), direction(&arrival.ray));
        let normal = arrival.target.form.normal();
        let normal = -normal.dot(along).signum() * normal;
        let point = before.frame.to_world(from + arrival.distance * along);
        let normal = before.frame.vector_to_world(normal);
        (
            self.frame.to_local(point),
            self.frame.vector_to_local(normal),
        )
    }

    /// The planes a photon crosses before what it meets.
    #[inline]
    fn record(
        &self,
        ray: &TwoPlane,
        from: f64,
        weight: f64,
        met: Option<(f64, &Target<Meeting>)>,
        crossings: &mut [Vec<Crossing>],
    ) {
        let end = met.map_or(f64::INFINITY, |(distance, _)| distance);
        let on_path = met.is_some_and(|(_, target)| target.tag.is(self.ends));
        for &Station {
            plane,
            distance,
            side,
        } in &self.stations
        {
            // A plane beside something is at the very same distance: no rounding can come between.
            let crossed = match side {
                Side::Before => distance <= end,
                Side::After => distance < end,
            };
            // A surface that is not flat, or not across the leg, begins before the plane that looks at what it receives.
            let crossed = crossed
                || on_path
                    && self
                        .obstacles
                        .visibility(ray, from, distance, side, |what| what.is(self.ends))
                        > 0.0;
            if crossed {
                crossings[plane].push(Crossing {
                    ray: ray.travelled(distance),
                    weight: weight * self.obstacles.transmittance(ray, from, distance, side),
                });
            }
        }
    }
}

/// How far a leg's beginning is left behind before something can be met.
pub(crate) fn rounding(leg: &etendue_scene::Leg) -> f64 {
    const SHARE: f64 = 1e-9;
    match leg.leaves {
        None => 0.0,
        Some(hit) => SHARE * (hit.point.length() + leg.start),
    }
}

impl PhotonSource for Tracer {
    fn emitted(&self, batch: u32) -> u64 {
        self.shares.count(batch)
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let mut crossings = vec![Vec::with_capacity(BLOCK); self.planes];
        let mut total = Ledger::default();
        let range = self.shares.of(batch);
        for start in range.clone().step_by(BLOCK) {
            let end = range.end.min(start + BLOCK as u64);
            let mut block = Ledger::default();
            for index in start..end {
                self.photon(index, &mut crossings, &mut block);
            }
            for (plane, crossings) in crossings.iter_mut().enumerate() {
                record(plane, crossings);
                crossings.clear();
            }
            // Sums of sums: rounding grows with the number of blocks, not of photons.
            total.add(&block);
            progress(end - start);
        }
        total
    }
}
