//! Photons that cross virtual planes, and the account of their flux.

use crate::TwoPlane;
use serde::Serialize;

/// One photon crossing one virtual plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Where and how it crosses, in the frame of the plane.
    pub ray: TwoPlane,
    /// What it adds to radiance space: Φ (1 + u² + v²)², Φ being its flux times the number of emitted
    /// photons. The window is not applied. The mean of `weight` · W over emitted photons estimates ∫ L W.
    pub weight: f64,
}

/// What became of the emitted flux; sums over photons, in W times the number of emitted photons.
///
/// emitted = absorbed + escaped + stopped, to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Ledger {
    /// Flux that left the light.
    pub emitted: f64,
    /// Flux absorbed by blockers and surfaces.
    pub absorbed: f64,
    /// Flux that met nothing.
    pub escaped: f64,
    /// Flux reflected where the central ray ends: the scene asks no more of it.
    pub stopped: f64,
}

impl Ledger {
    /// Adds another account.
    pub fn add(&mut self, other: &Self) {
        self.emitted += other.emitted;
        self.absorbed += other.absorbed;
        self.escaped += other.escaped;
        self.stopped += other.stopped;
    }

    /// The account times a number.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            emitted: factor * self.emitted,
            absorbed: factor * self.absorbed,
            escaped: factor * self.escaped,
            stopped: factor * self.stopped,
        }
    }

    /// (emitted − absorbed − escaped − stopped) / emitted; zero when nothing was emitted.
    #[must_use]
    pub fn imbalance(&self) -> f64 {
        if self.emitted == 0.0 {
            return 0.0;
        }
        (self.emitted - self.absorbed - self.escaped - self.stopped) / self.emitted
    }
}

/// Photons that crossed a plane: crossed = inside + outside of its window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PlaneTally {
    /// Photons that crossed the plane on the path it stands on.
    pub crossed: u64,
    /// Those inside the window.
    pub inside: u64,
    /// Those outside it: counted, never wrapped.
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

/// Something that makes photons cross the virtual planes of a scene, batch by batch.
///
/// A batch is a function of its number alone, whichever thread asks for it and in whatever order.
pub trait PhotonSource: Sync {
    /// Photons emitted in `batch`, those that end with zero weight included.
    fn emitted(&self, batch: u32) -> u64;

    /// Emits the photons of `batch`. `record` is handed the index of a plane and crossings of it, a block at
    /// a time, in an order that is always the same; `progress` is told how many photons a block took.
    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger;

    /// How many parts of a batch may be emitted one by one, by several threads; at least one, and a
    /// function of the scene alone.
    fn parts(&self, _batch: u32) -> u32 {
        1
    }

    /// Emits one part of a batch, as [`Self::emit`] does all of them in order.
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
