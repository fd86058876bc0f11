//! Draws the pictures of a run: the light field and the spectrum of each plane, and the strip along
//! the path.

mod chance;
mod cross_section;
mod finer;
mod seen;
mod strip;
mod words;

pub use cross_section::across;
pub use seen::{Seen, full_radials, light_fields, spectra};
pub use strip::{path, spectra_are, strip_of};
pub(crate) use words::{
    light_field_axes, light_field_quantity, power_axes, spectrum_axes, spectrum_quantity,
};

use crate::drawing;
use crate::table::{self, spaced, word};
use chance::Outliers;
use etendue_compare::{Class, PlaneComparison, PlaneReport, Prediction, Verdict};
use etendue_field::{VirtualPlane, grouped, percent};
use etendue_figures::{Comparison, Figure, Scale, comparison, section};
use etendue_pipeline::Summary;
use etendue_scene::Scene;
use etendue_store::arrays::{radial_z, z};
use etendue_store::{Failure, Results};
use finer::finer_powers;
use std::path::Path;
use words::CoordinateNames;

/// The colors of a spectrum, in decibels below its peak.
pub const DECIBEL: Scale = Scale::Decibel { floor: -50.0 };

/// The picture files of a plane, and the numbers behind them.
pub const NAMES: [&str; 6] = [
    "primal.png",
    "primal.svg",
    "primal.csv",
    "spectrum.png",
    "spectrum.svg",
    "spectrum.csv",
];
/// The picture files of the path, and the numbers behind them.
pub const PATH_NAMES: [&str; 3] = ["path.png", "path.svg", "path.csv"];

/// The names of the two sides in the pictures of a plane. If no theory applies, the second
/// side is a measurement by the other tracer.
pub fn sides(plane: &PlaneComparison) -> [&'static str; 2] {
    match plane.report.class {
        Class::Reference => ["measured", "other tracer"],
        _ => ["measured", "predicted"],
    }
}

/// The pictures `primal` and `spectrum` of a plane. `made_from` describes their source, and
/// `sides` are the names of the two sides.
pub fn plane(
    (made_from, sides): (&str, [&str; 2]),
    prediction: &Prediction,
    at: &VirtualPlane,
    plane: &PlaneComparison,
) -> Result<[PictureFiles; 2], Failure> {
    let name = &plane.report.name;
    let note = format!("{made_from}; {}", verdict_line(plane));
    let light_field = primal((&note, sides), prediction, at, plane)?;
    let note = format!("{note}. {}", Outliers::of(plane).words());
    let spectrum = spectrum((&note, sides), at, plane)?;
    Ok([
        PictureFiles::new(format!("{name}/primal"), light_field)?,
        PictureFiles::new(format!("{name}/spectrum"), spectrum)?,
    ])
}

/// The light field of a plane.
fn primal(
    (note, sides): (&str, [&str; 2]),
    prediction: &Prediction,
    at: &VirtualPlane,
    plane: &PlaneComparison,
) -> Result<Figure, Failure> {
    let words = CoordinateNames::of(at);
    let measured = &plane.projection.mean;
    let [x, u] = light_field_axes(at, &measured.grid);
    let difference = z(
        &measured.values,
        &prediction.projection.values,
        &plane.projection.standard_error,
    );
    comparison(&Comparison {
        title: &format!(
            "{}: light field in ({}, {}), integrated over {} and {}",
            spaced(&plane.report.name),
            words.along[0],
            words.along[1],
            words.across[0],
            words.across[1]
        ),
        note,
        x,
        y: u,
        quantity: words.light_field_quantity(),
        scale: Scale::Linear,
        sides,
        measured: measured.values.view(),
        predicted: prediction.projection.values.view(),
        z: difference.view(),
        finer: None,
    })
    .map_err(Failure::cannot_run)
}

/// The radial spectrum of a plane. If the window determines the values between the
/// frequencies, the measured and the predicted spectrum are drawn without visible cells. The
/// difference is drawn at the frequencies of the scene, and the stored numbers are at these
/// frequencies too.
fn spectrum(
    (note, sides): (&str, [&str; 2]),
    at: &VirtualPlane,
    plane: &PlaneComparison,
) -> Result<Figure, Failure> {
    let [rho, nu] = spectrum_axes(at);
    let difference = radial_z(plane);
    let finer = finer_powers(at, plane);
    comparison(&Comparison {
        title: &format!(
            "{}: power spectrum, {}",
            spaced(&plane.report.name),
            match plane.measured.grid.azimuths {
                1 => "at azimuth 0".to_owned(),
                azimuths => format!("mean over {azimuths} azimuths"),
            }
        ),
        note,
        x: rho,
        y: nu,
        quantity: spectrum_quantity(),
        scale: DECIBEL,
        sides,
        measured: plane.radial.power.view(),
        predicted: plane.predicted_radial.view(),
        z: difference.view(),
        finer: finer
            .as_ref()
            .map(|both| both.each_ref().map(|power| power.view())),
    })
    .map_err(Failure::cannot_run)
}

/// A line that states from which run a picture was made.
pub fn made_from(summary: &Summary) -> String {
    format!(
        "{}, {} photons, seed {}{}",
        summary.scene,
        grouped(summary.photons),
        summary.seed,
        summary.scene_file.run.color.suffix()
    )
}

/// Draws the scene with its central ray and planes, as a PNG or SVG file to be written at `path`.
pub fn drawn_scene(scene: &Scene, path: &Path) -> Result<Vec<u8>, Failure> {
    let figure = section(
        &drawing::cross_section(scene, scene.planes.iter()),
        &scene.name,
        "",
    )
    .map_err(Failure::cannot_run)?;
    image(&figure, path)
}

/// A figure as a PNG or SVG file to be written at `path`.
pub(crate) fn image(figure: &Figure, path: &Path) -> Result<Vec<u8>, Failure> {
    Ok(match path.extension().and_then(|e| e.to_str()) {
        Some("svg") => figure.svg.clone().into_bytes(),
        Some("png") => figure.png().map_err(Failure::cannot_run)?,
        _ => {
            let message = format!(
                "--draw {}: the file must end in .png or .svg",
                path.display()
            );
            return Err(Failure::bad_input(message));
        }
    })
}

/// The files of a figure: PNG, SVG and the numbers behind it.
#[derive(Debug)]
pub struct PictureFiles {
    name: String,
    png: Vec<u8>,
    figure: Figure,
}

impl PictureFiles {
    /// Draws the pixels of a figure. `name` is the path of its files, without their extensions.
    pub fn new(name: String, figure: Figure) -> Result<Self, Failure> {
        let png = figure.png().map_err(Failure::cannot_run)?;
        Ok(Self { name, png, figure })
    }

    /// The figure as SVG.
    pub fn svg(&self) -> &str {
        &self.figure.svg
    }

    /// Writes the files.
    pub fn write(&self, results: &mut Results) -> Result<(), Failure> {
        let Self { name, png, figure } = self;
        results.write(&format!("{name}.png"), png)?;
        results.write(&format!("{name}.svg"), figure.svg.as_bytes())?;
        results.write(&format!("{name}.csv"), figure.csv.as_bytes())
    }
}

/// The verdict on a plane and its reasons, in one line.
pub fn verdict_line(plane: &PlaneComparison) -> String {
    verdict_lines(plane).join(", ")
}

/// The verdict and its reasons, in lines that are at most as wide as a picture.
pub fn verdict_lines(plane: &PlaneComparison) -> Vec<String> {
    let report = &plane.report;
    let verdict = word(report.verdict);
    if report.verdict == Verdict::Undecided {
        return vec![p_value(report), verdict.to_owned()];
    }
    let chain = report.first_order.as_ref();
    let mut lines = match chain.filter(|chain| chain.verdict == Verdict::Fail) {
        Some(chain) => vec![
            format!("chain fails by {}", table::off_by(chain)),
            format!("computed: {}", percent(chain.chain.error, 3)),
            format!("rays: {}", p_value(report)),
        ],
        None => vec![format!("{}, {verdict}", p_value(report))],
    };
    let chi2 = report.chi2_per_dof;
    lines.extend(chi2.map(|t| format!("*χ*^{{2}}/dof = {t:.3}")));
    // The power is tested too. Its p is stated where it may decide.
    let of_power = report.radial.and_then(|radial| radial.p_value);
    if let Some(p) = of_power.filter(|p| *p < 0.01) {
        lines.push(format!("power: {}", probability(p)));
    }
    let full_radial = report.full_radial.and_then(|full| full.power.p_value);
    if let Some(p) = full_radial {
        lines.extend(["full radial:".to_owned(), format!("*p* = {p:.3}")]);
    }
    // The quadrature error is stated if the plane passes only because the disagreement is within
    // this error.
    let is_excused = report.exact_verdict() == Verdict::Pass && report.p_value < Some(0.001);
    let error = report.quadrature_error.filter(|_| is_excused);
    lines.extend(error.map(|error| format!("quadrature ± {}", percent(error, 3))));
    if plane.predicted.is_dark() && report.verdict == Verdict::Pass {
        lines.push("dark, as predicted".to_owned());
    }
    lines
}

fn p_value(report: &PlaneReport) -> String {
    report.p_value.map_or("no photons".to_owned(), probability)
}

fn probability(p: f64) -> String {
    if p < 0.001 {
        "*p* < 0.001".to_owned()
    } else {
        format!("*p* = {p:.3}")
    }
}
