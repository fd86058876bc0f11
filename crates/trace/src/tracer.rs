use crate::emit::{Emitter, LAMBERTIAN};
use crate::obstacles::{Meeting, Obstacles};
use crate::scatter::Scatterer;
use crate::shares::Shares;
use etendue_field::random::{self, Stream};
use etendue_field::{Crossing, Ledger, PhotonSource, Side, TwoPlane};
use etendue_scene::Scene;

/// The forward tracer of a scene.
///
/// A photon leaves the light and crosses the planes in front of what it meets first; gratings on the way take
/// their share of it. Blockers absorb it, a surface absorbs 1 − albedo of it. What the surface on the central ray reflects
/// crosses the planes after it, and is stopped: the path ends.
#[derive(Debug)]
pub struct Tracer {
    emitter: Emitter,
    obstacles: Obstacles,
    /// `None` when no plane looks at reflected light.
    scatterer: Option<Scatterer>,
    planes: Vec<Station>,
    /// Distance of the surface that the central ray visits.
    length: f64,
    shares: Shares,
    seed: u64,
}

/// Where a plane stands.
#[derive(Clone, Copy, Debug)]
struct Station {
    distance: f64,
    side: Side,
    reflected: bool,
}

/// Photons traced between two reports.
const BLOCK: usize = 4096;

impl Tracer {
    /// The tracer of a scene.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let planes = scene.planes.iter().map(|plane| Station {
            distance: plane.distance,
            side: plane.side,
            reflected: plane.reflections > 0,
        });
        Self {
            emitter: Emitter::new(scene),
            obstacles: Obstacles::new(scene),
            scatterer: Scatterer::new(scene),
            planes: planes.collect(),
            length: scene.path.length,
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
        let secant_squared = ray.secant_squared();
        let flux = weight / (secant_squared * secant_squared);
        let met = self.obstacles.first(&ray);

        let end = met.map_or(f64::INFINITY, |(distance, _)| distance);
        for (plane, crossings) in self.planes.iter().zip(crossings.iter_mut()) {
            let &Station { distance, side, .. } = plane;
            // A plane beside something is at the very same distance: no rounding can come between.
            let crossed = match side {
                Side::Before => distance <= end,
                Side::After => distance < end,
            };
            if crossed && !plane.reflected {
                crossings.push(Crossing {
                    ray: ray.travelled(distance),
                    weight: weight * self.obstacles.transmittance(&ray, distance, side),
                });
            }
        }

        ledger.emitted += flux;
        let arrives = flux * self.obstacles.transmittance(&ray, end, Side::Before);
        ledger.absorbed += flux - arrives;
        match met {
            None => ledger.escaped += arrives,
            Some((_, Meeting::Blocker)) => ledger.absorbed += arrives,
            Some((_, Meeting::Surface { albedo, visited })) => {
                ledger.stopped += albedo * arrives;
                ledger.absorbed += (1.0 - albedo) * arrives;
                let reflects = visited && albedo > 0.0;
                if let (Some(scatterer), true) = (&self.scatterer, reflects) {
                    let at = ray.travelled(self.length);
                    let sampled = scatterer.sample(turned(&at), words(2));
                    if let Some((ray, density)) = sampled {
                        // Radiance albedo/π · E, and a photon's flux is E at its point.
                        let weight = albedo * arrives / (LAMBERTIAN * density);
                        self.reflected(&ray, weight, crossings);
                    }
                }
            }
        }
    }

    /// Crossings of light that leaves the surface on the central ray; nothing stands in its way there.
    fn reflected(&self, ray: &TwoPlane, weight: f64, crossings: &mut [Vec<Crossing>]) {
        for (plane, crossings) in self.planes.iter().zip(crossings) {
            if plane.reflected {
                crossings.push(Crossing {
                    ray: ray.travelled(plane.distance - self.length),
                    weight,
                });
            }
        }
    }
}

/// A point of the surface in the frame in which light leaves it, (−X, Y, −D).
pub(crate) fn turned(at: &TwoPlane) -> [f64; 2] {
    [-at.x, at.y]
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
        let mut crossings = vec![Vec::with_capacity(BLOCK); self.planes.len()];
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
