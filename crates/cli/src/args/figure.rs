//! Arguments of commands that draw.

use super::shared::{ForceArgs, WorkArgs, assignment, one_of};
use clap::Args;
use clap::builder::TypedValueParser;
use etendue_paper::Quality;
use std::path::PathBuf;

/// Parses the effort level of a figure.
fn qualities() -> impl TypedValueParser<Value = Quality> {
    let named = |quality: Quality, help| (quality, quality.name(), help);
    one_of([
        named(
            Quality::Draft,
            "An eighth of the scenes' photons, and twice as many frequencies along each axis as the scenes",
        ),
        named(
            Quality::Print,
            "The scenes' photons, and four times as many frequencies along each axis as the scenes",
        ),
    ])
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  etendue report out/fig9a out/fig9b out/fig9c --out out/fig9.html

Each run also writes its own page, report.html. A page is a single file and needs no network.")]
pub(crate) struct ReportArgs {
    /// Folders written by `etendue run` or `compare`
    #[arg(value_name = "DIR", required = true)]
    pub(crate) folders: Vec<PathBuf>,

    /// File to which the page is written
    #[arg(long, value_name = "FILE", default_value = "out/report.html")]
    pub(crate) out: PathBuf,

    #[command(flatten)]
    pub(crate) force: ForceArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue figure 9
  etendue figure all --quality draft --out out/figures
  etendue figure my.ron                                   light field and spectra
                                                          along the path of your scene
  etendue figure a.ron b.ron --plane receiver --out out   two scenes side by side at one plane

Figures of Durand et al. 2005: 1, 3 to 17, and table1. Figures 5 and 12 show kernels that are computed \
from theory only; all other figures are measured and predicted. The folder of each figure contains
  figure.png, .svg, .pdf   the PDF is at most 7 inches wide (two columns of a
                           journal)
  figure.npz               light fields and spectra of all planes, and
                           other pictures, with errors
  figure.csv               the numbers of curves and bars, with errors
  columns.csv              unit and meaning of each array and column
  figure.json              the verdict of each plane, and the command that
                           repeats the figure
  NAME.ron                 the scenes of a figure of the paper; your own
                           scenes are in figure.json, as they were run
The worst plane determines the exit code, as in run.")]
pub(crate) struct FigureArgs {
    /// Figures of the paper (1, 3 to 17, table1, or all), or scene files. All scene files together
    /// make one figure
    #[arg(value_name = "NAME|SCENE.ron", required = true)]
    pub(crate) names: Vec<String>,

    /// Set a field of the scene files, such as blockers.0.fill=0.5; may be repeated
    #[arg(long, value_name = "PATH=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,

    /// Show scene files only at this plane [default: all planes if there is one scene file,
    /// otherwise the last plane of each scene file]
    #[arg(long, value_name = "NAME")]
    pub(crate) plane: Option<String>,

    /// Folder to which the figures are written
    #[arg(long, value_name = "DIR", default_value = "results/figures")]
    pub(crate) out: PathBuf,

    /// Style file, in RON, such as (titles: false, scene: false, verdicts: false, width: 3.33,
    /// floor: -40). Each field is optional. `titles` also controls the notes. `scene` controls the
    /// drawing above the planes. `width` is the width of the page in inches, from 3.3 to 7, and
    /// `height` its largest height, 9.1 unless it is given: pictures become lower on a low page.
    /// `floor` is the lowest level of spectra, in dB. `palette` is Inferno, Magma, Viridis or
    /// Cividis
    #[arg(long, value_name = "FILE")]
    pub(crate) style: Option<PathBuf>,

    /// How much work to put into the figure
    #[arg(long, value_name = "QUALITY", default_value = Quality::default().name(), value_parser = qualities())]
    pub(crate) quality: Quality,

    #[command(flatten)]
    pub(crate) work: WorkArgs,
}
