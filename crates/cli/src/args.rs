use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use etendue_field::tidy;
use etendue_paper::Quality;
use etendue_pipeline::load::SceneSource;
use etendue_pipeline::photons::Save;
use etendue_scene::RunFile;
use etendue_store::Method;
use etendue_sweep::Request;
use etendue_sweep::values::{Setting, Sweep, setting, sweep};
use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

mod rays;
mod world;

pub(crate) use rays::RaysArgs;
pub(crate) use world::{ImportArgs, ProbeArgs, RenderArgs};

/// Measures the space-angle frequency content of light and compares it with theory.
#[derive(Debug, Parser)]
#[command(
    version,
    about,
    after_help = "Examples:
  etendue run scenes/fig9b.ron                          measure, predict, compare, draw
  etendue run scenes/fig9b.ron --photons 1e8 --out d    more photons, results in d
  etendue run scenes/fig9b.ron --set blockers.0.pitch=0.05
  etendue check scenes/fig9b.ron                        what the scene says, nothing traced
  etendue measure | predict | compare                   the stages of run, over files
  etendue diff results/fig9b out/fig9b                  two results of one scene
  etendue sweep scenes/fig9b.ron --set blockers.0.pitch=0.05..0.4:8

Exit codes: 0 pass, 1 disagreement, 2 bad input, 3 cannot run (directory, memory, interrupted), 4 undecided"
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Trace a scene, measure its spectra, predict them, compare and draw.
    Run(RunArgs),
    /// Measure a scene, whole or some of its batches, for `compare`.
    Measure(MeasureArgs),
    /// Predict a scene, for `compare`.
    Predict(PredictArgs),
    /// Print the commands that measure a scene in parts, on as many machines, and put them together.
    Split(SplitArgs),
    /// Compare what was measured with what was predicted; writes what `run` writes.
    Compare(CompareArgs),
    /// Validate a scene; print the chain read off it and the class of each plane; with --draw, draw it.
    Check(CheckArgs),
    /// Shrink the neighbourhood of the central ray: how fast the first-order chain comes to the exact prediction.
    Converge(ConvergeArgs),
    /// Compare two results of one scene: slices, parameters, predictions and the scenes, field by field.
    Diff(DiffArgs),
    /// Put the pages of several results side by side.
    Report(ReportArgs),
    /// Make figures of Durand et al. 2005 anew: measured and predicted, with data and recipe.
    Figure(FigureArgs),
    /// Run a scene with fields that take several values: one table of every plane's numbers, and curves.
    Sweep(SweepArgs),
    /// How fast a glossy reflection changes with angle: the paper's criteria, corrected and as printed, and measured.
    Bandwidth(BandwidthArgs),
    /// Covariance tracing beside the spectra of a scene: 4 × 4 matrices traced along the chain, exact and measured.
    Covariance(CovarianceArgs),
    /// Write a scene for another program, which then can be asked for the same light field.
    Export(ExportArgs),
    /// Read a scene of Mitsuba 3, and say what it holds and what is left out.
    Import(ImportArgs),
    /// Render what a camera of such a scene sees, with errors: by paths that end at any light.
    Render(RenderArgs),
    /// Measure the light field behind a pixel of such a scene, along the ray through it.
    Probe(ProbeArgs),
    /// Say what a ray file holds (IES TM-25, MCPL, NPY), and write its rays in another of these formats.
    Rays(RaysArgs),
    /// Print the JSON schema of scene files, or what it says as a page: each field with its range, default and an example.
    Schema(SchemaArgs),
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue run scenes/fig9b.ron
  etendue run scenes/fig9b.ron --photons 1e8 --seed 7 --threads 2 --out out/more
  etendue run scenes/fig9b.ron --set planes.3.at='Distance(1.5)' --save photons
  etendue run scenes/fig9b.ron --save mcpl,tm25                        rays for other programs (docs/rays.md)
  etendue run scenes/fig9b.ron --photons 2^33 --resume --time 2h      again and again, until it is done

Photon counts may be written 10_000_000, 1e7 or 2^23.
Powers of two have least noise, in 64 batches or 2^m.")]
pub(crate) struct RunArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Folder for the results [default: out/NAME]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) photons: PhotonArgs,

    #[command(flatten)]
    pub(crate) force: ForceArgs,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// Goes on until noise alone is at most this share of the spectrum at each plane: with 2^20
    /// photons first, then as many as that takes, up to --photons [default: 2^40]; exit code 3 if
    /// these do not do
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub(crate) target_error: Option<f64>,

    /// Go on from the batches that a run of the same command has left; several processes may share the work
    #[arg(long, conflicts_with_all = ["target_error", "expect"])]
    pub(crate) resume: bool,

    /// Begin no more batches after this time, such as 90s, 30m or 1h 30m; what is done is kept for --resume
    #[arg(long, value_name = "TIME", value_parser = humantime::parse_duration, conflicts_with = "target_error")]
    pub(crate) time: Option<Duration>,

    /// What else to keep
    #[arg(long, value_name = "WHAT", value_delimiter = ',', value_parser = saves())]
    pub(crate) save: Vec<Save>,

    /// A small folder for an archive: without CSV and SVG beside the pictures, and without the explorer
    #[arg(long)]
    pub(crate) compact: bool,

    /// Succeed when measured and predicted disagree, fail when they agree
    #[arg(long, value_name = "OUTCOME")]
    pub(crate) expect: Option<Expect>,

    /// Print nothing but errors
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue measure scenes/fig9b.ron --out out/all
  etendue measure scenes/fig9b.ron --photons 1e8 --batches 0..32 --out out/a     on one machine,
  etendue measure scenes/fig9b.ron --photons 1e8 --batches 32..64 --out out/b    on another

Batches of one scene, seed and photon count fit together, wherever they were measured.")]
pub(crate) struct MeasureArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Folder for the measurement
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    #[command(flatten)]
    pub(crate) photons: PhotonArgs,

    /// Batches to measure, A up to but without B [default: all]; --photons counts those of all
    #[arg(long, value_name = "A..B", value_parser = range, allow_hyphen_values = true)]
    pub(crate) batches: Option<Range<u32>>,

    #[command(flatten)]
    pub(crate) force: ForceArgs,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// Print nothing but errors
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue split scenes/fig9b.ron --photons 2^36 --parts 32               a command for each part, and two for the end
  etendue split scenes/fig9b.ron --photons 2^36 --parts 32 --slurm > job.sh && sh job.sh

Parts may run in any order, anywhere: the result has the bytes of one run.")]
pub(crate) struct SplitArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Parts, each of about as many batches
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) parts: u32,

    /// Print a script for Slurm: an array of jobs, and one that depends on all
    #[arg(long)]
    pub(crate) slurm: bool,

    /// Folder for the results, with those of the parts inside [default: out/NAME]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) photons: PhotonArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue predict scenes/fig9b.ron --out out/predicted
  etendue predict scenes/fig9b.ron --set blockers.0.pitch=0.05 --out out/narrow

A prediction serves measurements of its scene with any seed and number of photons.")]
pub(crate) struct PredictArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Folder for the prediction
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    /// Those of the measurement: where there is no theory, the other method measures as many
    #[command(flatten)]
    pub(crate) photons: PhotonArgs,

    #[command(flatten)]
    pub(crate) force: ForceArgs,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// Print nothing but errors
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue compare --measured out/all --predicted out/predicted --out out/fig9b
  etendue compare --measured out/a out/b --predicted out/predicted --out out/fig9b

Parts of a measurement may come in any order. 32 batches are enough; what is reported is of those there are.")]
pub(crate) struct CompareArgs {
    /// Folders of `etendue measure`: a measurement, whole or in parts
    #[arg(long, value_name = "DIR", num_args = 1.., required = true)]
    pub(crate) measured: Vec<PathBuf>,

    /// Folder of `etendue predict`
    #[arg(long, value_name = "DIR")]
    pub(crate) predicted: PathBuf,

    /// Folder for the results
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    #[command(flatten)]
    pub(crate) force: ForceArgs,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// Succeed when measured and predicted disagree, fail when they agree
    #[arg(long, value_name = "OUTCOME")]
    pub(crate) expect: Option<Expect>,

    /// Print nothing but errors
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue converge scenes/table1/concave_oblique.ron
  etendue converge scenes/table1/concave_oblique.ron --set as_printed=true      the paper's printed formulas stay off

Widths of light and windows times e, frequencies over e: the error of first-order maps falls as e, and as e² at normal incidence.
No order is given where an error is down to that of the quadrature.")]
pub(crate) struct ConvergeArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue diff results/fig9b out/fig9b                 of two versions of the program
  etendue diff out/seed1 out/seed2                     is a disagreement chance?
  etendue diff out/photons out/backward                of two methods

Tested are, over all planes together at level α: the measured slices, by χ² of their difference over both variances, and each
parameter of the chain, by its pull. Both results need noise of their own: other seeds, or other methods. Results with one
seed share photons; they are then the same number for number, or undecided. Predictions of one scene must be equal within
their stated errors. Of scenes with another window or other frequencies at a plane, the plane is not compared.

The test assumes that each result is a mean of many independent batches, so that its noise is normal, and that the noise of both
is correlated alike from frequency to frequency; where it is not, p is too large rather than too small.

Exit codes: 0 the same but for noise, 1 different, 2 bad input, 4 undecided")]
pub(crate) struct DiffArgs {
    /// Folder of `etendue run` or `compare`
    #[arg(value_name = "A")]
    pub(crate) a: PathBuf,

    /// Another
    #[arg(value_name = "B")]
    pub(crate) b: PathBuf,

    /// Probability of finding a difference where there is none
    #[arg(long, value_name = "SHARE", default_value = "1%", value_parser = share)]
    pub(crate) alpha: f64,
}

/// How a scene is measured, where it is not as the scene says.
#[derive(Debug, Args)]
pub(crate) struct PhotonArgs {
    /// Photons to emit, instead of the scene's
    #[arg(long, value_name = "N", value_parser = whole_number, allow_hyphen_values = true)]
    pub(crate) photons: Option<u64>,

    /// Seed of the photons, instead of the scene's
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,

    /// How light is measured
    #[arg(long, value_name = "METHOD", default_value = "photons", value_parser = methods())]
    pub(crate) method: Method,
}

/// Takes one of some values by its name; each has a line of help.
fn one_of<T: Copy + Send + Sync + 'static, const N: usize>(
    all: [(T, &'static str, &'static str); N],
) -> impl TypedValueParser<Value = T> {
    let names = all.map(|(_, name, help)| PossibleValue::new(name).help(help));
    PossibleValuesParser::new(names).try_map(move |text| {
        let mut all = all.iter();
        let found = all.find(|(_, name, _)| *name == text);
        found.map(|(value, ..)| *value).ok_or("no such value")
    })
}

/// The methods that a user may name.
fn methods() -> impl TypedValueParser<Value = Method> {
    let named = |method: Method, help| (method, method.name(), help);
    one_of([
        named(Method::Photons, "Photons from the light, forward"),
        named(
            Method::Backward,
            "Rays drawn in the window of each plane, traced back to the light",
        ),
    ])
}

/// How much work may go into a figure.
fn qualities() -> impl TypedValueParser<Value = Quality> {
    let named = |quality: Quality, help| (quality, quality.name(), help);
    one_of([
        named(
            Quality::Draft,
            "An eighth of the photons of the scenes, twice as many frequencies as they ask for along each axis",
        ),
        named(
            Quality::Print,
            "The photons of the scenes, four times as many frequencies",
        ),
    ])
}

impl PhotonArgs {
    /// Overrides what a scene says.
    pub(crate) fn set(&self, run: &mut RunFile) {
        run.photons = self.photons.unwrap_or(run.photons);
        run.seed = self.seed.unwrap_or(run.seed);
    }
}

#[derive(Debug, Args)]
pub(crate) struct ForceArgs {
    /// Replace files that etendue did not write, or that were changed since; each is named
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ThreadArgs {
    /// Threads [default: one for each core]; the results do not depend on it
    #[arg(long = "threads", value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) count: Option<u16>,
}

#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Draw the scene with its central ray and planes into this file (.png or .svg)
    #[arg(long, value_name = "FILE")]
    pub(crate) draw: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) force: ForceArgs,
}

#[derive(Debug, Args)]
pub(crate) struct SceneArgs {
    /// Scene file, in RON
    #[arg(value_name = "SCENE.ron")]
    pub(crate) path: PathBuf,

    /// Set a field of the scene, such as blockers.0.fill=0.5; may be repeated
    #[arg(long, value_name = "PATH=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,
}

impl SceneArgs {
    /// The scene, for the pipeline.
    pub(crate) fn source(&self) -> SceneSource {
        SceneSource {
            path: self.path.clone(),
            set: self.set.clone(),
        }
    }
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  etendue export --to mitsuba scenes/fig9b.ron --out out/mitsuba
  python tests/peers/mitsuba_light_field.py --help         records the same light field with Mitsuba and compares spectra")]
pub(crate) struct ExportArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// The program
    #[arg(long, value_name = "PROGRAM")]
    pub(crate) to: Program,

    /// Folder for its files [default: out/NAME-mitsuba]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) force: ForceArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  etendue report out/fig9a out/fig9b out/fig9c --out out/fig9.html

Each run leaves such a page of its own, report.html, among its results. It holds all it shows and asks nothing of the network.")]
pub(crate) struct ReportArgs {
    /// Folders of `etendue run` or `compare`
    #[arg(value_name = "DIR", required = true)]
    pub(crate) folders: Vec<PathBuf>,

    /// The page
    #[arg(long, value_name = "FILE", default_value = "out/report.html")]
    pub(crate) out: PathBuf,

    #[command(flatten)]
    pub(crate) force: ForceArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue figure 9
  etendue figure all --quality draft --out out/figures
  etendue figure my.ron                                      light field and spectra along the path of a scene of one's own
  etendue figure a.ron b.ron --plane receiver --out out      scenes side by side at a plane, in one range of colors

Figures of Durand et al. 2005: 1, 3 to 15, and table1. Those of kernels, 5 and 12, are theory alone; all others are measured,
and predicted beside it. Each has a folder with
  figure.png, .svg, .pdf   the PDF at most 7 inches wide, two columns of a journal; text is text
  figure.npz               light fields and spectra of all planes (docs/conventions.md)
  figure.csv               the numbers of curves and bars
  figure.json              whether each plane agrees with theory, and the command that makes the figure again
  NAME.ron                 its scenes; those of one's own stand in figure.json as they were run
Exit codes are those of run, of the worst plane.")]
pub(crate) struct FigureArgs {
    /// Figures of the paper (1, 3 to 15, table1, or all), or scene files, which make one figure
    #[arg(value_name = "NAME|SCENE.ron", required = true)]
    pub(crate) names: Vec<String>,

    /// Set a field of the scene files, such as blockers.0.fill=0.5; may be repeated
    #[arg(long, value_name = "PATH=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,

    /// The plane at which scene files are shown; of one scene file, it alone [default: of several the last, of one all]
    #[arg(long, value_name = "NAME")]
    pub(crate) plane: Option<String>,

    /// Folder of the figures
    #[arg(long, value_name = "DIR", default_value = "results/figures")]
    pub(crate) out: PathBuf,

    /// Looks, in RON; each field may be left out: (titles: false, scene: false, verdicts: false, width: 3.33,
    /// floor: -40, palette: Viridis). Titles go with their notes; the scene is the drawing above its planes; width is
    /// that of the page in inches, 3.3 to 7; floor that of spectra in dB; palettes are Inferno, Magma, Viridis and Cividis
    #[arg(long, value_name = "FILE")]
    pub(crate) style: Option<PathBuf>,

    /// How much work goes into it
    #[arg(long, value_name = "QUALITY", default_value = "print", value_parser = qualities())]
    pub(crate) quality: Quality,

    #[command(flatten)]
    pub(crate) force: ForceArgs,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// Print nothing but errors
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue sweep scenes/fig9b.ron --set blockers.0.pitch=0.05..0.4:8
  etendue sweep scenes/fig9b.ron --set blockers.0.pitch=0.05..0.4:4log --set blockers.0.fill=0.3,0.6 --photons 2^20
  etendue sweep scenes/fig9b.ron --together --set surfaces.0.center.2=1.5,2,3 --set surfaces.0.albedo=0.2,0.5,0.8

Leaves in its folder
  sweep.csv                            a row for each plane at each point and each number: the frequencies that hold 95 % of the power,
                                       the shear slope, and each parameter, measured with its standard error and predicted
  bandwidth_rho, bandwidth_nu, slope   curves over the field that is named first, as PNG, SVG and CSV; a grid with more than 24
                                       panels has none
  points/                              a run for each point: the same command goes on where it was stopped, and one with other
                                       values of the same fields runs only what is new
Values are numbers. Exit codes are those of run, of the worst point: one true point in a hundred fails by chance.")]
pub(crate) struct SweepArgs {
    /// Scene file, in RON
    #[arg(value_name = "SCENE.ron")]
    pub(crate) path: PathBuf,

    /// Set a field to a value, to N values from A to B (A..B:N; A..B:Nlog by equal factors) or to those of
    /// a list (A,B,C); may be repeated
    #[arg(long, value_name = "PATH=VALUES", value_parser = setting)]
    pub(crate) set: Vec<Setting>,

    /// All points have the seed of the scene or of --seed: differences between points have less noise, and their errors are not
    /// independent. Otherwise each point has a seed of its own, made from that seed and its values
    #[arg(long)]
    pub(crate) common_seed: bool,

    /// Several fields take their values in step, instead of in all combinations; each must have as many
    #[arg(long)]
    pub(crate) together: bool,

    /// Folder for the results [default: out/NAME-sweep]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) photons: PhotonArgs,

    #[command(flatten)]
    pub(crate) force: ForceArgs,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// Print nothing but errors
    #[arg(long)]
    pub(crate) quiet: bool,
}

impl SweepArgs {
    /// The sweep that is asked for.
    pub(crate) fn request(&self) -> Request {
        Request {
            path: self.path.clone(),
            set: self.set.clone(),
            common_seed: self.common_seed,
            together: self.together,
            photons: self.photons.photons,
            seed: self.photons.seed,
            method: self.photons.method,
            force: self.force.force,
        }
    }
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue bandwidth scenes/bandwidth.ron
  etendue bandwidth scenes/bandwidth.ron --measure --sweep surfaces.0.form.Sphere=-0.3..0.5:9
  etendue bandwidth scenes/bandwidth.ron --sweep surfaces.0.facing.0=0..1:5      tan of the angle of incidence
  etendue bandwidth scenes/bandwidth_edge.ron --measure --csv edge.csv

One row for each plane across the ray that leaves a smooth surface with a BRDF, and each value of the sweep; several sweeps go in step.
  k           curvature of the surface in the plane of incidence, 1/m, convex positive
  θ0, θ1      angles of incidence and of view, degrees, signed alike: in the mirror direction θ1 = −θ0
  d, d'       distance from the surface to the plane, and from the last blockers (without any, from the light) to the surface, m
  lobe        what holds 95 % of the energy of the lobe's spectrum, cycles per radian
  B, B'       what the reflection at d needs, cycles per unit slope: Eq. 20, light from far away, and Eq. 21, an edge or a narrow light at d'
  exact       with --measure: that of the predicted spectrum, window and light included; beside it the measured one and its standard error
Criteria say nothing of windows: those of the scene must hold the lobe, and its frequencies the spectrum.")]
pub(crate) struct BandwidthArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Trace the scene and measure the bandwidth; beside it stands that of the exact prediction
    #[arg(long)]
    pub(crate) measure: bool,

    /// Set a field to N values from A to B (A..B:N; A..B:Nlog by equal factors) or to those of a list (A,B,C);
    /// may be repeated
    #[arg(long, value_name = "PATH=VALUES", value_parser = sweep)]
    pub(crate) sweep: Vec<Sweep>,

    /// Write the table into this file too, with all digits
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) photons: PhotonArgs,

    #[command(flatten)]
    pub(crate) force: ForceArgs,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// No progress bars
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue covariance scenes/table1/glossy.ron
  etendue covariance scenes/fig9b.ron --plane receiver --photons 2^22 --out out/covariance

The covariance of the power spectrum |L|² over (ρx, ρy, νu, νv): ∫ P Ω Ωᵀ/∫ P, cycles² over the units of the coordinates.
  traced      by covariance tracing (Belcour et al. 2013) along the chain of the plane, its window last, at all frequencies
  in band     the same Gaussian within the plane's frequencies, as all that follows
  exact       of the predicted spectrum, between parallel planes; other planes have it at azimuth 0 alone
  measured    of the photons, noise taken out by crossing groups of batches, with standard errors
Light fields with edges have no such moments: theirs are of the band, and a remark says so. Photons are traced once, and once or twice
more for each plane, onto a 4D grid.
Leaves in its folder covariance.json, and for each plane covariance.png, .svg and .csv: the spectrum at azimuth 0 with ellipses.")]
pub(crate) struct CovarianceArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// The planes, by name; may be repeated [default: all]
    #[arg(long, value_name = "NAME")]
    pub(crate) plane: Vec<String>,

    /// Folder for the results [default: out/NAME-covariance]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) photons: PhotonArgs,

    #[command(flatten)]
    pub(crate) force: ForceArgs,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// Print nothing but errors
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue schema > docs/scene.schema.json
  etendue schema --page > docs/scene.md")]
pub(crate) struct SchemaArgs {
    /// Print the page, in Markdown
    #[arg(long)]
    pub(crate) page: bool,
}

/// What `--to` knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Program {
    /// Mitsuba 3: scene.xml, PLY files, and planes.json
    Mitsuba,
}

/// What `--save` keeps.
fn saves() -> impl TypedValueParser<Value = Save> {
    let named = |save: Save, help| (save, save.name(), help);
    one_of([
        named(
            Save::Photons,
            "Every photon that crossed a plane: photons.npy and photons.json, 40 bytes for each",
        ),
        named(
            Save::Mcpl,
            "The same photons as rays of the world with their power in W, photons.mcpl: 64 bytes for each",
        ),
        named(
            Save::Tm25,
            "The same as an IES TM-25 file in single precision, photons.tm25ray: 28 bytes for each",
        ),
        named(
            Save::Field,
            "The light field on a 4D grid, field.npy and field.json, and its full radial spectrum, full_radial.npz, which is predicted and compared too; takes another pass over the photons for each plane, or two where memory is short",
        ),
    ])
}

/// What `--expect` may expect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Expect {
    /// Photons must agree with the exact predictions, and a first-order chain must have a wrong map.
    Disagreement,
}

fn assignment(text: &str) -> Result<(String, String), String> {
    let (path, value) = text.split_once('=').ok_or("must be PATH=VALUE")?;
    Ok((path.trim().to_owned(), value.trim().to_owned()))
}

/// Batches A..B, at least one.
fn range(text: &str) -> Result<Range<u32>, String> {
    let ends = text.split_once("..").map(|(a, b)| (a.parse(), b.parse()));
    match ends {
        Some((Ok(start), Ok(end))) if start < end => Ok(start..end),
        _ => Err("must be A..B, whole numbers with A < B".to_owned()),
    }
}

/// Shares without a unit are below this: a larger number is likely a percentage.
const MAX_PLAIN_SHARE: f64 = 0.05;

/// A share in (0, 1] in per cent, or a small one as a number.
fn share(text: &str) -> Result<f64, String> {
    let fault = || "must be a share of the spectrum, such as 0.1% or 0.001".to_owned();
    let parsed = |number: &str| number.trim().parse().ok().filter(|x: &f64| *x > 0.0);
    if let Some(number) = text.trim().strip_suffix('%') {
        let share = parsed(number).map(|percent| 0.01 * percent);
        return share.filter(|share| *share <= 1.0).ok_or_else(fault);
    }
    match parsed(text) {
        Some(share) if share < MAX_PLAIN_SHARE => Ok(share),
        Some(percent) if percent <= 100.0 => Err(format!(
            "a number without % must be below {MAX_PLAIN_SHARE}: for {percent} per cent write {percent}% or {}",
            tidy(0.01 * percent)
        )),
        _ => Err(fault()),
    }
}

/// A whole number, also as 10_000_000, 1e7 or 2^23.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "checked to be a whole number that f64 holds exactly"
)]
fn whole_number(text: &str) -> Result<u64, String> {
    let digits = text.replace('_', "");
    if let Ok(n) = digits.parse() {
        return Ok(n);
    }
    let power = digits.strip_prefix("2^").and_then(|m| m.parse().ok());
    if let Some(number) = power.and_then(|m: u32| 1_u64.checked_shl(m)) {
        return Ok(number);
    }
    let x: f64 = digits.parse().map_err(|_| "must be a whole number")?;
    if (0.0..=9.0e15).contains(&x) && x.fract() == 0.0 {
        Ok(x as u64)
    } else {
        Err("must be a whole number from 0 to 9e15".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::share;

    #[test]
    fn a_large_share_needs_its_unit() {
        assert_eq!(share("0.3%"), share("0.003"));
        assert_eq!(share("30 %"), Ok(0.3));
        assert_eq!(share("0.049"), Ok(0.049));
        for (text, advice) in [
            ("0.3", "write 0.3% or 0.003"),
            ("0.05", "write 0.05% or 0.0005"),
            ("2", "write 2% or 0.02"),
        ] {
            let message = share(text).err().unwrap_or_default();
            assert!(message.contains(advice), "{text}: {message}");
        }
        for text in ["0", "-1%", "101%", "101", "nan", "inf%", "x"] {
            assert!(share(text).is_err(), "{text}");
        }
    }
}
