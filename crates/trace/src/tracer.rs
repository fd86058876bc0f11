use crate::bvh::{Target, Targets};
use crate::emit::Emitter;
use etendue_field::random::{self, Stream};
use etendue_field::{Crossing, Ledger, PhotonSource, Side};
use etendue_scene::Scene;
use std::fmt;
use std::ops::Range;

/// The forward tracer of a scene.
///
/// A photon leaves the light, crosses the planes in front of what it meets first, and ends there: blockers
/// absorb it, a surface absorbs 1 − albedo of it and the rest is stopped, since the path ends.
pub struct Tracer {
    emitter: Emitter,
    targets: Targets<Meeting>,
    /// Distance and side of each plane.
    planes: Vec<(f64, Side)>,
    photons: u64,
    batches: u32,
    seed: u64,
}

impl fmt::Debug for Tracer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Tracer")
            .field("emitter", &self.emitter)
            .field("photons", &self.photons)
            .field("batches", &self.batches)
            .field("seed", &self.seed)
            .finish_non_exhaustive()
    }
}

/// What a photon meets.
#[derive(Clone, Copy, Debug)]
enum Meeting {
    Blocker,
    Surface { albedo: f64 },
}

/// Photons traced between two reports.
const BLOCK: usize = 4096;

impl Tracer {
    /// The tracer of a scene.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let blockers = scene.blockers.iter().flat_map(|layer| {
            layer.rectangles.iter().map(|&rectangle| Target {
                distance: layer.distance,
                rectangle,
                tag: Meeting::Blocker,
            })
        });
        let surfaces = scene.surfaces.iter().map(|surface| Target {
            distance: surface.distance,
            rectangle: surface.rectangle,
            tag: Meeting::Surface {
                albedo: surface.albedo,
            },
        });
        let targets: Vec<_> = blockers.chain(surfaces).collect();
        let planes = scene
            .planes
            .iter()
            .map(|plane| (plane.distance, plane.side));
        Self {
            emitter: Emitter::new(scene),
            targets: Targets::new(&targets, scene.light.rectangle.reach()),
            planes: planes.collect(),
            photons: scene.run.photons,
            batches: scene.run.batches,
            seed: scene.run.seed,
        }
    }

    /// The photons of a batch: batches share them out evenly, in order.
    fn range(&self, batch: u32) -> Range<u64> {
        let start = |b: u32| {
            let share = u128::from(self.photons) * u128::from(b) / u128::from(self.batches);
            u64::try_from(share).unwrap_or(u64::MAX)
        };
        start(batch)..start(batch + 1)
    }

    /// The life of one photon.
    #[inline]
    fn photon(&self, index: u64, crossings: &mut [Vec<Crossing>], ledger: &mut Ledger) {
        let words = [0, 1].map(|block| random::words(self.seed, Stream::Photon, index, block));
        let ray = self.emitter.sample(words);
        let weight = self.emitter.weight(&ray);
        let secant_squared = ray.secant_squared();
        let flux = weight / (secant_squared * secant_squared);
        let met = self.targets.first(&ray);

        let end = met.map_or(f64::INFINITY, |target| target.distance);
        for (&(distance, side), crossings) in self.planes.iter().zip(crossings) {
            // A plane beside something is at the very same distance: no rounding can come between.
            let crossed = match side {
                Side::Before => distance <= end,
                Side::After => distance < end,
            };
            if crossed {
                crossings.push(Crossing {
                    ray: ray.travelled(distance),
                    weight,
                });
            }
        }

        ledger.emitted += flux;
        match met.map(|target| target.tag) {
            None => ledger.escaped += flux,
            Some(Meeting::Blocker) => ledger.absorbed += flux,
            Some(Meeting::Surface { albedo }) => {
                ledger.stopped += albedo * flux;
                ledger.absorbed += (1.0 - albedo) * flux;
            }
        }
    }
}

impl PhotonSource for Tracer {
    fn emitted(&self, batch: u32) -> u64 {
        let range = self.range(batch);
        range.end - range.start
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let mut crossings = vec![Vec::with_capacity(BLOCK); self.planes.len()];
        let mut total = Ledger::default();
        let range = self.range(batch);
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
