//! Estimates by cross-validation how well planes fit samples: planes through one half of the
//! samples are compared with the other half.

use crate::criterion::shaded;
use crate::reconstruct::{SampleFit, ShadedSample, reconstruct_where};
use crate::visible::Visible;

/// The maximum distance of neighbours for errors, as a multiple of the maximum distance for the
/// reconstruction.
pub(crate) const WIDER: f64 = 2.0;

/// The error at a sample: the value of the plane through other samples, minus the value of the
/// sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CrossError {
    /// The index of the sample.
    pub(crate) index: usize,
    /// The errors of base and lobe.
    pub(crate) off: [f64; 2],
}

/// Fits planes to each half of the samples, and returns their errors at the samples of the other
/// half. Samples that no other sample reaches are left out.
pub(crate) fn cross_errors(visible: &Visible, samples: &[ShadedSample]) -> Vec<CrossError> {
    let mut found = Vec::new();
    for half in 0..2 {
        // The halves alternate in the order of pixels, so that both cover the picture.
        let of = |odd: usize| samples.iter().enumerate().skip(odd).step_by(2);
        let sparse: Vec<ShadedSample> = of(half)
            .map(|(_, sample)| ShadedSample {
                metric: sample.metric.times(0.5),
                ..*sample
            })
            .collect();
        // A sample is represented by the first point of its pixel that is on its object.
        let point = |sample: &ShadedSample| {
            let mut near = visible.range(visible.pixel_at(sample.at));
            near.find(|i| {
                let surface = shaded(&visible.places[*i]);
                surface.is_some_and(|surface| surface.shape == sample.surface.shape)
            })
        };
        let points: Vec<Option<usize>> = of(1 - half).map(|(_, sample)| point(sample)).collect();
        let mut is_wanted = vec![false; visible.places.len()];
        for point in points.iter().flatten() {
            is_wanted[*point] = true;
        }
        let wanted = |i: usize| is_wanted[i];
        let values = reconstruct_where(visible, &sparse, SampleFit::Plane, &wanted);
        for ((index, sample), point) in of(1 - half).zip(&points) {
            if let Some(fitted) = point.and_then(|i| values[i]) {
                let off = [0, 1].map(|part: usize| fitted[part] - sample.value[part]);
                found.push(CrossError { index, off });
            }
        }
    }
    found
}

/// The squared relative errors of the light, without the part due to noise, as values of
/// samples. `samples` contains the variance of the light of each sample.
pub(crate) fn squared(samples: &[(ShadedSample, f64)], errors: &[CrossError]) -> Vec<ShadedSample> {
    let dark = dark(samples);
    let of = |error: &CrossError| {
        let (sample, noise) = &samples[error.index];
        let off = sample.surface.light(error.off);
        let here = sample.surface.light(sample.value);
        let scale = 0.5 * (here * here + (here + off).powi(2)) + dark * dark;
        ShadedSample {
            metric: sample.metric.times(WIDER.powi(-2)),
            value: [(off * off - noise) / scale, 0.0],
            ..*sample
        }
    };
    errors.iter().map(of).collect()
}

/// A hundredth of the mean radiance. For light below this radiance, errors are relative to
/// this radiance.
pub(crate) fn dark(samples: &[(ShadedSample, f64)]) -> f64 {
    let lights = samples
        .iter()
        .map(|(sample, _)| sample.surface.light(sample.value));
    0.01 * lights.sum::<f64>() / samples.len().max(1) as f64
}
