//! Predicts and finds the Monte Carlo error of the mean radiance over a window.

use super::{
    AXES, AxisSetPower, DEFAULT_FREQUENCIES, DEFAULT_SETS, LightPoints, MeasuredPower, PointCounts,
    PowerEstimate, Sampler, SamplerReport, VarianceError, WindowMoments, WindowRadiance,
    WindowStudy, axis_sets, dyadic_power, field_options, with_box_window,
};
use crate::index::with_scene;
use etendue_field::{PhotonSource, VirtualPlane};
use etendue_pipeline::field::check_grid;
use etendue_pipeline::{Reporter, Work, limits, method, planes};
use etendue_scene::Scene;
use etendue_spectrum::Uncertain;
use etendue_store::{ArgumentStyle, Failure, Method};

/// The smallest variance over the window, in standard errors, that is told from noise.
const MIN_VARIATION: f64 = 4.0;
/// The relative variance of a constant radiance, because of rounding.
const ROUNDING: f64 = 1e-12;

/// What is said of a radiance that is the same over the whole window.
pub const CONSTANT: &str =
    "within its noise, the radiance is the same over the whole window: there is nothing to predict";

/// The light at a plane with Box windows.
pub struct WindowLight<'a> {
    /// The plane.
    pub plane: VirtualPlane,
    /// The source of photons whose plane 0 is this plane.
    pub source: Box<dyn PhotonSource + 'a>,
    /// Number of batches of photons.
    pub batches: u32,
    /// Number of photons.
    pub photons: u64,
    /// The radiance along rays of the window.
    pub radiance: WindowRadiance<'a>,
    /// The seed of the points of samplers.
    pub seed: u64,
}

impl std::fmt::Debug for WindowLight<'_> {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            plane, radiance, ..
        } = self;
        to.debug_struct("WindowLight")
            .field("plane", plane)
            .field("radiance", radiance)
            .finish_non_exhaustive()
    }
}

/// A request for the variances of samplers at a plane.
#[derive(Debug)]
pub struct VarianceStudy<'a> {
    light: WindowLight<'a>,
    /// What is measured, predicted and found.
    pub options: VarianceOptions,
}

/// What is measured, predicted and found.
#[derive(Clone, Debug)]
pub struct VarianceOptions {
    /// The largest measured frequency along each axis.
    pub frequencies: usize,
    /// The samplers, with the points of files.
    pub samplers: Vec<Sampler>,
    /// The numbers of points.
    pub counts: PointCounts,
    /// Number of sets of points with which each variance is found.
    pub shifts: u32,
    /// Whether variances of sets without shifts are predicted and found too.
    pub unshifted: bool,
    /// Whether points on the light are coordinates, in the places of the slopes u and v.
    pub light_points: bool,
    /// The style in which messages name arguments.
    pub arguments: ArgumentStyle,
}

impl VarianceOptions {
    /// The default options: all samplers that are not files.
    #[must_use]
    pub fn new(arguments: ArgumentStyle) -> Self {
        Self {
            frequencies: DEFAULT_FREQUENCIES,
            samplers: Sampler::NAMES
                .into_iter()
                .filter_map(Sampler::named)
                .flatten()
                .collect(),
            counts: PointCounts::default(),
            shifts: DEFAULT_SETS,
            unshifted: false,
            light_points: false,
            arguments,
        }
    }

    /// Fails if no sampler has sets of the numbers of points.
    fn check(&self) -> Result<(), Failure> {
        let counts = self.counts.all();
        if self.samplers.iter().any(|s| !s.counts(counts).is_empty()) {
            return Ok(());
        }
        let shown: Vec<String> = counts.iter().map(usize::to_string).collect();
        Err(Failure::bad_input(format!(
            "{}: no sampler has sets of so many points; allowed: n^4 for jitter, 2^k for sobol, n^2 for padded, any number for independent and lhs",
            self.arguments.with("counts", shown.join(","))
        )))
    }
}

/// The predicted and found variances at a plane.
#[derive(Clone, Debug)]
pub struct PlaneVariance {
    /// Name of the plane.
    pub plane: String,
    /// The seed of the points of samplers.
    pub seed: u64,
    /// Number of photons behind the spectrum.
    pub photons: u64,
    /// Half-widths of the window along (x, u, y, v), in metres and slope.
    pub half_widths: [f64; 4],
    /// The mean of the radiance over the window, by photons.
    pub mean_by_photons: Uncertain,
    /// The moments of the radiance over the window, by rays traced back.
    pub moments: WindowMoments,
    /// The power at the measured frequencies, as a share of σ².
    pub inside: f64,
    /// Whether the power of the last measured octave is above its noise. Otherwise the tail counts as
    /// for independent points.
    pub has_last_octave: bool,
    /// The power by set of nonzero axes.
    pub axis_sets: Vec<AxisSetPower>,
    /// The variances of each sampler.
    pub samplers: Vec<SamplerReport>,
}

impl<'a> VarianceStudy<'a> {
    /// Checks that a plane of a scene can be studied. If no name is given, it is the only plane.
    pub fn of_scene(
        scene: &Scene,
        (plane, method): (Option<&str>, Method),
        options: VarianceOptions,
    ) -> Result<Self, Failure> {
        options.check()?;
        limits::check_one_light(scene, "a prediction of Monte Carlo errors")?;
        let plane = planes::chosen(scene, plane, options.arguments)?;
        let mut scene = with_box_window(scene, plane, options.frequencies);
        let points = options
            .light_points
            .then(|| LightPoints::new(&scene, options.frequencies))
            .transpose()
            .map_err(failure)?;
        if let Some(points) = &points {
            scene.planes = vec![points.seen.clone()];
        }
        let mut light = WindowLight {
            plane: scene.planes[0].clone(),
            source: method::source(&scene, method)?,
            batches: scene.run.batches,
            photons: scene.run.photons,
            radiance: WindowRadiance::new(&scene).map_err(failure)?,
            seed: scene.run.seed,
        };
        if let Some(points) = points {
            light.source = points.photons(light.source);
            light.radiance = points.radiance(light.radiance);
            light.plane = points.plane;
        }
        Ok(Self { light, options })
    }

    /// Checks that light at a plane can be studied.
    pub fn of_light(light: WindowLight<'a>, options: VarianceOptions) -> Result<Self, Failure> {
        options.check()?;
        Ok(Self { light, options })
    }

    /// Fails if the grids of all groups of photons do not fit into memory.
    pub fn check_memory(&self) -> Result<(), Failure> {
        let Self { light, options } = self;
        let argument = options.arguments.with("frequencies", options.frequencies);
        // Grids of groups are kept, and then their spectra are.
        let kept = field_options();
        check_grid(
            &format!("{argument}: the grid"),
            &kept.grid(&light.plane),
            &kept,
        )
    }

    /// Measures the plane, and predicts and finds the variances of each sampler. Returns `None` if
    /// the radiance is the same over the whole window.
    pub fn run(&self, reporter: &dyn Reporter) -> Result<Option<PlaneVariance>, Failure> {
        let Self { light, options } = self;
        let (plane, window, seed) = (&light.plane, light.plane.window, light.seed);
        let photons = (&*light.source, light.batches);
        let bar = reporter.begin(Work::Photons(light.photons));
        let power = MeasuredPower::measure(plane, photons, options.frequencies, &|photons| {
            bar.advance(photons);
        });
        drop(bar);
        let power = power.map_err(failure)?;
        let bands = self.bands(reporter)?;
        let steps = WindowRadiance::steps();
        let bar = reporter.begin(Work::Steps {
            verb: "tracing back",
            total: self.sets() + usize::try_from(steps).unwrap_or_default(),
            things: "sets of rays",
        });
        let progress = |sets: u64| bar.advance(sets);
        let moments = light.radiance.moments(seed, &progress);
        let Uncertain { value, error } = moments.variance;
        let rounding = ROUNDING * moments.mean.value.powi(2);
        if value <= (MIN_VARIATION * error).max(rounding) {
            return Ok(None);
        }
        let study = WindowStudy {
            power: &power,
            bands: bands.as_ref(),
            radiance: &light.radiance,
            moments: &moments,
            sets: options.shifts,
            seed,
        };
        let samplers = options.samplers.iter();
        let reports =
            samplers.map(|sampler| study.sampler(sampler, options.counts.all(), &progress));
        Ok(Some(PlaneVariance {
            plane: plane.name.clone(),
            seed,
            photons: light.photons,
            half_widths: [window.x, window.u, window.y, window.v].map(|p| p.half_width()),
            mean_by_photons: power.mean,
            inside: power.spectrum.total() / moments.variance.value,
            has_last_octave: power.spectrum.has_last_octave(),
            axis_sets: axis_sets(&power, &moments),
            samplers: reports.collect(),
            moments,
        }))
    }

    /// Traces the photons once more, and returns their power in dyadic bands, if it is requested.
    fn bands(&self, reporter: &dyn Reporter) -> Result<Option<PowerEstimate>, Failure> {
        if !self.options.unshifted {
            return Ok(None);
        }
        let light = &self.light;
        let bar = reporter.begin(Work::Photons(light.photons));
        let photons = (&*light.source, light.batches);
        let bands = dyadic_power(&light.plane, photons, &|photons| bar.advance(photons));
        bands.map(Some).map_err(failure)
    }

    /// The failure for a radiance that is the same over the whole window.
    #[must_use]
    pub fn constant(&self) -> Failure {
        Failure::bad_input(format!("{}: {}", self.light.plane.name, CONSTANT))
    }

    /// The number of sets of points with which errors are found.
    fn sets(&self) -> usize {
        let VarianceOptions {
            samplers,
            counts,
            unshifted,
            shifts,
            ..
        } = &self.options;
        let curves = |sampler: &Sampler| match sampler {
            Sampler::Independent | Sampler::File(_) => 1,
            _ => 1 + usize::from(*unshifted),
        };
        let sets = samplers
            .iter()
            .map(|s| s.counts(counts.all()).len() * curves(s));
        sets.sum::<usize>() * *shifts as usize
    }

    /// The content of the index of a scene, without its list of files. `scene` is the scene
    /// before its windows were replaced.
    #[must_use]
    pub fn index(
        &self,
        (scene, method): (&Scene, Method),
        found: &PlaneVariance,
    ) -> serde_json::Value {
        let mut tree = with_scene(found.tree(&self.options), scene);
        tree["method"] = serde_json::json!(method);
        tree
    }
}

impl PlaneVariance {
    /// The result as JSON, without the scene.
    #[must_use]
    pub fn tree(&self, options: &VarianceOptions) -> serde_json::Value {
        serde_json::json!({
            "seed": self.seed,
            "photons": self.photons,
            "plane": self.plane,
            "window": { "profile": "Box", "half_widths": self.half_widths },
            "axes": AXES,
            "light_points": options.light_points,
            "frequencies": options.frequencies,
            "shifts": options.shifts,
            "mean_by_photons": self.mean_by_photons,
            "mean_by_rays": self.moments.mean,
            "variance": self.moments.variance,
            "noise": self.moments.noise,
            "inside": self.inside,
            "has_last_octave": self.has_last_octave,
            "axis_sets": self.axis_sets,
            "samplers": self.samplers,
        })
    }

    /// Checks whether a prediction is undecided.
    #[must_use]
    pub fn is_undecided(&self) -> bool {
        let curves = self.samplers.iter().map(|sampler| &sampler.shifted);
        let mut counts = curves.flat_map(|curve| &curve.counts);
        counts.any(|count| count.is_undecided)
    }
}

/// The failure for a plane that cannot be studied.
fn failure(error: VarianceError) -> Failure {
    match error {
        VarianceError::TooFewBatches(_) => Failure::bad_input(format!("run.batches: {error}")),
        _ => Failure::bad_input(error),
    }
}
