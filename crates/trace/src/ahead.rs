//! Photons that are emitted before their block, so that many photons are tested against the meshes
//! of a flat leg together.

use crate::batch_ranges::BLOCK;
use crate::emit::Emitter;
use crate::flat_leg::FlatLeg;
use crate::mesh_order::OrderMemory;
use crate::numbers::Numbers;
use crate::photon_group::{Hits, PHOTONS_PER_GROUP, PhotonGroup};
use fearless_simd::{Level, dispatch};
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Photons of several blocks that were emitted together, and the obstacles that they meet.
#[derive(Debug, Default)]
pub(crate) struct Ahead {
    /// The number of the first photon.
    first: u64,
    groups: Vec<PhotonGroup>,
    hits: Vec<Hits>,
    order: OrderMemory,
}

/// Memory that finished parts leave for later parts.
#[derive(Debug, Default)]
pub(crate) struct AheadPool(Mutex<Vec<Ahead>>);

impl AheadPool {
    fn memory(&self) -> MutexGuard<'_, Vec<Ahead>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes memory out of the pool, or makes new memory.
    pub(crate) fn take(&self) -> Ahead {
        self.memory().pop().unwrap_or_default()
    }

    /// Puts memory into the pool.
    pub(crate) fn keep(&self, ahead: Ahead) {
        self.memory().push(ahead);
    }
}

/// The number of photons that are emitted together if they may meet meshes. It is a multiple of
/// [`BLOCK`], and large enough that many photons meet nearby triangles.
pub(crate) const AHEAD: usize = 16 * BLOCK;

impl Ahead {
    /// The group of photons that begins with a photon, and the obstacles that they meet;
    /// `None` if they were not emitted.
    #[inline]
    pub(crate) fn of(&self, first: u64) -> Option<(&PhotonGroup, &Hits)> {
        let i = usize::try_from(first.checked_sub(self.first)?).ok()? / PHOTONS_PER_GROUP;
        self.groups.get(i).zip(self.hits.get(i))
    }

    /// Replaces the photons by those of several blocks, and finds what they meet, if there are
    /// meshes on a flat first leg. Otherwise, no photons remain. `numbers` returns the random
    /// numbers of the block that begins with a photon.
    pub(crate) fn refill(
        &mut self,
        emitter: &Emitter,
        flat: Option<&FlatLeg>,
        range: Range<u64>,
        numbers: impl Fn(u64) -> Numbers,
    ) {
        self.groups.clear();
        let Some(flat) = flat.filter(|flat| flat.has_meshes()) else {
            return;
        };
        let level = Level::new();
        for start in range.clone().step_by(BLOCK) {
            let end = range.end.min(start + BLOCK as u64);
            let numbers = numbers(start);
            let firsts = (start..end).step_by(PHOTONS_PER_GROUP);
            let group = |first| emit_group(emitter, level, first..end, &numbers);
            self.groups.extend(firsts.map(group));
        }
        self.first = range.start;
        flat.hits_of_all(&self.groups, &mut self.hits, &mut self.order);
    }
}

/// Emits a group of photons from the first of a range on. Photons beyond the range carry no light.
#[inline]
pub(crate) fn emit_group(
    emitter: &Emitter,
    level: Level,
    range: Range<u64>,
    numbers: &Numbers,
) -> PhotonGroup {
    let mut group = match numbers {
        Numbers::Lattice(points, ..) => {
            let net = || numbers.columns(level, range.start, 0);
            let group = dispatch!(level, _simd => points.group(range.start, net));
            emitter.emit_aimed(group, points.shares())
        }
        _ => emitter.emit(|block| numbers.columns(level, range.start, block)),
    };
    group.end_at(range.end - range.start);
    group
}
