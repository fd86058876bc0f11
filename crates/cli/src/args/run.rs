//! Arguments of commands on scenes: run and its stages, checks and comparisons.

use super::shared::{
    FolderArgs, ForceArgs, PhotonArgs, SceneArgs, StageFolderArgs, ThreadArgs, WorkArgs, one_of,
    share, within,
};
use clap::builder::TypedValueParser;
use clap::{Args, ValueEnum};
use etendue_pipeline::Run;
use etendue_pipeline::load::SceneSource;
use etendue_pipeline::photons::Save;
use etendue_store::{Failure, Method};
use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  etendue run scenes/fig9b.ron
  etendue run scenes/fig9b.ron --photons 1e8 --seed 7 --threads 2 --out out/more
  etendue run scenes/fig9b.ron --set planes.3.at='Distance(1.5)' --save photons
  etendue run scenes/fig9b.ron --save mcpl,tm25                    rays for other programs
                                                                   (docs/rays.md)
  etendue run scenes/fig9b.ron --photons 2^33 --resume --time 2h   repeat until done
  etendue run scenes/colors.ron --rgb                              one result for each channel
  etendue run tilted.ron --against straight.ron                    less noise, if they are alike

Results are in out/NAME unless --out names another folder. Photon counts may be written as 10_000_000, 1e7 \
or 2^23.

Exit codes: 0 pass, 1 disagreement, 2 bad input, 3 cannot run (folder, memory, interruption), 4 undecided")]
pub(crate) struct RunArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    #[command(flatten)]
    pub(crate) out: FolderArgs,

    #[command(flatten)]
    pub(crate) photons: PhotonArgs,

    /// Trace photons until their noise at each plane is at most this share of the spectrum. The run
    /// begins with 2^20 photons and stops at --photons [default: 2^40]; the exit code is 3 if this
    /// number does not suffice. The noise does not include errors of predictions
    #[arg(long, value_name = "SHARE", value_parser = share, allow_hyphen_values = true)]
    pub(crate) target_error: Option<f64>,

    /// Continue from the batches that an earlier run of the same command has kept; several processes may share the work
    #[arg(long, conflicts_with_all = ["target_error", "expect"])]
    pub(crate) resume: bool,

    /// Begin no new batch after this time, such as 90s, 30m or 1h 30m; finished batches are kept for --resume
    #[arg(long, value_name = "TIME", value_parser = time, allow_hyphen_values = true, conflicts_with = "target_error")]
    pub(crate) time: Option<Duration>,

    /// Measure the scene by its difference from this scene, whose planes must have a theory: the same
    /// photons are traced through both, and the prediction of this scene is added. The difference
    /// has less noise the more alike the scenes are. The seed and the settings of the run are those
    /// of SCENE.ron
    #[arg(long, value_name = "OTHER.ron", conflicts_with_all = ["target_error", "rgb", "save"])]
    pub(crate) against: Option<PathBuf>,

    /// Run the scene once for each of red, green and blue, with the same seed. The results are in
    /// folders of these names, beside a page that shows all three
    #[arg(long, conflicts_with = "color")]
    pub(crate) rgb: bool,

    /// Additional data to save
    #[arg(long, value_name = "WHAT", value_delimiter = ',', value_parser = saves())]
    pub(crate) save: Vec<Save>,

    /// Write a small folder for an archive, without CSV and SVG versions of the pictures
    #[arg(long)]
    pub(crate) compact: bool,

    /// Succeed if measurement and prediction disagree, fail if they agree
    #[arg(long, value_name = "OUTCOME")]
    pub(crate) expect: Option<Expect>,

    /// Print summary.json instead of tables
    #[arg(long, conflicts_with = "rgb")]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) work: WorkArgs,
}

impl RunArgs {
    /// The run; the scene of `--against` has its settings.
    pub(crate) fn run(&self) -> Result<Run, Failure> {
        let run = self.photons.run(&self.scene)?;
        let Some(path) = &self.against else {
            return Ok(run);
        };
        if run.method != Method::Photons {
            return Err(Failure::bad_input(
                "--against traces photons; allowed: --method photons",
            ));
        }
        let settings = &run.scene.file.run;
        let source = SceneSource::file(path, &[]);
        let other = Run::read(&source, run.method, |run| *run = settings.clone())?;
        run.against(other)
    }

    /// Checks whether the command prints no tables.
    pub(crate) fn is_quiet(&self) -> bool {
        self.work.quiet || self.json
    }
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue measure scenes/fig9b.ron --out out/all
  etendue measure scenes/fig9b.ron --photons 1e8 --batches 0..32 --out out/a    on one machine,
  etendue measure scenes/fig9b.ron --photons 1e8 --batches 32..64 --out out/b   on another

Batches with the same scene, seed and photon count can be combined, even if different machines measured them.")]
pub(crate) struct MeasureArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    #[command(flatten)]
    pub(crate) out: StageFolderArgs,

    #[command(flatten)]
    pub(crate) photons: PhotonArgs,

    /// Measure only the batches A to B, excluding B [default: all]; --photons is still the number
    /// of photons in all batches of the scene
    #[arg(long, value_name = "A..B", value_parser = range, allow_hyphen_values = true)]
    pub(crate) batches: Option<Range<u32>>,

    #[command(flatten)]
    pub(crate) work: WorkArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue split scenes/fig9b.ron --photons 2^36 --parts 32   print a command for each part,
                                                             then predict and compare
  etendue split scenes/fig9b.ron --photons 2^36 --parts 32 --slurm > job.sh && sh job.sh

Parts may run in any order on any machine; the result has the same bytes as the result of a single run. \
The results folder, which is out/NAME unless --out names another, contains the folders of the parts.")]
pub(crate) struct SplitArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Number of parts, which all have about the same number of batches
    #[arg(long, value_name = "N", value_parser = within::<u32>(1..=u32::MAX.into()))]
    pub(crate) parts: u32,

    /// Print a script for Slurm: an array of jobs, and a last job that depends on all of them
    #[arg(long)]
    pub(crate) slurm: bool,

    #[command(flatten)]
    pub(crate) out: FolderArgs,

    #[command(flatten)]
    pub(crate) photons: PhotonArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue predict scenes/fig9b.ron --out out/predicted
  etendue predict scenes/fig9b.ron --set blockers.0.pitch=0.05 --out out/narrow

A prediction can be compared with any measurement of the same scene, whatever its seed and number of photons.")]
pub(crate) struct PredictArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    #[command(flatten)]
    pub(crate) out: StageFolderArgs,

    /// Also write the predictions as one file, predictions.npz, as `compare --theory` reads it
    #[arg(long)]
    pub(crate) npz: bool,

    /// Photons, seed and method of the measurement. At planes without a theory, the other tracer
    /// takes the place of the prediction, with the same number of photons
    #[command(flatten)]
    pub(crate) photons: PhotonArgs,

    #[command(flatten)]
    pub(crate) work: WorkArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue compare --measured out/all --predicted out/predicted --out out/fig9b
  etendue compare --measured out/a out/b --predicted out/predicted --out out/fig9b
  etendue compare --measured out/all --theory mine.npz --out out/mine

Parts of a measurement may be given in any order. At least 32 batches are needed; the report covers only \
the given batches.")]
pub(crate) struct CompareArgs {
    /// Folders written by `etendue measure`, with all or some of the batches
    #[arg(long, value_name = "DIR", num_args = 1.., required = true)]
    pub(crate) measured: Vec<PathBuf>,

    /// Folder written by `etendue predict`
    #[arg(long, value_name = "DIR", required_unless_present = "theory")]
    pub(crate) predicted: Option<PathBuf>,

    /// File of another program's predictions (.npz), in place of --predicted
    #[arg(long, value_name = "FILE", conflicts_with = "predicted")]
    pub(crate) theory: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) out: StageFolderArgs,

    /// Succeed if measurement and prediction disagree, fail if they agree
    #[arg(long, value_name = "OUTCOME")]
    pub(crate) expect: Option<Expect>,

    #[command(flatten)]
    pub(crate) work: WorkArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue converge scenes/table1/concave_oblique.ron
  etendue converge scenes/table1/concave_oblique.ron --set as_printed=true
      the error of the paper's printed formulas does not fall

Light and windows are multiplied by e, and frequencies are divided by e. The error of first-order maps is \
then proportional to e, or to e² at normal incidence. No order is printed where fewer than \
three errors are clearly above the error of the sums over rays.")]
pub(crate) struct ConvergeArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue diff results/fig9b out/fig9b    two versions of the program
  etendue diff out/seed1 out/seed2        was a disagreement due to chance?
  etendue diff out/photons out/backward   two methods
  etendue diff out/before out/after       the same seed, both with --save batches

Tests two kinds of numbers at level α, over all planes together. The test of the measured slices is χ²: \
the squared difference divided by the sum of both variances. The test of each parameter of the chain is \
the difference divided by its standard error. If both results have the same scene, their predictions must \
be equal within the stated errors. A plane whose window or frequencies differ between the results is not \
compared.

Results with the same seed share photons. If both have batches (run --save batches, or measure), batches \
are subtracted in pairs, so that most of their noise cancels; this shows what changed, not whether theory \
is right. Without batches, they are either identical or undecided.

For results with other seeds or methods, the test makes two assumptions. Each result is a mean of many \
independent batches, so that its noise is normal. Noise is correlated between frequencies in the same way \
in both results. If an assumption does not hold, p is too large, not too small.

Exit codes: 0 equal except for noise, 1 different, 2 bad input, 4 undecided")]
pub(crate) struct DiffArgs {
    /// Folder written by `etendue run`, `compare` or `measure`
    #[arg(value_name = "A")]
    pub(crate) a: PathBuf,

    /// Folder of another result
    #[arg(value_name = "B")]
    pub(crate) b: PathBuf,

    /// Probability of reporting a difference where there is none
    #[arg(long, value_name = "SHARE", default_value = "1%", value_parser = share, allow_hyphen_values = true)]
    pub(crate) alpha: f64,

    /// Refuse results that cannot be compared in pairs, such as those of different seeds
    #[arg(long)]
    pub(crate) pairs: bool,

    /// Draw the spectra of both results, and their difference, at the plane that differs most (.png or
    /// .svg)
    #[arg(long, value_name = "FILE")]
    pub(crate) draw: Option<PathBuf>,

    /// Print the comparison as JSON
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) force: ForceArgs,
}

#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Draw the scene with its central ray and planes into this file (.png or .svg)
    #[arg(long, value_name = "FILE")]
    pub(crate) draw: Option<PathBuf>,

    /// Print the planes, warnings and expected effort as JSON
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) force: ForceArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  etendue export --to mitsuba scenes/fig9b.ron --out out/mitsuba
  python tests/peers/mitsuba_light_field.py --help   record the same light field with
                                                     Mitsuba and compare spectra

Files are in out/NAME-mitsuba unless --out names another folder.")]
pub(crate) struct ExportArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Program that will read the files
    #[arg(long, value_name = "PROGRAM")]
    pub(crate) to: Program,

    #[command(flatten)]
    pub(crate) out: FolderArgs,

    #[command(flatten)]
    pub(crate) force: ForceArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue schema > docs/scene.schema.json
  etendue schema --page > docs/scene.md")]
pub(crate) struct SchemaArgs {
    /// Print the reference page of all fields, in Markdown
    #[arg(long)]
    pub(crate) page: bool,
}

/// The values of the option `--to`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Program {
    /// Mitsuba 3: scene.xml, PLY files, and planes.json
    Mitsuba,
}

/// The values of the option `--save`.
fn saves() -> impl TypedValueParser<Value = Save> {
    let named = |save: Save, help| (save, save.name(), help);
    one_of([
        named(
            Save::Photons,
            "Every photon that crossed a plane: photons.npy and photons.json, 40 bytes per photon",
        ),
        named(
            Save::Mcpl,
            "The same photons as rays in world coordinates with their power in W: photons.mcpl, 64 bytes per photon",
        ),
        named(
            Save::Tm25,
            "The same rays in single precision, in an IES TM-25 file: photons.tm25ray, 28 bytes per photon",
        ),
        named(
            Save::Field,
            "The light field on a 4D grid, in field.npy and field.json, and its full radial spectrum, in full_radial.npz. The spectrum is also predicted and compared. The photons are traced once more for each plane, or twice if memory is short",
        ),
        named(
            Save::Batches,
            "The slices of each batch, and the predictions with their derivatives, from which `etendue diff` tests two results of the same seed in pairs (docs/verdict.md): batches.npz, ledger.npz and predictions.npz",
        ),
        named(
            Save::Explorer,
            "The scene in explorer.html, an interactive page of 1.2 MB, if the scene is one that this page can save",
        ),
    ])
}

/// The values of the option `--expect`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Expect {
    /// The photons must agree with all exact predictions, and must show that the chain of operators
    /// of at least one first-order prediction is wrong.
    Disagreement,
}

/// Parses a time.
fn time(text: &str) -> Result<Duration, String> {
    let allowed = |_| "allowed: a number with its unit, such as 90s, 30m or 1h 30m".to_owned();
    humantime::parse_duration(text).map_err(allowed)
}

/// Parses a range of batches A..B that holds at least one batch.
fn range(text: &str) -> Result<Range<u32>, String> {
    let ends = text.split_once("..").map(|(a, b)| (a.parse(), b.parse()));
    match ends {
        Some((Ok(start), Ok(end))) if start < end => Ok(start..end),
        _ => Err("must be A..B, whole numbers with A < B".to_owned()),
    }
}
