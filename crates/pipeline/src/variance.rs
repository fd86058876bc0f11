//! Predicts and finds the Monte Carlo error of the mean radiance over a window.

use crate::field::check_grid;
use crate::reporter::{Reporter, Work};
use crate::{method, planes};
use etendue_field::PhotonSource;
use etendue_scene::Scene;
use etendue_spectrum::Uncertain;
use etendue_store::{ArgumentStyle, Failure, Method, VERSION};
use etendue_variance::{
    AXES, AxisSetPower, DEFAULT_FREQUENCIES, DEFAULT_SETS, MeasuredPower, PointCounts,
    PowerEstimate, Sampler, SamplerReport, VarianceError, WindowMoments, WindowRadiance,
    WindowStudy, axis_sets, dyadic_power, field_options, with_box_window,
};

/// A request for the variances of samplers at a plane.
#[derive(Debug)]
pub struct VarianceStudy {
    /// The scene that sees only the plane, through Box windows.
    scene: Scene,
    radiance: WindowRadiance,
    options: VarianceOptions,
}

/// What is measured, predicted and found.
#[derive(Clone, Debug)]
pub struct VarianceOptions {
    /// The source of the photons.
    pub method: Method,
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
    /// The style in which messages name arguments.
    pub arguments: ArgumentStyle,
}

impl VarianceOptions {
    /// Returns the default options: all samplers that are not files.
    #[must_use]
    pub fn new(method: Method, arguments: ArgumentStyle) -> Self {
        Self {
            method,
            frequencies: DEFAULT_FREQUENCIES,
            samplers: Sampler::NAMES
                .into_iter()
                .filter_map(Sampler::named)
                .flatten()
                .collect(),
            counts: PointCounts::default(),
            shifts: DEFAULT_SETS,
            unshifted: false,
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
#[derive(Debug)]
pub struct PlaneVariance {
    /// Name of the plane.
    pub plane: String,
    /// Half-widths of the window along (x, u, y, v), in metres and slope.
    pub half_widths: [f64; 4],
    /// The mean of the radiance over the window, by photons.
    pub mean_by_photons: Uncertain,
    /// The moments of the radiance over the window, by rays traced back.
    pub moments: WindowMoments,
    /// The power at the measured frequencies, as a share of σ².
    pub inside: f64,
    /// The power by set of nonzero axes.
    pub axis_sets: Vec<AxisSetPower>,
    /// The variances of each sampler.
    pub samplers: Vec<SamplerReport>,
}

impl VarianceStudy {
    /// Checks that a plane of a scene can be studied. If no name is given, it is the only plane.
    pub fn new(
        scene: &Scene,
        plane: Option<&str>,
        options: VarianceOptions,
    ) -> Result<Self, Failure> {
        options.check()?;
        let plane = planes::chosen(scene, plane, options.arguments)?;
        let scene = with_box_window(scene, plane, options.frequencies);
        let radiance = WindowRadiance::new(&scene).map_err(failure)?;
        Ok(Self {
            scene,
            radiance,
            options,
        })
    }

    /// Returns the window of the plane, as half-widths along (x, u, y, v).
    fn half_widths(&self) -> [f64; 4] {
        let window = self.scene.planes[0].window;
        [window.x, window.u, window.y, window.v].map(|p| p.half_width())
    }

    /// Fails if the grids of all groups of photons do not fit into memory.
    pub fn check_memory(&self) -> Result<(), Failure> {
        let options = field_options();
        let grid = options.grid(&self.scene.planes[0]);
        let arguments = self.options.arguments;
        let argument = arguments.with("frequencies", self.options.frequencies);
        let name = format!("{argument}: the grid");
        // Grids of groups are kept, and then their spectra are.
        check_grid(&name, &grid, &options)
    }

    /// Measures the plane, and predicts and finds the variances of each sampler.
    pub fn run(&self, reporter: &dyn Reporter) -> Result<PlaneVariance, Failure> {
        let Self {
            scene,
            radiance,
            options,
        } = self;
        let source = method::source(scene, options.method)?;
        let bar = reporter.begin(Work::Photons(scene.run.photons));
        let power = MeasuredPower::measure(scene, &*source, options.frequencies, &|photons| {
            bar.advance(photons);
        });
        drop(bar);
        let power = power.map_err(failure)?;
        let bands = self.bands(&*source, reporter)?;
        let steps = WindowRadiance::steps();
        let bar = reporter.begin(Work::Steps {
            verb: "tracing back",
            total: self.sets() + usize::try_from(steps).unwrap_or_default(),
            things: "sets of rays",
        });
        let progress = |sets: u64| bar.advance(sets);
        let moments = radiance.moments(scene.run.seed, &progress);
        if moments.variance.value <= 0.0 {
            return Err(Failure::bad_input(format!(
                "{}: the radiance is the same over the whole window, so its mean has no error",
                scene.planes[0].name
            )));
        }
        let study = WindowStudy {
            power: &power,
            bands: bands.as_ref(),
            radiance,
            moments: &moments,
            sets: options.shifts,
            seed: scene.run.seed,
        };
        let samplers = options.samplers.iter();
        let reports =
            samplers.map(|sampler| study.sampler(sampler, options.counts.all(), &progress));
        Ok(PlaneVariance {
            plane: scene.planes[0].name.clone(),
            half_widths: self.half_widths(),
            mean_by_photons: power.mean,
            inside: power.spectrum.total() / moments.variance.value,
            axis_sets: axis_sets(&power, &moments),
            samplers: reports.collect(),
            moments,
        })
    }

    /// Traces the photons once more, and returns their power in dyadic bands, if it is requested.
    fn bands(
        &self,
        source: &dyn PhotonSource,
        reporter: &dyn Reporter,
    ) -> Result<Option<PowerEstimate>, Failure> {
        if !self.options.unshifted {
            return Ok(None);
        }
        let bar = reporter.begin(Work::Photons(self.scene.run.photons));
        let bands = dyadic_power(&self.scene, source, &|photons| bar.advance(photons));
        bands.map(Some).map_err(failure)
    }

    /// Returns the number of sets of points with which errors are found.
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

    /// Returns what is measured, predicted and found.
    #[must_use]
    pub fn options(&self) -> &VarianceOptions {
        &self.options
    }

    /// Returns the content of the index, without its list of files. `scene` is the scene before its
    /// windows were replaced.
    #[must_use]
    pub fn index(&self, scene: &Scene, found: &PlaneVariance) -> serde_json::Value {
        let options = &self.options;
        serde_json::json!({
            "scene": scene.name,
            "scene_hash": scene.hash(),
            "scene_file": scene.file,
            "version": VERSION,
            "seed": scene.run.seed,
            "method": options.method,
            "photons": scene.run.photons,
            "plane": found.plane,
            "window": { "profile": "Box", "half_widths": found.half_widths },
            "axes": AXES,
            "frequencies": options.frequencies,
            "shifts": options.shifts,
            "mean_by_photons": found.mean_by_photons,
            "mean_by_rays": found.moments.mean,
            "variance": found.moments.variance,
            "noise": found.moments.noise,
            "inside": found.inside,
            "axis_sets": found.axis_sets,
            "samplers": found.samplers,
        })
    }
}

impl PlaneVariance {
    /// Checks whether a prediction is undecided.
    #[must_use]
    pub fn is_undecided(&self) -> bool {
        let curves = self.samplers.iter().map(|sampler| &sampler.shifted);
        let mut counts = curves.flat_map(|curve| &curve.counts);
        counts.any(|count| count.is_undecided)
    }
}

/// Returns the failure for a plane that cannot be studied.
fn failure(error: VarianceError) -> Failure {
    match error {
        VarianceError::TooFewBatches(_) => Failure::bad_input(format!("run.batches: {error}")),
        _ => Failure::bad_input(error),
    }
}
