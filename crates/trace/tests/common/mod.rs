//! Computes estimates from a source of photons at each virtual plane of a scene.

use etendue_field::{Crossing, Ledger, PhotonSource};
use etendue_scene::Scene;
use std::f64::consts::TAU;

/// The means and standard errors, at each virtual plane, of the windowed light field and
/// of two of its Fourier sums.
pub(crate) fn estimates(source: &dyn PhotonSource, scene: &Scene) -> (Vec<[[f64; 2]; 3]>, Ledger) {
    let mut sums = vec![[[0.0; 2]; 3]; scene.planes.len()];
    let mut ledger = Ledger::default();
    let mut emitted = 0;
    for batch in 0..scene.run.batches {
        let mut record = |plane: usize, crossings: &[Crossing]| {
            for Crossing { ray, weight } in crossings {
                let at = &scene.planes[plane];
                let w = weight * at.window.value(ray) * at.factor(ray);
                let phase = TAU * (1.3 * ray.x - 0.4 * ray.y + 0.9 * ray.u + 0.7 * ray.v);
                let terms = [w, w * phase.cos(), w * phase.sin()];
                for (sum, term) in sums[plane].iter_mut().zip(terms) {
                    sum[0] += term;
                    sum[1] += term * term;
                }
            }
        };
        ledger.add(&source.emit(batch, &mut record, &|_| ()));
        emitted += source.emitted(batch);
    }
    let n = emitted as f64;
    let estimate = |[s, s2]: [f64; 2]| {
        let mean = s / n;
        [mean, ((s2 / n - mean * mean) / n).sqrt()]
    };
    let all = sums.into_iter().map(|plane| plane.map(estimate));
    (all.collect(), ledger)
}
