//! Backward rays of a probe.

use super::{Budget, Probe};
use crate::numbers::{JOINT, PathNumbers};
use crate::paths::LightSearch;
use etendue_field::{Crossing, Ledger, PhotonSource, Profile, TwoPlane, VirtualPlane, Window};
use etendue_transform::Net;
use etendue_transform::random::Stream;
use rayon::prelude::*;

/// Backward rays of a [`Probe`]. For each plane separately, lines are drawn uniformly over the
/// plane's window, and a path finds the radiance along each line.
#[derive(Debug)]
pub struct BackwardProbe<'a> {
    probe: &'a Probe<'a>,
    budget: Budget,
    search: LightSearch,
}

impl<'a> BackwardProbe<'a> {
    /// Creates the backward rays of a probe.
    #[must_use]
    pub fn new(probe: &'a Probe<'a>, budget: Budget) -> Self {
        Self {
            probe,
            budget,
            search: LightSearch::Both,
        }
    }

    /// Finds lights only by directions sampled from BSDFs. This gives a second estimate of the same
    /// light, with more noise. Returns `None` if the world has lights that such rays never find.
    #[must_use]
    pub fn by_bsdf(self) -> Option<Self> {
        let search = LightSearch::Bsdf;
        let is_possible = self.probe.bsdf_finds_lights();
        is_possible.then_some(Self { search, ..self })
    }

    /// Traces the ray with this number through a plane. A point of a net gives the first random
    /// numbers of the ray.
    fn crossing(&self, plane: &VirtualPlane, number: u64, (net, point): (&Net, u32)) -> Crossing {
        let mut numbers = PathNumbers::new(self.budget.seed, number).of_net(net, point);
        let half = half_widths(plane);
        let ray = line(half, &mut numbers);
        let probe = self.probe;
        let radiance = probe.radiance_by(plane, &ray, self.search, &mut numbers);
        // The last factor is the volume of the window. The weights are not divided by the number of
        // rays here, because their mean is computed later.
        let weight = radiance * half.iter().map(|half| 2.0 * half).product::<f64>();
        Crossing { ray, weight }
    }

    /// Lines drawn uniformly over a plane's window, each with the radiances that two
    /// independent paths find along it. The mean of a product of both has no part due to the noise
    /// of paths.
    #[must_use]
    pub fn pairs(&self, plane: &VirtualPlane, count: u64) -> Vec<(TwoPlane, [f64; 2])> {
        let pair = |i: u64| {
            let mut numbers =
                [2 * i, 2 * i + 1].map(|i| PathNumbers::new(self.budget.seed, PAIRS + i));
            let ray = line(half_widths(plane), &mut numbers[0]);
            let found = numbers
                .each_mut()
                .map(|numbers| self.probe.radiance_by(plane, &ray, self.search, numbers));
            (ray, found)
        };
        (0..count).into_par_iter().map(pair).collect()
    }
}

/// The number of the first path of [`BackwardProbe::pairs`]; other paths have smaller numbers.
const PAIRS: u64 = 1 << 62;

/// The half-widths of a plane's window along x, y, u and v.
fn half_widths(plane: &VirtualPlane) -> [f64; 4] {
    let Window { x, y, u, v } = &plane.window;
    [x, y, u, v].map(Profile::half_width)
}

/// Draws a line uniformly within half-widths.
fn line(half: [f64; 4], numbers: &mut PathNumbers<'_>) -> TwoPlane {
    let drawn: [f64; 4] = numbers.draw();
    let [x, y, u, v] = [0, 1, 2, 3].map(|i: usize| (2.0 * drawn[i] - 1.0) * half[i]);
    TwoPlane { x, y, u, v }
}

impl PhotonSource for BackwardProbe<'_> {
    fn emitted(&self, _batch: u32) -> u64 {
        self.budget.each
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        let planes = &self.probe.planes;
        let first = u64::from(batch) * self.budget.each;
        for block in self.budget.blocks() {
            for (i, plane) in planes.iter().enumerate() {
                // Different planes and batches use different numbers.
                let of = |ray: u64| (first + ray) * planes.len() as u64 + i as u64;
                let index = u64::from(batch) * planes.len() as u64 + i as u64;
                let net = Net::new(self.budget.seed, Stream::Net, index, JOINT);
                let crossings: Vec<Crossing> = block
                    .clone()
                    .map(|ray| self.crossing(plane, of(ray), (&net, point_of(ray))))
                    .collect();
                record(i, &crossings);
            }
            progress(block.end - block.start);
        }
        Ledger::default()
    }
}

/// The point of a net for a ray of a batch. A net has 2³² points, more than any batch.
fn point_of(ray: u64) -> u32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "rays after the last point use the points again, beginning with the first"
    )]
    let point = ray as u32;
    point
}
