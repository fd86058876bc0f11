//! The default distribution of samples. It follows the criteria, which are calibrated by the errors
//! of evenly distributed samples.
//!
//! A criterion limits how fast light may change, but does not tell how much of the light changes.
//! Therefore the first samples are evenly distributed. Planes are fitted to one half of these
//! samples, and are compared with the other half. Suppose that the criterion gives a density n_c,
//! which is right except for a factor. At a density n, the squared error is then e² = k n_c²/n²,
//! where k is constant. This k is measured for each object, and the best density is (k n_c²)^(1/3).
//! Half of the remaining samples have this density. The other half follow the measured errors,
//! which also show light that the criterion misses, such as shadows.

use crate::criterion::{BandwidthCriterion, shaded};
use crate::cross::{cross_errors, squared};
use crate::density::{even, scaled, to_power};
use crate::guide::{LightGuide, SampleGuide};
use crate::method::{AdaptiveRun, Stage, by_error, sums, values};
use crate::metric::Metric;
use crate::objects::ObjectSums;
use crate::parts::POWER;
use crate::reconstruct::ShadedSample;

/// The share of the samples that are taken first, evenly distributed.
const EVEN_SHARE: f64 = 1.0 / 3.0;

/// The smallest factor of an object, relative to the factor of all objects.
const MIN_FACTOR: f64 = 1e-3;

impl AdaptiveRun<'_> {
    /// Shades all samples of the default method.
    pub(crate) fn auto(&mut self) -> Vec<ShadedSample> {
        let count = self.plan.samples as f64;
        let rest = (1.0 - EVEN_SHARE) * count;
        let first = scaled(&even(self.visible), EVEN_SHARE * count);
        let points = self.points(&first, EVEN_SHARE * count, 0);
        let pilot = self.shaded(&points, 0);
        let missed = self.guided(&pilot);
        let criterion = self.predicted(BandwidthCriterion::Corrected);
        let factors = self.factors(&first, &criterion, &missed);
        let shapes = self.visible.pixels(|pixel| {
            let surface = self.visible.of_pixel(pixel).iter().find_map(shaded)?;
            Some(surface.shape)
        });
        let pairs = criterion.iter().zip(&shapes);
        let calibrated = pairs.map(|(metric, shape)| {
            let factor = factor(&factors, (*shape)?);
            Some(to_power((*metric)?, POWER).times(libm::cbrt(factor)))
        });
        let calibrated: Vec<Option<Metric>> = calibrated.collect();
        let found = by_error(&first, &self.around(&missed));
        let halves = [scaled(&calibrated, 0.5 * rest), scaled(&found, 0.5 * rest)];
        let then = sums(&halves[0], &halves[1]);
        self.both(&first, pilot, &then, rest)
    }

    /// Makes the guide. Returns the squared errors at the first samples that remain with the guide.
    fn guided(&mut self, pilot: &[(ShadedSample, f64)]) -> Vec<ShadedSample> {
        let visible = self.visible;
        let samples = values(pilot);
        (self.stage)(Stage::Guide, 1);
        let mut guide = LightGuide::new(visible, &std::mem::take(&mut self.direct));
        let guides: Vec<SampleGuide> = samples.iter().map(|at| guide.at(visible, at)).collect();
        let of_guide = samples.iter().zip(&guides).map(|(sample, guide)| {
            let value = guide.value;
            ShadedSample { value, ..*sample }
        });
        let of_guide: Vec<ShadedSample> = of_guide.collect();
        let errors = [&samples, &of_guide].map(|of| cross_errors(visible, of));
        let left = guide.trust(pilot, &guides, errors.each_ref().map(Vec::as_slice));
        self.guide = Some(guide);
        squared(pilot, &left)
    }

    /// Computes the factors k of all objects.
    fn factors(
        &self,
        first: &[Option<Metric>],
        criterion: &[Option<Metric>],
        missed: &[ShadedSample],
    ) -> Factors {
        let mut factors = Factors::default();
        for sample in missed {
            let pixel = self.visible.pixel_index(sample.at);
            let density = |of: &[Option<Metric>]| Some(of[pixel]?.determinant());
            if let Some((n, by_criterion)) = density(first).zip(density(criterion)) {
                factors.add(sample.surface.shape, [sample.value[0] * n, by_criterion]);
            }
        }
        factors
    }
}

/// The sums of e² n² and of n_c², from which the factors k are computed.
type Factors = ObjectSums<2>;

/// The ratio k of measured to predicted squared errors of an object, up to a common factor.
/// The ratio is never zero, because the first samples may have missed the object's light.
fn factor(factors: &Factors, object: usize) -> f64 {
    let [error, criterion] = factors.all;
    if error <= 0.0 || criterion <= 0.0 {
        return 1.0;
    }
    let [own_error, own_criterion] = factors.of(object);
    (own_error / own_criterion).max(MIN_FACTOR * error / criterion)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The factor of an object is proportional to its squared errors. An object without samples has
    /// the common factor of all objects.
    #[test]
    fn factors_are_those_of_the_objects() {
        let mut factors = Factors::default();
        for _ in 0..1000 {
            factors.add(0, [2.0, 1.0]);
            factors.add(1, [0.02, 1.0]);
        }
        let [one, other, unknown] = [0, 1, 2].map(|object| factor(&factors, object));
        assert!((one / other - 100.0).abs() < 25.0, "{one} {other}"); // shared samples
        assert!((unknown - 1.01).abs() < 1e-12, "{unknown}"); // rounding
    }
}
