use crate::batch::{Batch, PlaneBatch};
use crate::histogram::ProjectionHistogram;
use crate::measurement::Measurement;
use crate::ray_moments::RayMoments;
use etendue_field::transform::{Accumulator, SliceTransform};
use etendue_field::{Crossing, PhotonSource, PlaneTally, ProjectionGrid, VirtualPlane};
use rayon::prelude::*;
use std::ops::Range;

/// Cells of a projection along x and along u.
pub const PROJECTION_BINS: usize = 64;

/// Measures `batches` of photons from `source` at `planes`, on the threads of the current rayon pool.
///
/// A part of a batch is the sequential work of one thread, and parts are added in order, so the result
/// is the same to the bit on any number of threads. `progress` is told the photons as they are traced.
///
/// A batch that emits nothing measures nothing and is left out: with fewer photons than batches the result
/// holds as many batches as photons.
#[must_use]
pub fn measure(
    source: &dyn PhotonSource,
    planes: &[VirtualPlane],
    batches: Range<u32>,
    progress: &(dyn Fn(u64) + Sync),
) -> Measurement {
    let batches: Vec<u32> = batches.collect();
    measure_watched(source, planes, &batches, &Told(progress))
}

/// What goes on while batches are measured, told and asked from several threads.
pub trait Watch: Sync {
    /// So many photons more are traced.
    fn traced(&self, photons: u64);

    /// Whether a batch is to be measured, asked when its turn comes.
    fn wants(&self, _batch: u32) -> bool {
        true
    }

    /// A batch is done.
    fn done(&self, _batch: &Batch) {}
}

/// One that counts photons alone.
struct Told<'a>(&'a (dyn Fn(u64) + Sync));

impl Watch for Told<'_> {
    fn traced(&self, photons: u64) {
        (self.0)(photons);
    }
}

/// [`measure`] of distinct batches in any order, of which those are left out that `watch` does not want.
#[must_use]
pub fn measure_watched(
    source: &dyn PhotonSource,
    planes: &[VirtualPlane],
    batches: &[u32],
    watch: &dyn Watch,
) -> Measurement {
    let plans: Vec<_> = planes
        .iter()
        .map(|p| SliceTransform::new(&p.grid))
        .collect();
    let recorders = || -> Vec<Recorder<'_>> {
        let pairs = planes.iter().zip(&plans);
        pairs
            .map(|(plane, plan)| Recorder::new(plane, plan))
            .collect()
    };
    let part = |recorders: &mut Vec<Recorder<'_>>, index: u32, part: u32| {
        measure_part(source, [index, part], recorders, &|photons| {
            watch.traced(photons);
        })
    };
    let whole = |own: &mut Vec<Recorder<'_>>, index: u32| {
        let parts = source.parts(index);
        if parts == 1 {
            return Some(part(own, index, 0));
        }
        let parts = (0..parts).into_par_iter().with_max_len(1);
        let parts = parts.map_init(recorders, |own, number| part(own, index, number));
        let parts: Vec<Batch> = parts.collect();
        parts.into_iter().reduce(|mut sum, part| {
            sum.add(&part);
            sum
        })
    };
    let measured: Vec<Option<Batch>> = batches
        .par_iter()
        .with_max_len(1)
        .map_init(recorders, |own, index| {
            let emits = source.emitted(*index) > 0 && watch.wants(*index);
            let batch = emits.then(|| whole(own, *index)).flatten();
            batch.iter().for_each(|batch| watch.done(batch));
            batch
        })
        .collect();
    Measurement::of(planes, measured.into_iter().flatten())
}

/// What a part of a batch adds to the means over the whole batch.
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

/// Takes the crossings of one plane, applies its quantity and its window and keeps the sums.
struct Recorder<'plan> {
    plane: &'plan VirtualPlane,
    tally: PlaneTally,
    slices: Accumulator<'plan>,
    projection: ProjectionHistogram,
    moments: RayMoments,
}

impl<'plan> Recorder<'plan> {
    fn new(plane: &'plan VirtualPlane, plan: &'plan SliceTransform) -> Self {
        let cells = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
        Self {
            plane,
            tally: PlaneTally::default(),
            slices: plan.accumulator(),
            projection: ProjectionHistogram::new(cells),
            moments: RayMoments::default(),
        }
    }

    fn record(&mut self, crossings: &[Crossing]) {
        for Crossing { ray, weight } in crossings {
            self.tally.crossed += 1;
            if !self.plane.window.contains(ray) {
                self.tally.outside += 1;
                continue;
            }
            self.tally.inside += 1;
            let weight = weight * self.plane.window.value(ray) * self.plane.factor(ray);
            self.slices.deposit(ray, weight);
            self.projection.deposit(ray, weight);
            self.moments.deposit(ray, weight);
        }
    }

    /// What was recorded, per emitted photon; ready for the next batch.
    fn finish(&mut self, scale: f64) -> PlaneBatch {
        PlaneBatch {
            tally: std::mem::take(&mut self.tally),
            slices: self.slices.finish(scale),
            projection: self.projection.finish(scale),
            moments: self.moments.finish(scale),
        }
    }
}
