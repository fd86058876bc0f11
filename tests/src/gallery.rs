//! Searches figures of the paper and of random scenes for texts that overlap, that leave the page or
//! that are too small, and for pages that are too high.

use crate::hostile::child::program;
use crate::progress::in_parallel;
use crate::report::Bound::AtMost;
use crate::report::{Check, ReportSection, Row};
use crate::wild::{scene, text};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Options of the search.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct GalleryOptions {
    /// Number of random scenes, each of which is drawn in one of eight styles.
    #[arg(long, default_value_t = 40)]
    scenes: u64,
    /// Seed of the random scenes.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Photons of each random scene.
    #[arg(long, default_value_t = 1 << 14)]
    photons: u64,
}

/// The styles in which random scenes are drawn.
const STYLES: [&str; 8] = [
    "()",
    "(titles: false, verdicts: false)",
    "(width: 3.33)",
    "(width: 3.33, titles: false, scene: false, verdicts: false)",
    "(scene: false, palette: Viridis)",
    "(width: 5, height: 7)",
    "(height: 6, verdicts: false)",
    "(titles: false, floor: -30)",
];
/// The height of the text of a page of the ACM, 655 points, in units of 1/96 inch.
const MAX_HEIGHT: f64 = 655.0 / 72.0 * 96.0;

/// Draws all figures, and searches them.
pub(crate) fn gallery(options: GalleryOptions) -> io::Result<ReportSection> {
    let program = program(None)?;
    let place = tempfile::tempdir()?;
    let paper = place.path().join("paper");
    drawn(&program, &["all".as_ref()], "()", &paper)?;
    let mut figures: Vec<PathBuf> = fs::read_dir(&paper)?
        .map(|entry| Ok(entry?.path()))
        .collect::<io::Result<_>>()?;
    figures.sort();
    let of_paper = figures.iter().map(|figure| {
        let name = figure.file_name().unwrap_or_default().to_string_lossy();
        row(&format!("figure {name}"), figure, Some(MAX_HEIGHT))
    });
    let mut rows: Vec<Row> = of_paper.collect::<io::Result<_>>()?;
    let styles = STYLES.iter().cycle();
    let scenes = (0..options.scenes).zip(styles);
    let random = in_parallel(scenes, "scenes", |(number, style)| {
        let folder = place.path().join(number.to_string());
        fs::create_dir_all(&folder)?;
        let Ok(file) = scene(options.seed, number, options.photons, &folder) else {
            return Ok(None);
        };
        let path = folder.join("scene.ron");
        fs::write(&path, text(&file)?)?;
        let out = folder.join("out");
        drawn(&program, &[&path], style, &out)?;
        let name = format!("scene {number}, {style}");
        row(&name, &out.join("scene"), None).map(Some)
    });
    let random = random.into_iter().filter_map(Result::transpose);
    rows.extend(random.collect::<io::Result<Vec<Row>>>()?);
    Ok(ReportSection::new(
        "Gallery",
        "Figures of the paper, and of random scenes in eight styles. Required: no text overlaps another one, \
         leaves the page or is smaller than 6 points, and figures of the paper are at most 655 points high.",
        "figure | width, pt | height, pt | faults of texts",
        rows,
    ))
}

/// Draws figures into a folder.
fn drawn(program: &Path, wanted: &[&Path], style: &str, out: &Path) -> io::Result<()> {
    let path = out.with_extension("style.ron");
    fs::write(&path, style)?;
    Command::new(program)
        .arg("figure")
        .args(wanted)
        .args(["--quality", "draft", "--quiet", "--style"])
        .arg(path)
        .arg("--out")
        .arg(out)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .map(|_| ())
}

/// The row of a figure in a folder. A scene that cannot be drawn, such as one in which no light
/// reaches a plane, has no figure.
fn row(name: &str, folder: &Path, most: Option<f64>) -> io::Result<Row> {
    let Ok(svg) = fs::read_to_string(folder.join("figure.svg")) else {
        let cells = [name, "–", "–", "not drawn"].map(str::to_owned);
        let missing = if most.is_some() { 1.0 } else { 0.0 };
        let check = Check::new("drawn", missing, AtMost(0.0)).because("figures of the paper exist");
        return Ok(Row::new(cells.to_vec(), vec![check]));
    };
    let faults = etendue_figures::text_faults(&svg).map_err(io::Error::other)?;
    let [width, height] = etendue_figures::svg_size(&svg);
    let point = |units: f64| format!("{:.0}", 0.75 * units);
    let shown: Vec<&str> = faults.iter().take(3).map(String::as_str).collect();
    let cells = vec![
        name.to_owned(),
        point(width),
        point(height),
        format!("{} {}", faults.len(), shown.join("; ")),
    ];
    let mut checks =
        vec![Check::new("faults", faults.len() as f64, AtMost(0.0)).because("texts are read")];
    if let Some(most) = most {
        checks.push(Check::new("height", height, AtMost(most)).because("a page"));
    }
    Ok(Row::new(cells, checks))
}
