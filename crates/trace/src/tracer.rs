//! The forward tracer: traces photons from the light, leg by leg.

use crate::ahead::{AHEAD, Ahead, AheadPool, emit_group};
use crate::arrival::{Arrival, radiance_per_flux};
use crate::batch_ranges::{BLOCK, BatchRanges};
use crate::bounce::Bounce;
use crate::courses::{Both, rounding};
use crate::emit::Emitter;
use crate::flat_leg::FlatLeg;
use crate::heading::Heading;
use crate::lattice::Lattices;
use crate::numbers::{Numbers, PhotonNumbers};
use crate::obstacles::{HitKind, ObstacleKind, Obstacles};
use crate::photon_group::{PHOTONS_PER_GROUP, PhotonGroup};
use crate::plane_on_leg::{PlaneOnLeg, bends};
use crate::primitive_set::PrimitiveHit;
use etendue_field::{Crossing, Frame, Ledger, PhotonSource, Side, TwoPlane, VirtualPlane};
use etendue_scene::{Object, Scene};
use etendue_transform::random::Stream;
use fearless_simd::Level;
use std::ops::Range;

/// The forward tracer of a scene.
///
/// A photon leaves the light and meets a first obstacle. It crosses the virtual planes in front of
/// this obstacle. Gratings before the obstacle attenuate the photon. A blocker absorbs the photon,
/// and a Lambertian surface absorbs the share 1 − albedo of its flux. Light that the surface at the
/// end of a leg scatters, reflects or refracts crosses the virtual planes on the next leg, and
/// continues from leg to leg. If a photon meets an obstacle other than the surface at the end of
/// its leg, the photon ends.
///
/// If light arrives at the front of a surface with a BRDF, the ledger counts it as stopped, because
/// the reflected share has no closed form. The ledger leaves out light that a surface scatters
/// onwards: this light is aimed at the windows of virtual planes, so its sum is not the total of
/// the scattered light.
#[derive(Debug)]
pub struct Tracer {
    emitter: Emitter,
    /// The first leg, if photons can be traced over it many at a time.
    flat: Option<FlatLeg>,
    legs: Vec<FlightLeg>,
    planes: usize,
    shares: BatchRanges,
    numbers: PhotonNumbers,
    /// The lattices of aimed emission; `None` if nets or random numbers are used.
    lattices: Option<Lattices>,
    is_precise: bool,
    level: Level,
    /// The memory of finished parts, which later parts use again.
    ahead: AheadPool,
}

/// The largest number of photons with which spectra have reduced precision. Random photons then
/// have noise of 1.3·10⁻⁴ of the value at zero, ten times the largest error of the transform.
/// Lattices have less noise at most frequencies: with 8·10⁶ photons the error is at most 0.012
/// standard errors, with 5·10⁷ photons 0.005 (results/performance.md).
pub(crate) const MAX_REDUCED_PHOTONS: u64 = 60_000_000;

/// The smallest number of cycles of the largest frequency across the light in a window, in position
/// and in slope, with which the transform has reduced precision. The spectrum of narrower light
/// does not fall beyond the grid, and it may have no noise: all photons of a beam have the slope
/// zero.
const MIN_CYCLES: f64 = 1.25;

/// The streams of random words of photons: random numbers, nets and lattices.
const PHOTONS: [Stream; 3] = [Stream::Photon, Stream::Net, Stream::Lattice];

/// A leg of the path for photons.
#[derive(Debug)]
struct FlightLeg {
    courses: Both<Course>,
    /// The scattering at the beginning of the leg; `None` for the first leg.
    bounce: Option<Bounce>,
    /// The objects on which the leg begins and ends.
    leaves: Option<Object>,
    ends: Option<Object>,
    /// The object on which the leg begins, if light that has left the object may meet it again.
    /// Light that has left a flat surface never meets it again.
    rejoins: Option<Object>,
    /// The distance up to which a hit is attributed to rounding errors.
    rounding: f64,
}

/// The objects that photons can meet if they travel along a leg in one of the leg's two
/// directions.
#[derive(Debug)]
struct Course {
    /// The frame of the heading (the direction of light along the leg), in the frame at the
    /// light.
    frame: Frame,
    obstacles: Obstacles,
    planes_on_leg: Vec<PlaneOnLeg>,
}

/// A photon on a leg.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flight {
    pub(crate) ray: TwoPlane,
    pub(crate) heading: Heading,
    /// The distance at which the photon starts, measured along the photon's heading.
    pub(crate) from: f64,
    /// The contribution of the photon to radiance space.
    pub(crate) weight: f64,
}

/// A photon of a block, on the current leg of the block.
#[derive(Debug)]
struct Photon {
    index: u64,
    flight: Flight,
    /// Whether the flux of the photon is added to the ledger.
    counts: bool,
}

impl Photon {
    /// A photon of a group whose first photon has the number `first`.
    fn emitted(group: &PhotonGroup, i: usize, first: u64) -> Self {
        Self {
            index: first + i as u64,
            flight: Flight {
                ray: group.ray(i),
                heading: Heading::Along,
                from: 0.0,
                weight: group.weights[i],
            },
            counts: true,
        }
    }
}

impl Tracer {
    /// Builds the tracer of a scene.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        Self::with(scene, Emitter::new(scene), scene, PHOTONS)
    }

    /// Builds the tracers of two scenes with the same settings of the run. Photons of equal numbers
    /// are emitted alike, so that most of the noise cancels in the difference of their spectra.
    #[must_use]
    pub fn pair(scenes: [&Scene; 2]) -> [Self; 2] {
        let [a, b] = Emitter::pair(scenes);
        [(scenes[0], a), (scenes[1], b)]
            .map(|(scene, emitter)| Self::with(scene, emitter, scenes[0], PHOTONS))
    }

    /// The tracer of a scene, whose lattices are chosen for `lattices`.
    fn with(scene: &Scene, emitter: Emitter, lattices: &Scene, streams: [Stream; 3]) -> Self {
        // Legs beyond the last virtual plane are not traced.
        let last = scene.planes.iter().map(|plane| plane.leg).max();
        let legs = (0..=last.unwrap_or(0)).map(|leg| FlightLeg::new(scene, leg));
        let legs: Vec<FlightLeg> = legs.collect();
        Self {
            lattices: emitter.lattices(lattices),
            emitter,
            flat: legs.first().and_then(FlightLeg::flat),
            planes: scene.planes.len(),
            is_precise: is_precise(scene),
            shares: BatchRanges::new(&scene.run),
            numbers: PhotonNumbers::new(&scene.run, streams, legs.len()),
            level: Level::new(),
            legs,
            ahead: AheadPool::default(),
        }
    }

    /// Builds a second tracer of photons. It serves as a check where backward rays do not find a
    /// light without extent. The tracers of [`Self::new`] and of this function share no random
    /// numbers, and aim the emission in different ways.
    ///
    /// This tracer emits light uniformly towards the entire first surface, and towards the windows
    /// of virtual planes before this surface. Photons are traced and scattered light is aimed in
    /// the same way as by the tracer of [`Self::new`].
    #[must_use]
    pub fn with_uniform_emission(scene: &Scene) -> Self {
        let streams = [Stream::Even, Stream::EvenNet, Stream::EvenLattice];
        Self::with(scene, Emitter::with_uniform_emission(scene), scene, streams)
    }

    /// Emits the photons of a block, and traces them over the first leg if it is flat. Adds the
    /// photons that are not traced to their end to `photons`.
    #[inline]
    fn emit_block(
        &self,
        range: Range<u64>,
        numbers: &Numbers,
        ahead: &Ahead,
        photons: &mut Vec<Photon>,
        crossings: &mut [Vec<Crossing>],
        ledger: &mut Ledger,
    ) {
        for first in range.clone().step_by(PHOTONS_PER_GROUP) {
            let emitted;
            let (group, hits) = match ahead.of(first) {
                Some((group, hits)) => (group, Some(*hits)),
                None => {
                    emitted = emit_group(&self.emitter, self.level, first..range.end, numbers);
                    (&emitted, None)
                }
            };
            for flux in group.fluxes {
                ledger.emitted += flux;
            }
            let Some(flat) = &self.flat else {
                // If a point is drawn inside the bounding square of a disc but outside the disc, it
                // counts as a photon that carries no light.
                let lit = (0..PHOTONS_PER_GROUP).filter(|i| group.weights[*i] > 0.0);
                photons.extend(lit.map(|i| Photon::emitted(group, i, first)));
                continue;
            };
            let hits = hits.unwrap_or_else(|| flat.hits(group));
            let arrivals = flat.trace(group, &hits, crossings, ledger);
            if let Some(next) = self.legs.get(1) {
                let block = self.emitter.bounces_from();
                let words: [[u32; PHOTONS_PER_GROUP]; 4] =
                    numbers.columns(self.level, first, block);
                let course = &self.legs[0].courses.along;
                photons.extend(arrivals.filter_map(|(i, distance)| {
                    let arrival = group.arrival(i, distance);
                    let flight = next.begin(course, &arrival, words.map(|column| column[i]))?;
                    Some(Photon {
                        index: first + i as u64,
                        flight,
                        counts: false,
                    })
                }));
            }
        }
    }

    /// Traces a photon over a leg: finds the obstacle that the photon meets, reports the virtual
    /// planes before the obstacle, and computes the photon's start on the next leg. Returns false
    /// if the photon ends on this leg.
    #[inline]
    fn follow(
        &self,
        leg: usize,
        photon: &mut Photon,
        words: impl Fn() -> [u32; 4],
        crossings: &mut [Vec<Crossing>],
        ledger: &mut Ledger,
    ) -> bool {
        let this = &self.legs[leg];
        // Scattered light is aimed at the windows of virtual planes, so the ledger does not count
        // it.
        let mut beyond = Ledger::default();
        let account = if photon.counts { ledger } else { &mut beyond };
        let Flight {
            ray,
            heading,
            from,
            weight,
        } = photon.flight;
        let Some(course) = this.courses.of(heading) else {
            return false;
        };
        let flux = weight / radiance_per_flux(&ray);
        let met = course.obstacles.closest_hit(&ray, from);
        if met.is_some_and(|(_, target)| target.tag.is(this.leaves)) {
            account.stopped += flux;
            return false;
        }
        this.record(course, &photon.flight, met, crossings);
        let end = met.map_or(f64::INFINITY, |(distance, _)| distance);
        let arrives = flux
            * course
                .obstacles
                .transmittance(&ray, from, end, Side::Before);
        account.absorbed += flux - arrives;
        let Some((distance, target)) = met else {
            account.escaped += arrives;
            return false;
        };
        let HitKind::Surface { material, .. } = *target.tag else {
            account.absorbed += arrives;
            return false;
        };
        let next = self.legs.get(leg + 1).filter(|_| target.tag.is(this.ends));
        let arrival = || Arrival::new(&ray, distance, |point| target.normal(point), arrives);
        if let ObstacleKind::Lambertian { albedo } = material {
            account.stopped += albedo * arrives;
            account.absorbed += (1.0 - albedo) * arrives;
            photon.counts = false;
        } else if material == ObstacleKind::Reflects {
            if arrival().is_on_front() {
                account.stopped += arrives;
            } else {
                account.absorbed += arrives;
            }
            photon.counts = false;
        }
        let onwards = next.and_then(|next| next.begin(course, &arrival(), words()));
        match onwards {
            Some(flight) => photon.flight = flight,
            None if matches!(material, ObstacleKind::Specular(_)) => account.stopped += arrives,
            None => {}
        }
        onwards.is_some()
    }
}

impl FlightLeg {
    fn new(scene: &Scene, leg: usize) -> Self {
        let this = &scene.path.legs[leg];
        let planes = scene.planes.iter().enumerate();
        let planes_on_leg = planes.filter(|(_, plane)| plane.leg == leg);
        let leaves = this.leaves.map(|hit| hit.object);
        let planes_on_leg: Vec<(usize, &VirtualPlane)> = planes_on_leg.collect();
        Self {
            courses: Both::new(scene, leg, |heading, leg| Course {
                frame: leg.frame,
                obstacles: Obstacles::new(scene, leg),
                planes_on_leg: planes_on_leg
                    .iter()
                    .map(|(i, plane)| PlaneOnLeg::of(heading, leg, scene, *i, plane))
                    .collect(),
            }),
            bounce: Bounce::new(scene, leg),
            leaves,
            rejoins: leaves.filter(|object| bends(scene, *object)),
            ends: scene.path.ends_at(leg).map(|hit| hit.object),
            rounding: rounding(this),
        }
    }

    fn flat(&self) -> Option<FlatLeg> {
        let Course {
            obstacles,
            planes_on_leg,
            ..
        } = &self.courses.along;
        FlatLeg::new(obstacles.flat(self.ends)?, planes_on_leg)
    }

    /// The start on this leg of a photon that arrives at the end of the previous leg;
    /// `None` if the photon ends at the previous leg.
    #[inline(never)]
    fn begin(&self, before: &Course, arrival: &Arrival, words: [u32; 4]) -> Option<Flight> {
        let arrival = arrival.moved(&before.frame, &self.courses.along.frame);
        let (towards, weight) = self.bounce.as_ref()?.sample(&arrival, words)?;
        let (heading, ray) = Heading::of(arrival.point, towards)?;
        self.courses.of(heading)?;
        Some(Flight {
            ray,
            heading,
            from: heading.turned(arrival.point).z + self.rounding,
            weight,
        })
    }

    /// Reports the virtual planes that a photon crosses before it meets an obstacle.
    #[inline]
    fn record(
        &self,
        course: &Course,
        flight: &Flight,
        met: Option<(f64, PrimitiveHit<'_, HitKind>)>,
        crossings: &mut [Vec<Crossing>],
    ) {
        let Flight {
            ray, from, weight, ..
        } = *flight;
        let Course {
            obstacles,
            planes_on_leg,
            ..
        } = course;
        // If light has left an object and would meet the same object again, the light is lost, even
        // if a blocker stops it first. Otherwise a blocker beyond a virtual plane would add light
        // at the plane.
        let stopped = self.rejoins.is_some() && met.is_some();
        if stopped && obstacles.meets(self.rejoins, &ray, from) {
            return;
        }
        let end = met.map_or(f64::INFINITY, |(distance, _)| distance);
        let on_path = met.is_some_and(|(_, target)| target.tag.is(self.ends));
        for plane_on_leg in planes_on_leg {
            let side = plane_on_leg.side;
            let arrival = on_path.then_some(end);
            let Some(distance) = plane_on_leg.crossing_of_photon(&ray, from, arrival) else {
                continue;
            };
            // A virtual plane beside an object is at exactly the same distance as the object, so
            // rounding errors cannot separate the plane from the object.
            let crossed = match side {
                Side::Before => distance <= end,
                Side::After => distance < end,
            };
            // A plane records the light that a surface receives. If the surface that receives the
            // light is curved or oblique, part of the surface may lie before the virtual plane.
            let ends = |what: &HitKind| what.is(self.ends);
            let crossed =
                crossed || on_path && obstacles.visibility(&ray, from, distance, side, ends) > 0.0;
            if crossed
                && let Some((ray, weight)) = plane_on_leg.at_plane(&ray, weight)
                && (self.leaves.is_some() || plane_on_leg.is_ahead([ray.x, ray.y]))
            {
                let passes = obstacles.transmittance(&flight.ray, from, distance, side);
                crossings[plane_on_leg.plane].push(Crossing {
                    ray,
                    weight: weight * passes,
                });
            }
        }
    }
}

/// Checks whether spectra of a scene need the full precision of the transform.
fn is_precise(scene: &Scene) -> bool {
    let is_narrow = |VirtualPlane { window, grid, .. }: &VirtualPlane| {
        let profiles = [[&window.x, &window.u], [&window.y, &window.v]];
        (0..2).zip(profiles).any(|(axis, profiles)| {
            let [x, u] = profiles.map(|profile| profile.half_width());
            let [low, high] = scene.light.extent(axis);
            let width = (high - low).min(2.0 * x);
            let slopes = 2.0 * scene.light.steepest(axis).min(u);
            width * grid.rho.max() < MIN_CYCLES || slopes * grid.nu.max() < MIN_CYCLES
        })
    };
    scene.run.photons > MAX_REDUCED_PHOTONS || scene.planes.iter().any(is_narrow)
}

impl PhotonSource for Tracer {
    fn emitted(&self, batch: u32) -> u64 {
        self.shares.count(batch)
    }

    fn is_precise(&self) -> bool {
        self.is_precise
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
        let mut photons = Vec::with_capacity(BLOCK);
        let mut crossings = vec![Vec::with_capacity(BLOCK); self.planes];
        let mut total = Ledger::default();
        let all = self.shares.of(batch);
        let numbers = |at| self.numbers.of(batch, &all, at, self.lattices.as_ref());
        let range = self.shares.part(batch, part);
        let mut ahead = self.ahead.take();
        for start in range.clone().step_by(BLOCK) {
            let end = range.end.min(start + BLOCK as u64);
            let mut block = Ledger::default();
            if (start - range.start).is_multiple_of(AHEAD as u64) {
                let until = range.end.min(start + AHEAD as u64);
                let flat = self.flat.as_ref();
                ahead.refill(&self.emitter, flat, start..until, numbers);
            }
            let numbers = numbers(start);
            self.emit_block(
                start..end,
                &numbers,
                &ahead,
                &mut photons,
                &mut crossings,
                &mut block,
            );
            let legs = (0..self.legs.len()).zip(self.emitter.bounces_from()..);
            for (leg, bounce) in legs.skip(usize::from(self.flat.is_some())) {
                photons.retain_mut(|photon| {
                    let index = photon.index;
                    let words = || numbers.words(index, bounce);
                    self.follow(leg, photon, words, &mut crossings, &mut block)
                });
            }
            photons.clear();
            for (plane, crossings) in crossings.iter_mut().enumerate() {
                record(plane, crossings);
                crossings.clear();
            }
            // Each block of photons has its own sum of fluxes, so rounding errors grow with the
            // number of blocks instead of the number of photons.
            total.add(&block);
            progress(end - start);
        }
        self.ahead.keep(ahead);
        total
    }
}

#[cfg(test)]
mod tests;
