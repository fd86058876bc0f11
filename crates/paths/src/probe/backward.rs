//! Rays of a probe that are traced back.

use super::{Budget, Probe};
use crate::numbers::PathNumbers;
use etendue_field::{Crossing, Ledger, PhotonSource, TwoPlane, VirtualPlane};

/// Rays of a [`Probe`] traced back: for each plane on its own, lines drawn evenly over its window, with the radiance that a path finds along each.
#[derive(Debug)]
pub struct BackwardProbe<'a> {
    probe: &'a Probe<'a>,
    budget: Budget,
    /// The plane whose rays are traced; all without it.
    only: Option<usize>,
}

/// Rays between two reports.
const BLOCK: u64 = 4096;

impl<'a> BackwardProbe<'a> {
    /// The rays of a probe.
    #[must_use]
    pub fn new(probe: &'a Probe<'a>, budget: Budget) -> Self {
        Self {
            probe,
            budget,
            only: None,
        }
    }

    /// The same rays of one plane alone.
    #[must_use]
    pub fn at_plane(self, index: usize) -> Self {
        Self {
            only: Some(index),
            ..self
        }
    }

    /// One ray of a plane.
    fn crossing(&self, plane: &VirtualPlane, number: u64) -> Crossing {
        let Probe { paths, legs, .. } = self.probe;
        let mut numbers = PathNumbers::new(self.budget.seed, number);
        let half = [
            plane.window.x,
            plane.window.y,
            plane.window.u,
            plane.window.v,
        ];
        let half = half.map(|profile| profile.half_width());
        let drawn: [f64; 4] = numbers.draw();
        let [x, y, u, v] = [0, 1, 2, 3].map(|i: usize| (2.0 * drawn[i] - 1.0) * half[i]);
        let ray = TwoPlane { x, y, u, v };
        let line = legs[plane.leg].line(&paths.geometry, &plane.frame, &ray);
        let before = u32::try_from(plane.leg).unwrap_or(u32::MAX);
        let radiance = paths.radiance(line, [0.0, f64::INFINITY], before, &mut numbers);
        // The window's volume over the number of rays, as the mean over them has it.
        let weight = radiance * half.iter().map(|half| 2.0 * half).product::<f64>();
        Crossing { ray, weight }
    }
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
        for block in 0..self.budget.each.div_ceil(BLOCK) {
            let start = block * BLOCK;
            let count = BLOCK.min(self.budget.each - start);
            let wanted = |i: usize| self.only.is_none_or(|only| only == i);
            for (i, plane) in planes.iter().enumerate().filter(|(i, _)| wanted(*i)) {
                // Numbers of different planes are apart.
                let of = |ray: u64| (first + start + ray) * planes.len() as u64 + i as u64;
                let crossings: Vec<Crossing> = (0..count)
                    .map(|ray| self.crossing(plane, of(ray)))
                    .collect();
                record(i, &crossings);
            }
            progress(count);
        }
        Ledger::default()
    }
}
