//! The command-line arguments.

mod figure;
mod first;
mod fit;
mod rays;
mod run;
mod shared;
mod sweep;
mod variance;
#[cfg(feature = "worlds")]
mod world;

pub(crate) use figure::{FigureArgs, ReportArgs};
pub(crate) use first::{CompletionsArgs, ManArgs, NewArgs, SCENES};
pub(crate) use fit::FitArgs;
pub(crate) use rays::{RaysArgs, SpectrumArgs};
pub(crate) use run::{
    CheckArgs, CompareArgs, ConvergeArgs, DiffArgs, Expect, ExportArgs, MeasureArgs, PredictArgs,
    RunArgs, SchemaArgs, SplitArgs,
};
pub(crate) use shared::{ThreadArgs, WorkArgs};
pub(crate) use sweep::{BandwidthArgs, CovarianceArgs, SweepArgs};
pub(crate) use variance::{VarianceArgs, files, samplers};
#[cfg(feature = "worlds")]
pub(crate) use world::{ImportArgs, ProbeArgs, RenderArgs, WorldCommand};

use clap::error::{ContextKind, ContextValue};
use clap::{Arg, CommandFactory, FromArgMatches, Parser, Subcommand};
use etendue_scene::nearest;
use std::ffi::OsString;
use std::fmt::Write;

/// Measures the space-angle frequency content of light and compares it with theory.
#[derive(Debug, Parser)]
#[command(
    version = env!("ETENDUE_VERSION"),
    about,
    help_template = "{about-with-newline}\n{usage-heading} {usage}\n{before-help}{after-help}",
    after_help = "Options:
  -h, --help     Print help, here or after a command
  -V, --version  Print the version

First steps:
  etendue new && etendue run blockers.ron               write a first scene, and run it
  etendue run scenes/fig9b.ron                          measure, predict, compare, draw
  etendue check scenes/fig9b.ron                        show how the program understands a scene
  etendue run scenes/fig9b.ron --set blockers.0.pitch=0.05 --out out/fine
  etendue render scenes/worlds/glossy.xml               a picture of a Mitsuba scene

Exit codes: 0 pass, 1 disagreement, 2 bad input, 3 cannot run (folder, memory, interruption),
4 undecided"
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Write a first scene, one of five.
    New(NewArgs),
    /// Trace a scene, predict its spectra, compare and draw.
    Run(RunArgs),
    /// Check a scene and show how it is understood; nothing is traced.
    Check(CheckArgs),
    /// Run a scene for several field values; write a table and curves.
    Sweep(SweepArgs),
    /// Fit fields of a scene to a measurement, or plan such a fit.
    Fit(FitArgs),
    /// Measure a scene, or some of its batches, for `compare`.
    Measure(MeasureArgs),
    /// Predict a scene, for `compare`.
    Predict(PredictArgs),
    /// Compare measured and predicted files; write files as `run` does.
    Compare(CompareArgs),
    /// Print commands that measure a scene in parts on several machines.
    Split(SplitArgs),
    /// Compare two results of one scene.
    Diff(DiffArgs),
    /// Show the pages of several results side by side.
    Report(ReportArgs),
    /// Reproduce the figures of Durand et al. 2005, or draw your scenes.
    Figure(FigureArgs),
    /// Measure how finely a glossy reflection must be sampled.
    Bandwidth(BandwidthArgs),
    /// Compare covariance tracing with measured spectra.
    Covariance(CovarianceArgs),
    /// Predict the error of a mean of N rays, for several samplers.
    Variance(VarianceArgs),
    /// Measure how fast first-order maps approach the real geometry.
    Converge(ConvergeArgs),
    #[cfg(feature = "worlds")]
    #[command(flatten)]
    World(WorldCommand),
    /// Write a scene for Mitsuba 3.
    Export(ExportArgs),
    /// Inspect a ray file or convert it to another format.
    Rays(RaysArgs),
    /// Measure the spectrum of the rays of a file.
    Spectrum(SpectrumArgs),
    /// Print the JSON schema of scene files, or a page of all fields.
    Schema(SchemaArgs),
    /// Print a script that completes commands in a shell.
    Completions(CompletionsArgs),
    /// Print a page of the manual, for `man`.
    Man(ManArgs),
}

/// The commands, grouped by purpose, in the order of the help text.
const GROUPS: [(&str, &[&str]); 4] = [
    (
        "Measure and compare",
        &[
            "new", "run", "check", "sweep", "fit", "measure", "predict", "compare", "split", "diff",
        ],
    ),
    (
        "Show results and reproduce the paper",
        &[
            "report",
            "figure",
            "bandwidth",
            "covariance",
            "variance",
            "converge",
        ],
    ),
    (
        "Scenes of other programs",
        &["import", "render", "probe", "export"],
    ),
    (
        "Files and help",
        &["rays", "spectrum", "schema", "completions", "man"],
    ),
];

/// The list of the commands for the help text, in groups.
fn grouped(command: &clap::Command) -> String {
    let mut list = String::new();
    for (heading, names) in GROUPS {
        let _ = writeln!(list, "\n{heading}:");
        for name in names {
            let Some(command) = command.find_subcommand(name) else {
                continue; // as it is without the feature `worlds`
            };
            let about = command
                .get_about()
                .map(ToString::to_string)
                .unwrap_or_default();
            let _ = writeln!(list, "  {name:<11}  {about}");
        }
    }
    list
}

impl Cli {
    /// The command-line parser, with its commands in groups.
    pub(crate) fn grouped_command() -> clap::Command {
        let command = <Self as CommandFactory>::command();
        let list = grouped(&command);
        let command = command.before_help(list.trim_end().to_owned());
        // A negative number is a value outside of its range, and not an unknown option.
        let has_value = |arg: &Arg| arg.get_action().takes_values();
        let with_sign = |arg: Arg| match has_value(&arg) {
            true => arg.allow_negative_numbers(true),
            false => arg,
        };
        command.mut_subcommands(|command| command.mut_args(with_sign))
    }

    /// Parses a command line whose first word is the name of the program.
    pub(crate) fn parse_line(
        line: impl IntoIterator<Item = impl Into<OsString> + Clone>,
    ) -> Result<Self, clap::Error> {
        let command = Self::grouped_command();
        let names: Vec<String> = command
            .get_subcommands()
            .map(|command| command.get_name().to_owned())
            .collect();
        let matches = command.try_get_matches_from(line);
        Self::from_arg_matches(&matches.map_err(|error| suggesting(error, &names))?)
    }
}

/// Adds to an error the name of the command that was probably meant. Clap itself does not detect
/// swapped letters, and takes `rn` for `render`. Its tip to pass an unknown option as a value is
/// removed, because no command has such values.
fn suggesting(mut error: clap::Error, names: &[String]) -> clap::Error {
    error.remove(ContextKind::Suggested);
    let unknown = error.get(ContextKind::InvalidSubcommand).cloned();
    if let Some(ContextValue::String(unknown)) = unknown
        && let Some(meant) = nearest(&unknown, names.iter().map(String::as_str))
    {
        let meant = ContextValue::Strings(vec![meant.to_owned()]);
        error.insert(ContextKind::SuggestedSubcommand, meant);
    }
    error
}

#[cfg(test)]
mod tests {
    use super::{Cli, GROUPS};

    #[test]
    fn each_command_is_in_one_group() {
        let command = Cli::grouped_command();
        let mut listed: Vec<_> = GROUPS
            .iter()
            .flat_map(|(_, names)| *names)
            .copied()
            .collect();
        let mut named: Vec<_> = command
            .get_subcommands()
            .map(|c| c.get_name().to_owned())
            .collect();
        listed.sort_unstable();
        named.sort_unstable();
        assert_eq!(listed, named);
    }

    #[test]
    fn a_misspelled_command_is_suggested() {
        for (written, meant) in [
            ("rnu", "run"),
            ("rn", "run"),
            ("reprot", "report"),
            ("swep", "sweep"),
        ] {
            let error = Cli::parse_line(["etendue", written])
                .unwrap_err()
                .to_string();
            assert!(error.contains(&format!("'{meant}'")), "{error}");
        }
        let unknown = Cli::parse_line(["etendue", "check", "s.ron", "--photons", "9"]);
        let unknown = unknown.unwrap_err().to_string();
        assert!(!unknown.contains("as a value"), "{unknown}");
    }

    #[test]
    fn help_fits_80_columns() {
        let help = Cli::grouped_command().render_help().to_string();
        let list = help.split("Options:").next().unwrap_or_default();
        let too_long: Vec<_> = list
            .lines()
            .filter(|line| line.chars().count() > 80)
            .collect();
        assert!(too_long.is_empty(), "{too_long:?}");
        assert!(
            list.contains("Scenes of other programs:\n  import "),
            "{help}"
        );
    }
}
