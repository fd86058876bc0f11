//! Arguments of `etendue fit`.

use super::shared::{FolderArgs, SceneArgs, WorkArgs, whole_number, within};
use clap::Args;
use etendue_scene::dotted;
use etendue_studies::fit::{FitRequest, range};
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue measure scenes/fig9b.ron --out out/measured
  etendue fit scenes/fig9b.ron --to out/measured --free surfaces.0.center.2,blockers.0.fill
  etendue fit scene.ron --to rays.npz --free light.radiance,surfaces.0.albedo --plane receiver
  etendue fit scene.ron --to out/measured --free blockers.0.pitch --range blockers.0.pitch=0.05..0.4
  etendue fit scenes/fig9b.ron --plan --free surfaces.0.center.2,blockers.0.fill

Finds the values of the free fields with which the predicted slices are closest to a measurement, in units \
of its noise. Windows and frequencies of the planes must be those of the measurement.
RESULT is one of
  a folder of `measure` or `spectrum`; several, separated by commas, are parts of
             one measurement
  a folder of `run --save batches`
  FILE.npz   arrays PLANE/replicates, or PLANE/slices and PLANE/sigma (docs/own-theory.md)
Errors come from the spread of batches or replicates; with sigma alone, the noise of all frequencies \
is taken as independent.
Columns:
  fit         the estimate with its standard error
  alone       the error if the other fields were known
  bound       Cramér-Rao bound of the error, if weights knew the covariance of the noise
Writes to out/NAME-fit, or to the folder of --out: fit.json, and, for two fields or more, fit.png, .svg \
and .csv with ellipses of correlations.

Exit codes: 0 the model agrees, 1 it does not, 2 bad input, 3 cannot run, 4 undecided: several minima \
agree, or the spectra do not tell the fields apart")]
pub(crate) struct FitArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// The measurement
    #[arg(
        long,
        value_name = "RESULT",
        value_delimiter = ',',
        required_unless_present = "plan"
    )]
    pub(crate) to: Vec<PathBuf>,

    /// The free fields, separated by commas
    #[arg(long, value_name = "FIELDS", value_delimiter = ',', required = true)]
    pub(crate) free: Vec<String>,

    /// Range in which further starts lie [default: the value in the scene ± 50 %]; may be repeated
    #[arg(long, value_name = "FIELD=A..B", value_parser = range)]
    pub(crate) range: Vec<(String, [f64; 2])>,

    /// Number of starts: the scene, and points in the ranges. The best go on to higher frequencies, so
    /// there are up to 9 more descents
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = within::<usize>(1..=1000))]
    pub(crate) starts: usize,

    /// Name of a plane to compare; may be repeated [default: all measured planes]
    #[arg(long, value_name = "NAME")]
    pub(crate) plane: Vec<String>,

    /// Instead of a fit, state how many photons each field needs at each plane, from the noise of a
    /// few photons
    #[arg(long, conflicts_with_all = ["to", "range", "starts"])]
    pub(crate) plan: bool,

    /// Number of photons of --plan from which the noise is scaled
    #[arg(long, value_name = "N", default_value = "2^18", value_parser = whole_number, requires = "plan")]
    pub(crate) photons: u64,

    /// Print fit.json instead of tables
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) out: FolderArgs,

    #[command(flatten)]
    pub(crate) work: WorkArgs,
}

impl FitArgs {
    /// The requested fit.
    pub(crate) fn request(&self) -> FitRequest {
        FitRequest {
            scene: self.scene.source(),
            free: self.free.iter().map(|path| dotted(path.trim())).collect(),
            ranges: self.range.clone(),
            starts: self.starts,
            planes: self.plane.clone(),
        }
    }
}
