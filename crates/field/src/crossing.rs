//! Photons that cross virtual planes, and the ledger of their flux.

use crate::TwoPlane;
use serde::Serialize;

/// The crossing of one virtual plane by one photon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The ray of the photon, in the frame of the plane.
    pub ray: TwoPlane,
    /// The contribution to radiance space: Φ (1 + u² + v²)², where Φ is the photon's flux times the
    /// number of emitted photons. The window is not applied. The mean of `weight` · W over emitted
    /// photons estimates ∫ L W.
    pub weight: f64,
}

/// The ledger of the emitted flux. Each entry is a sum over photons, in W times the number of
/// emitted photons.
///
/// Flux is conserved up to rounding errors: emitted = absorbed + escaped + stopped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Ledger {
    /// Flux that left the light.
    pub emitted: f64,
    /// Flux absorbed by blockers and surfaces.
    pub absorbed: f64,
    /// Flux that left the scene without meeting anything.
    pub escaped: f64,
    /// Flux reflected where the central ray ends; the photon is not traced further.
    pub stopped: f64,
}

impl Ledger {
    /// Adds another ledger.
    pub fn add(&mut self, other: &Self) {
        self.emitted += other.emitted;
        self.absorbed += other.absorbed;
        self.escaped += other.escaped;
        self.stopped += other.stopped;
    }

    /// The ledger times a number.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            emitted: factor * self.emitted,
            absorbed: factor * self.absorbed,
            escaped: factor * self.escaped,
            stopped: factor * self.stopped,
        }
    }

    /// Returns (emitted − absorbed − escaped − stopped) / emitted; zero if nothing was emitted.
    #[must_use]
    pub fn imbalance(&self) -> f64 {
        if self.emitted == 0.0 {
            return 0.0;
        }
        (self.emitted - self.absorbed - self.escaped - self.stopped) / self.emitted
    }
}

/// The number of photons that crossed a plane. `crossed` is the sum of `inside` and `outside`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PlaneTally {
    /// Photons that crossed the plane on the plane's leg of the path.
    pub crossed: u64,
    /// Crossings inside the window.
    pub inside: u64,
    /// Crossings outside the window. They are counted here, and they are never wrapped into the
    /// window.
    pub outside: u64,
}

impl PlaneTally {
    /// Adds another tally.
    pub fn add(&mut self, other: &Self) {
        self.crossed += other.crossed;
        self.inside += other.inside;
        self.outside += other.outside;
    }
}

/// A source of photons that cross the virtual planes of a scene. Photons are emitted batch by
/// batch.
///
/// A batch depends on its number alone, not on the thread or the order of requests.
///
/// A source implements [`Self::emit`], or [`Self::emit_part`] and [`Self::parts`] if it divides
/// batches.
pub trait PhotonSource: Sync {
    /// The number of photons emitted in `batch`, including those that end with zero weight.
    fn emitted(&self, batch: u32) -> u64;

    /// Whether spectra need the full precision of the transform of rays. If not, the error
    /// may be 2·10⁻⁵ of the sum of weights (typically 10⁻⁷), and weights must not be negative. A
    /// source that wraps another one should return the answer of the other one.
    fn is_precise(&self) -> bool {
        true
    }

    /// Emits the photons of `batch`. Each call of `record` receives the index of a plane and a
    /// block of crossings of this plane. The order of the calls and of the crossings is always the
    /// same. `progress` receives the number of photons of each block.
    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let mut total = Ledger::default();
        for part in 0..self.parts(batch) {
            total.add(&self.emit_part(batch, part, record, progress));
        }
        total
    }

    /// The number of parts into which a batch is divided, so that several threads can emit
    /// one batch. The number is at least one and depends only on the scene.
    fn parts(&self, _batch: u32) -> u32 {
        1
    }

    /// Emits one part of a batch; [`Self::emit`] emits all parts in order.
    fn emit_part(
        &self,
        batch: u32,
        _part: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        self.emit(batch, record, progress)
    }
}
