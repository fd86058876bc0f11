use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

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

Exit codes: 0 pass, 1 disagreement or undecided, 2 bad input, 3 cannot run (directory, memory, interrupted)"
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Trace a scene, measure its spectra, predict them, compare and draw.
    Run(RunArgs),
    /// Validate a scene; print the chain read off it and the class of each plane; with --draw, draw it.
    Check(CheckArgs),
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue run scenes/fig9b.ron
  etendue run scenes/fig9b.ron --photons 1e8 --seed 7 --threads 2 --out out/more
  etendue run scenes/fig9b.ron --set planes.3.at='Distance(1.5)' --save photons

Photon counts may be written 10_000_000 or 1e7.")]
pub(crate) struct RunArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Folder for the results [default: out/NAME]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Photons to emit, instead of the scene's
    #[arg(long, value_name = "N", value_parser = whole_number, allow_hyphen_values = true)]
    pub(crate) photons: Option<u64>,

    /// Seed of the photons, instead of the scene's
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,

    /// Threads [default: one for each core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// What else to keep
    #[arg(long, value_name = "WHAT", value_delimiter = ',')]
    pub(crate) save: Vec<Save>,

    /// Succeed when measured and predicted disagree, fail when they agree
    #[arg(long, value_name = "OUTCOME")]
    pub(crate) expect: Option<Expect>,

    /// Print nothing but errors
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Draw the scene with its central ray and planes into this file (.png or .svg)
    #[arg(long, value_name = "FILE")]
    pub(crate) draw: Option<PathBuf>,
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

/// What `--save` keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Save {
    /// Every photon that crossed a plane: photons.npy and photons.json, 40 bytes for each
    Photons,
}

/// What `--expect` may expect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Expect {
    /// At least one plane must be rejected.
    Disagreement,
}

fn assignment(text: &str) -> Result<(String, String), String> {
    let (path, value) = text.split_once('=').ok_or("must be PATH=VALUE")?;
    Ok((path.trim().to_owned(), value.trim().to_owned()))
}

/// A whole number, also as 10_000_000 or 1e7.
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
    let x: f64 = digits.parse().map_err(|_| "must be a whole number")?;
    if (0.0..=9.0e15).contains(&x) && x.fract() == 0.0 {
        Ok(x as u64)
    } else {
        Err("must be a whole number from 0 to 9e15".to_owned())
    }
}
