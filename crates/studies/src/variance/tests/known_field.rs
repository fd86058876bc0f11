//! Predicts the variance for a field with three known frequencies.

use super::{samplers, scene};
use crate::variance::{
    ExpectedPower, MeasuredPower, PredictedVariance, Sampler, SamplerResponse, WindowMoments,
    axis_sets, with_box_window,
};
use etendue_field::{Crossing, Ledger, PhotonSource, TwoPlane};
use etendue_spectrum::Uncertain;
use etendue_transform::random::{Stream, unit, words};
use std::f64::consts::TAU;

/// Photons of the field 1 + Σ a cos(2π m·z) in the windows of the soft shadow, with few photons in
/// each batch.
struct Waves;

const PHOTONS: u64 = 1 << 12;
const BATCHES: u32 = 64;
const HALF_WIDTHS: [f64; 4] = [0.25, 0.2, 0.25, 0.2];

/// The frequencies (x, u, y, v) and amplitudes of the field. The last frequency is in the last
/// octave.
const WAVES: [([i64; 4], f64); 3] = [
    ([2, 1, 0, 0], 0.3),
    ([0, 0, 0, 3], 0.2),
    ([1, 0, -4, 2], 0.4),
];

impl PhotonSource for Waves {
    fn emitted(&self, _batch: u32) -> u64 {
        PHOTONS
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        _progress: &dyn Fn(u64),
    ) -> Ledger {
        for photon in 0..PHOTONS {
            let index = u64::from(batch) * PHOTONS + photon;
            let z = words(9, Stream::Photon, index, 0).map(unit);
            let phase = |m: [i64; 4]| (0..4).map(|k| m[k] as f64 * z[k]).sum::<f64>();
            let waves = WAVES.map(|(m, a)| a * (TAU * phase(m)).cos());
            let weight = 1.0 + waves.iter().sum::<f64>();
            let volume: f64 = HALF_WIDTHS.iter().map(|h| 2.0 * h).product();
            let [x, u, y, v] = [0, 1, 2, 3].map(|k| (2.0 * z[k] - 1.0) * HALF_WIDTHS[k]);
            let ray = TwoPlane { x, y, u, v };
            let weight = weight * volume;
            record(0, &[Crossing { ray, weight }]);
        }
        Ledger::default()
    }
}

fn exactly(value: f64) -> Uncertain {
    Uncertain { value, error: 0.0 }
}

fn measured(max: usize) -> (MeasuredPower, WindowMoments) {
    let scene = with_box_window(&scene("soft_shadow.ron", &[]), 0, max);
    assert_eq!(scene.run.batches, BATCHES);
    let power = MeasuredPower::measure(&scene.planes[0], (&Waves, BATCHES), max, &|_| ()).unwrap();
    let moments = WindowMoments {
        mean: exactly(1.0),
        variance: exactly(WAVES.iter().map(|(_, a)| a * a / 2.0).sum()),
        noise: exactly(0.0),
    };
    (power, moments)
}

/// All power is inside the box, so the variance is Σ a²/2 · E|S_m|². Differences stay below four
/// standard errors. Without subtraction of the photons' noise, or with the axes in another order,
/// they do not.
#[test]
fn the_variance_of_known_waves_is_predicted() {
    let (power, moments) = measured(4);
    assert!((power.mean.value - 1.0).abs() < 4.0 * power.mean.error);
    for sampler in samplers() {
        for count in [16, 256] {
            let expected = ExpectedPower::new(&sampler, count).unwrap();
            let exact = WAVES.map(|(m, a)| 0.5 * a * a * expected.at(m));
            let exact: f64 = exact.iter().sum();
            let response = SamplerResponse::new(&sampler, count, 4, 1).unwrap();
            let found =
                PredictedVariance::new(&power.spectrum, &response, &moments, count).variance;
            let off = (found.value - exact).abs() / (found.error + 1e-14);
            assert!(off < 4.0, "{sampler} {count}: {found:?} {exact}");
            assert!(found.error < 0.2 * moments.variance.value / count as f64);
        }
    }
}

#[test]
fn the_power_of_known_waves_is_in_their_sets_of_axes() {
    let (power, moments) = measured(4);
    for set in axis_sets(&power, &moments) {
        let expected = match set.axes[..] {
            ["x", "u"] => 0.045,
            ["v"] => 0.02,
            ["x", "y", "v"] => 0.08,
            _ => 0.0,
        };
        let share = expected / moments.variance.value;
        let off = (set.share.value - share).abs() / set.share.error;
        assert!(off < 4.5, "{set:?} {share}");
    }
}

/// Two fields that differ only in their power beyond the box have the same prediction if σ² is the
/// same, and a larger σ² gives a larger variance.
#[test]
fn missing_power_is_in_the_tail() {
    let (power, mut moments) = measured(4);
    let response = SamplerResponse::new(&Sampler::Sobol, 256, 4, 1).unwrap();
    let predicted =
        |moments: &WindowMoments| PredictedVariance::new(&power.spectrum, &response, moments, 256);
    let inside = predicted(&moments);
    moments.variance.value *= 1.25;
    let more = predicted(&moments);
    let tail = more.tail * more.variance.value - inside.tail * inside.variance.value;
    let added = more.variance.value - inside.variance.value;
    assert!((added - tail).abs() < 1e-12); // rounding
    assert!(more.tail > 0.2 && added > 0.0);
}
