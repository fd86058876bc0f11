//! What the command line says.

mod figure;
mod rays;
mod run;
mod shared;
mod sweep;
mod world;

pub(crate) use figure::{FigureArgs, ReportArgs};
pub(crate) use rays::RaysArgs;
pub(crate) use run::{
    CheckArgs, CompareArgs, ConvergeArgs, DiffArgs, Expect, ExportArgs, MeasureArgs, PredictArgs,
    RunArgs, SchemaArgs, SplitArgs,
};
pub(crate) use shared::{PhotonArgs, SceneArgs, ThreadArgs};
pub(crate) use sweep::{BandwidthArgs, CovarianceArgs, SweepArgs};
pub(crate) use world::{ImportArgs, ProbeArgs, RenderArgs};

use clap::{Parser, Subcommand};

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
