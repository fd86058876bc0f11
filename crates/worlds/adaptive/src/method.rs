//! The stages from the camera to the picture.

use crate::blockers::{self, nearness};
use crate::blue_noise::{PicturePoint, PixelPosition, blue_noise};
use crate::criterion::{BandwidthCriterion, curvature, shaded};
use crate::cross::{WIDER, cross_errors, squared};
use crate::cutoffs::Cutoffs;
use crate::density::{even, scaled, to_power, wanted};
use crate::edges;
use crate::guide::{LightGuide, direct};
use crate::metric::Metric;
use crate::parts::{SampleMethod, SamplePlacing};
use crate::reconstruct::{SampleFit, ShadedSample, reconstruct, reconstruct_pixels};
use crate::shading::Shader;
use crate::smooth::PlaceValues;
use crate::visible::{FOUR, Visible, at};
use etendue_field::whole;
use etendue_paths::{Nearness, Paths};
use etendue_world::Camera;

/// Options of a picture.
#[derive(Clone, Copy, Debug)]
pub struct SamplePlan {
    /// The distribution of samples.
    pub method: SampleMethod,
    /// Number of shading samples.
    pub samples: usize,
    /// Paths per sample.
    pub each: u32,
    /// Rays per point to find the distance of blockers.
    pub blocker_rays: u32,
    /// Whether sample densities are isotropic, as always in [`SampleMethod::Paper`], or adapted to
    /// each direction.
    pub is_even: bool,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// A stage of the work, reported before it begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Finding visible points, four per pixel, and for the default method their direct light.
    Visibility,
    /// Measuring the nearness of blockers.
    Blockers,
    /// Evaluating the criteria.
    Criterion,
    /// Smoothing the direct light at all visible points, which guides the reconstruction.
    Guide,
    /// Choosing the points to shade.
    Samples,
    /// Shading the points.
    Shading,
    /// Reconstruction between the points.
    Reconstruction,
}

/// Layers with a number for each pixel, rows from the top; NaN where nothing is shaded.
#[derive(Clone, Debug, Default)]
pub struct Layers {
    /// The largest bandwidth over all directions by the criterion, cycles per pixel.
    pub bandwidth: Vec<f64>,
    /// The bandwidth without blockers, by Eq. 20 as printed; only by [`SampleMethod::Paper`].
    pub unoccluded: Vec<f64>,
    /// The principal curvature of larger magnitude, per unit of length, positive if convex. It is
    /// computed by finite differences on the screen.
    pub curvature: Vec<f64>,
    /// The mean of 1/distance over the reflected objects, per unit of length. By
    /// [`SampleMethod::Paper`], it is the mean over the hemisphere.
    pub blockers: Vec<f64>,
    /// The highest frequency of penumbrae, cycles per unit of length.
    pub shadow: Vec<f64>,
    /// The number of shading samples per pixel that the method requests.
    pub density: Vec<f64>,
    /// The number of shading samples in the pixel.
    pub samples: Vec<f64>,
    /// The variance of shading samples around the pixel, after noise removal.
    pub variance: Vec<f64>,
}

/// A picture from few samples.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Radiance, W m⁻² sr⁻¹, rows from the top.
    pub radiance: Vec<f64>,
    /// Positions of samples: pixels to the right and down from the top left.
    pub points: Vec<[f64; 2]>,
    /// Number of samples that were added at points far from all others.
    pub added: usize,
    /// The quantities from which the picture was made.
    pub layers: Layers,
}

/// A method takes this share of the samples first, to determine the density of the other samples.
const FIRST_SHARE: f64 = 0.25;

/// Renders a picture. `stage` receives the next stage and its number of steps, and `progress`
/// receives the number of finished steps.
#[must_use]
pub fn render(
    paths: &Paths,
    camera: &Camera,
    plan: &SamplePlan,
    stage: &dyn Fn(Stage, usize),
    progress: &(dyn Fn(u64) + Sync),
) -> Rendered {
    let cutoffs = Cutoffs::default();
    let [w, h] = camera.size;
    stage(Stage::Visibility, w * h);
    let shader = Shader {
        paths,
        camera,
        cutoffs: &cutoffs,
        each: plan.each,
        seed: plan.seed,
    };
    let (visible, direct) = if plan.method == SampleMethod::Auto {
        let look = |index: usize, at: PixelPosition| {
            let (place, view) = shader.look(at);
            (place, direct(&shader, w, index, &view, &place))
        };
        Visible::new(camera.size, look, progress)
    } else {
        let look = |_, at: PixelPosition| (shader.place(at), ());
        (Visible::new(camera.size, look, progress).0, Vec::new())
    };
    let mut work = AdaptiveRun {
        visible: &visible,
        shader,
        plan,
        stage,
        progress,
        layers: Layers::default(),
        direct,
        guide: None,
    };
    let samples = work.samples();
    work.picture(samples)
}

pub(crate) struct AdaptiveRun<'a> {
    pub(crate) visible: &'a Visible,
    pub(crate) shader: Shader<'a>,
    pub(crate) plan: &'a SamplePlan,
    pub(crate) stage: &'a dyn Fn(Stage, usize),
    pub(crate) progress: &'a (dyn Fn(u64) + Sync),
    layers: Layers,
    /// Noisy direct light at all points, if the method uses a guide.
    pub(crate) direct: PlaceValues,
    /// The guide of the reconstruction, if the method uses one.
    pub(crate) guide: Option<LightGuide>,
}

impl AdaptiveRun<'_> {
    /// Shades all samples of the method. Each sample stores the common metric of all samples.
    fn samples(&mut self) -> Vec<ShadedSample> {
        let parts = self.plan.method.parts();
        if parts.placing == SamplePlacing::Calibrated {
            return self.auto();
        }
        let wanted = match parts.criterion {
            Some(criterion) => self.predicted(criterion),
            None => even(self.visible),
        };
        let count = self.plan.samples as f64;
        let wanted: Vec<Option<Metric>> = wanted
            .iter()
            .map(|metric| metric.map(|metric| to_power(metric, parts.power)))
            .collect();
        if parts.placing == SamplePlacing::Together {
            let metrics = scaled(&wanted, count);
            self.told(&metrics);
            let points = self.points(&metrics, count, 0);
            let found = self.shaded(&points, 0);
            return values(&found);
        }
        let first = scaled(&wanted, FIRST_SHARE * count);
        let points = self.points(&first, FIRST_SHARE * count, 0);
        let pilot = self.shaded(&points, 0);
        let contrast = self.contrast(&pilot);
        let rest = (1.0 - FIRST_SHARE) * count;
        let then = if parts.placing == SamplePlacing::ByErrors {
            let errors = cross_errors(self.visible, &values(&pilot));
            let found = by_error(&first, &self.around(&squared(&pilot, &errors)));
            let halves = [scaled(&wanted, 0.5 * rest), scaled(&found, 0.5 * rest)];
            sums(&halves[0], &halves[1])
        } else {
            let by_contrast = |(metric, contrast): (&Option<Metric>, &f64)| {
                Some(metric.as_ref()?.times(contrast.max(MIN_CONTRAST)))
            };
            let wanted: Vec<_> = wanted.iter().zip(&contrast).map(by_contrast).collect();
            scaled(&wanted, rest)
        };
        self.both(&first, pilot, &then, rest)
    }

    /// Shades the samples `rest`, and returns all samples with their common metric.
    pub(crate) fn both(
        &mut self,
        first: &[Option<Metric>],
        pilot: Vec<(ShadedSample, f64)>,
        then: &[Option<Metric>],
        rest: f64,
    ) -> Vec<ShadedSample> {
        let points = self.points(then, rest, 1);
        let later = self.shaded(&points, pilot.len() as u64);
        let both = sums(first, then);
        self.told(&both);
        let all = pilot.into_iter().chain(later);
        all.map(|(sample, _)| ShadedSample {
            metric: both[self.visible.pixel_index(sample.at)].unwrap_or(sample.metric),
            ..sample
        })
        .collect()
    }

    /// The mean of squared errors around each pixel.
    pub(crate) fn around(&self, missed: &[ShadedSample]) -> Vec<f64> {
        let values = reconstruct_pixels(self.visible, missed, SampleFit::Mean);
        let of = |value: &Option<[f64; 2]>| value.map_or(0.0, |[error, _]| error);
        values.iter().map(of).collect()
    }

    /// The metrics of densities that are proportional to the squared bandwidth by a
    /// criterion.
    pub(crate) fn predicted(&mut self, by: BandwidthCriterion) -> Vec<Option<Metric>> {
        let (visible, camera) = (self.visible, self.shader.camera);
        let points = blockers::points(visible, by, self.plan.seed);
        (self.stage)(Stage::Blockers, points.len());
        let rays = self.plan.blocker_rays;
        let near = nearness(visible, &self.shader, (by, &points), rays, self.progress);
        (self.stage)(Stage::Criterion, 1);
        let squared = visible.pixels(|pixel @ [column, row]| {
            by.squared(visible, camera, pixel, near[row * visible.size[0] + column])
        });
        let root = |metric: &Option<Metric>| metric.map_or(f64::NAN, |m| m.largest().sqrt());
        let layers = &mut self.layers;
        layers.bandwidth = squared.iter().map(root).collect();
        layers.curvature = visible.pixels(|pixel| curvature(visible, pixel));
        layers.blockers = near.iter().map(|near| near.reflected).collect();
        match by {
            BandwidthCriterion::Printed => {
                let far = Nearness::default();
                let without = |pixel| root(&by.squared(visible, camera, pixel, far));
                layers.unoccluded = visible.pixels(without);
                squared
            }
            BandwidthCriterion::Corrected => {
                layers.shadow = near.iter().map(|near| near.shadow).collect();
                let wanted = |metric: &Option<Metric>| metric.map(|m| wanted(m, self.plan.is_even));
                squared.iter().map(wanted).collect()
            }
        }
    }

    pub(crate) fn points(
        &self,
        metrics: &[Option<Metric>],
        count: f64,
        round: u64,
    ) -> Vec<PicturePoint> {
        (self.stage)(Stage::Samples, 1);
        let count = whole(count.round());
        let seed = self.plan.seed.wrapping_add(round << 32);
        blue_noise(metrics, self.visible.size[0], count, seed)
    }

    pub(crate) fn shaded(&self, points: &[PicturePoint], first: u64) -> Vec<(ShadedSample, f64)> {
        (self.stage)(Stage::Shading, points.len());
        self.shader.shade(points, first, self.progress)
    }

    /// The relative standard deviation of samples around each pixel, after noise removal.
    fn contrast(&mut self, samples: &[(ShadedSample, f64)]) -> Vec<f64> {
        let wider: Vec<ShadedSample> = samples
            .iter()
            .map(|(sample, noise)| {
                // If a material has a single part, its texture causes no contrast, because the
                // picture is multiplied by the texture later.
                let factors = match sample.surface.factors {
                    [base, 0.0] => [1.0, base],
                    [base, lobe] => [base, lobe],
                };
                let light = factors[0] * sample.value[0] + factors[1] * sample.value[1];
                let noise = if sample.surface.factors[1] > 0.0 {
                    *noise
                } else {
                    noise / (factors[1] * factors[1])
                };
                ShadedSample {
                    metric: sample.metric.times(WIDER.powi(-2)),
                    value: [light, light * light - noise],
                    ..*sample
                }
            })
            .collect();
        let spread = |[mean, square]: [f64; 2]| [mean, (square - mean * mean).max(0.0)];
        let values = reconstruct_pixels(self.visible, &wider, SampleFit::Mean);
        let of = |value: &Option<[f64; 2]>| value.map_or([f64::NAN; 2], spread);
        let found: Vec<[f64; 2]> = values.iter().map(of).collect();
        self.layers.variance = found.iter().map(|[_, variance]| *variance).collect();
        let of_all: Vec<f64> = found.iter().map(|[mean, _]| *mean).collect();
        let seen = of_all.iter().filter(|mean| mean.is_finite());
        let typical = seen.clone().sum::<f64>() / seen.count().max(1) as f64;
        let relative = |[mean, variance]: &[f64; 2]| {
            let over = mean.abs() + 0.01 * typical;
            if variance.is_finite() && over > 0.0 {
                variance.sqrt() / over
            } else {
                0.0
            }
        };
        found.iter().map(relative).collect()
    }

    fn told(&mut self, metrics: &[Option<Metric>]) {
        let density = |metric: &Option<Metric>| metric.map_or(f64::NAN, |m| m.determinant().sqrt());
        self.layers.density = metrics.iter().map(density).collect();
    }

    /// Reconstructs the picture from samples.
    fn picture(mut self, mut samples: Vec<ShadedSample>) -> Rendered {
        (self.stage)(Stage::Reconstruction, 1);
        let mut values = self.reconstructed(&samples);
        let added = self.fill(&mut values, &mut samples);
        let [w, h] = self.visible.size;
        // The paper reconstructs means, at four points per pixel.
        let is_plane = self.plan.method.parts().fit == SampleFit::Plane;
        let further = is_plane.then_some(&self.shader);
        let radiance = self
            .visible
            .pixels(|pixel| edges::radiance(self.visible, further, &values, pixel));
        let mut counts = vec![0.0; w * h];
        for sample in &samples {
            counts[self.visible.pixel_index(sample.at)] += 1.0;
        }
        self.layers.samples = counts;
        Rendered {
            size: self.visible.size,
            radiance,
            points: samples.iter().map(|sample| sample.at).collect(),
            added,
            layers: self.layers,
        }
    }

    /// The light at all points. It is fitted to samples, or is the guide plus a fit to the
    /// differences between the samples and the guide.
    fn reconstructed(&self, samples: &[ShadedSample]) -> Vec<Option<[f64; 2]>> {
        let fit = self.plan.method.parts().fit;
        let Some(guide) = &self.guide else {
            return reconstruct(self.visible, samples, fit);
        };
        let left = guide.without(self.visible, samples);
        let mut values = reconstruct(self.visible, &left, fit);
        for (index, (value, place)) in values.iter_mut().zip(&self.visible.places).enumerate() {
            if let (Some(value), Some(surface)) = (value, shaded(place)) {
                let guide = guide.used(index, surface);
                *value = [0, 1].map(|part: usize| (value[part] + guide[part]).max(0.0));
            }
        }
        values
    }

    /// Shades one point of each small patch that is far from all samples, and uses the value of
    /// this point for the whole patch.
    fn fill(&self, values: &mut [Option<[f64; 2]>], samples: &mut Vec<ShadedSample>) -> usize {
        let wide = self.visible.size[0];
        let mut added: Vec<ShadedSample> = Vec::new();
        for (i, value) in values.iter_mut().enumerate() {
            let Some(surface) = shaded(&self.visible.places[i]).filter(|_| value.is_none()) else {
                continue;
            };
            let pixel = i / FOUR;
            let at = at([pixel % wide, pixel / wide], i % FOUR);
            let is_near = |sample: &&ShadedSample| {
                let far = [0, 1].map(|k: usize| (sample.at[k] - at[k]).abs());
                sample.surface.shape == surface.shape && far[0] < PATCH && far[1] < PATCH
            };
            if let Some(near) = added.iter().rev().take(RECENT).find(is_near) {
                *value = Some(near.value);
                continue;
            }
            let point = PicturePoint {
                at,
                metric: Metric::even(PATCH.powi(-2)),
            };
            let number = (self.plan.samples + added.len()) as u64;
            if let Some((sample, _)) = self.shader.one(&point, number) {
                *value = Some(sample.value);
                added.push(sample);
            }
        }
        let count = added.len();
        samples.append(&mut added);
        count
    }
}

/// Width in pixels of a patch that is far from all samples.
const PATCH: f64 = 2.0;

/// The distance is checked to this number of the most recently added samples, which lie in the last
/// few rows.
const RECENT: usize = 256;

/// Minimum contrast, because the first quarter of the samples may have missed the contrast.
const MIN_CONTRAST: f64 = 0.02;

/// Samples without the variance of their light.
pub(crate) fn values(samples: &[(ShadedSample, f64)]) -> Vec<ShadedSample> {
    samples.iter().map(|(sample, _)| *sample).collect()
}

/// The metrics that minimise the error. `missed` are the squared errors found with the
/// metrics `first`. A squared error e² at a density n requires the density (e² n²)^(1/3).
pub(crate) fn by_error(first: &[Option<Metric>], missed: &[f64]) -> Vec<Option<Metric>> {
    let pairs = first.iter().zip(missed);
    let of = |(metric, missed): (&Option<Metric>, &f64)| {
        let metric = (*metric)?;
        Some(metric.times(libm::cbrt(missed.max(1e-12) / metric.determinant().sqrt())))
    };
    pairs.map(of).collect()
}

/// The metrics of two sets of samples together: the sums of both metrics.
pub(crate) fn sums(a: &[Option<Metric>], b: &[Option<Metric>]) -> Vec<Option<Metric>> {
    let both = a.iter().zip(b);
    both.map(|(a, b)| Some(a.as_ref()?.plus(*b.as_ref()?)))
        .collect()
}
