//! Measures batches of photons, part by part, on all threads of a pool.

use crate::batch::{Batch, PartialBatch};
use crate::measurement::Measurement;
use crate::recorder::Recorder;
use etendue_field::{Crossing, PhotonSource, VirtualPlane};
use etendue_transform::SliceTransform;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Measures `batches` of photons from `source` at `planes`, on the threads of the current rayon pool.
///
/// One thread measures a part of a batch sequentially, and parts are added in order, so the
/// result is bitwise identical on any number of threads. `progress` is called with the number of
/// photons as they are traced.
///
/// Batches without photons are left out. If there are fewer photons than batches, the result has as
/// many batches as photons.
#[must_use]
pub fn measure(
    source: &dyn PhotonSource,
    planes: &[VirtualPlane],
    batches: Range<u32>,
    progress: &(dyn Fn(u64) + Sync),
) -> Measurement {
    let mut batches = batches.map(PartialBatch::new);
    measure_watched(source, planes, &mut batches, &Told(progress)).0
}

/// Callbacks during a measurement; they may come from any thread.
pub trait Watch: Sync {
    /// Receives the number of photons traced since the last call.
    fn traced(&self, photons: u64);

    /// Whether a part of a batch should be measured. This function is called just before
    /// the part is measured. If it returns false, this part and the later parts of the batch are
    /// not measured.
    fn should_continue(&self, _batch: u32, _part: u32) -> bool {
        true
    }

    /// Receives an unfinished batch whenever more of its parts are finished.
    fn begun(&self, _batch: &PartialBatch) {}

    /// Receives a finished batch.
    fn done(&self, _batch: &Batch) {}
}

/// A [`Watch`] that only reports the number of traced photons.
struct Told<'a>(&'a (dyn Fn(u64) + Sync));

impl Watch for Told<'_> {
    fn traced(&self, photons: u64) {
        (self.0)(photons);
    }
}

/// Runs [`measure`] on distinct batches in any order. If some parts of a batch are already
/// finished, the batch continues after these parts. Returns the finished batches, and the
/// unfinished batches that `watch` has stopped.
///
/// Threads take the parts of batches in order, which keeps the number of unfinished batches small.
/// A part is added to the sum only after all earlier parts.
#[must_use]
pub fn measure_watched(
    source: &dyn PhotonSource,
    planes: &[VirtualPlane],
    batches: &mut (dyn Iterator<Item = PartialBatch> + Send),
    watch: &dyn Watch,
) -> (Measurement, Vec<PartialBatch>) {
    // The error of the reduced transform would exceed the noise of quiet photons.
    let plan = if source.is_precise() {
        SliceTransform::new
    } else {
        SliceTransform::reduced
    };
    let plans: Vec<_> = planes.iter().map(|p| plan(&p.grid)).collect();
    let recorders = || -> Vec<Recorder<'_>> {
        let pairs = planes.iter().zip(&plans);
        pairs
            .map(|(plane, plan)| Recorder::new(plane, plan))
            .collect()
    };
    let mut all = Vec::new();
    let parts = BatchParts {
        source,
        batches,
        watch,
        all: &mut all,
        next: 0,
    };
    let parts = parts.par_bridge();
    parts.for_each_init(recorders, |own, (sum, part): (Arc<BatchSum>, u32)| {
        let measured = measure_part(source, [sum.index, part], own, &|photons| {
            watch.traced(photons);
        });
        sum.add(part, measured, watch);
    });
    let mut whole = Vec::new();
    let mut begun = Vec::new();
    for BatchSum { parts, state, .. } in all.into_iter().filter_map(Arc::into_inner) {
        // If a thread has panicked, the sums of the others are still right.
        let state = state.into_inner().unwrap_or_else(PoisonError::into_inner);
        match state.partial {
            PartialBatch {
                parts: done,
                sum: Some(batch),
                ..
            } if done == parts => whole.push(batch),
            partial => begun.push(partial),
        }
    }
    (Measurement::of(planes, whole.into_iter()), begun)
}

/// An iterator over the parts of batches, one after the other.
struct BatchParts<'a> {
    source: &'a dyn PhotonSource,
    batches: &'a mut (dyn Iterator<Item = PartialBatch> + Send),
    watch: &'a dyn Watch,
    /// The batches whose parts have been taken at least partly.
    all: &'a mut Vec<Arc<BatchSum>>,
    /// The number of the next part of the last batch in `all`.
    next: u32,
}

impl Iterator for BatchParts<'_> {
    type Item = (Arc<BatchSum>, u32);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(sum) = self.all.last()
                && self.next < sum.parts
                && self.watch.should_continue(sum.index, self.next)
            {
                self.next += 1;
                return Some((Arc::clone(sum), self.next - 1));
            }
            let emits = |batch: &PartialBatch| self.source.emitted(batch.index) > 0;
            let partial = Iterator::find(&mut self.batches, emits)?;
            self.next = partial.parts;
            let parts = self.source.parts(partial.index);
            self.all.push(Arc::new(BatchSum::new(partial, parts)));
        }
    }
}

/// The sum of the parts of a batch, added in their order.
struct BatchSum {
    index: u32,
    /// Number of parts of the batch.
    parts: u32,
    state: Mutex<SumState>,
}

struct SumState {
    partial: PartialBatch,
    /// Finished parts that cannot be added until an earlier part is finished.
    waiting: BTreeMap<u32, Batch>,
}

impl BatchSum {
    fn new(partial: PartialBatch, parts: u32) -> Self {
        Self {
            index: partial.index,
            parts,
            state: Mutex::new(SumState {
                partial,
                waiting: BTreeMap::new(),
            }),
        }
    }

    fn state(&self) -> MutexGuard<'_, SumState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn add(&self, part: u32, measured: Batch, watch: &dyn Watch) {
        let mut state = self.state();
        let SumState { partial, waiting } = &mut *state;
        waiting.insert(part, measured);
        let before = partial.parts;
        while let Some(next) = waiting.remove(&partial.parts) {
            partial.add(next);
        }
        match &partial.sum {
            Some(batch) if partial.parts == self.parts => watch.done(batch),
            _ if partial.parts > before => watch.begun(partial),
            _ => {}
        }
    }
}

/// The contribution of a part of a batch to the means over the entire batch.
fn measure_part(
    source: &dyn PhotonSource,
    [index, part]: [u32; 2],
    recorders: &mut [Recorder<'_>],
    progress: &(dyn Fn(u64) + Sync),
) -> Batch {
    let record = &mut |plane: usize, crossings: &[Crossing]| recorders[plane].record(crossings);
    let ledger = source.emit_part(index, part, record, &|photons| progress(photons));
    let emitted = source.emitted(index);
    let scale = 1.0 / emitted as f64;
    Batch {
        index,
        emitted,
        ledger,
        planes: recorders.iter_mut().map(|r| r.finish(scale)).collect(),
    }
}
