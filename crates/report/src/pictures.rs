//! The pictures of a run: light field and spectrum of each plane, and the strip along the path.

mod cross_section;
mod words;

pub use cross_section::across;
pub use words::{
    across_axes, full_radial_axes, full_radial_quantity, light_field_axes, light_field_quantity,
    spectrum_axes, spectrum_quantity,
};

use crate::drawing;
use cross_section::differs_across;
use etendue_compare::{
    Applicability, Class, FullRadialComparison, PlaneComparison, PlaneReport, Prediction, Theory,
    Verdict, stands_before,
};
use etendue_field::{Side, VirtualPlane, percent};
use etendue_figures::{
    AcrossPictures, Comparison, Figure, Guide, Picture, Scale, Strip, StripColumn, Style,
    comparison, section, strip,
};
use etendue_pipeline::MeasuredScene;
use etendue_pipeline::Summary;
use etendue_pipeline::table::{self, grouped, spaced, word};
use etendue_scene::Scene;
use etendue_store::Failure;
use etendue_store::Results;
use etendue_store::arrays::{radial_z, z};
use ndarray::{Array2, Axis};
use std::cmp::Ordering;
use std::path::Path;
use words::CoordinateNames;

/// Lowest level of a spectrum's colors, in decibels below its peak.
const FLOOR: f64 = -50.0;

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

/// The pictures `primal` and `spectrum` of a plane; `made_from` describes their source.
pub fn plane(
    results: &mut Results,
    made_from: &str,
    prediction: &Prediction,
    at: &VirtualPlane,
    plane: &PlaneComparison,
) -> Result<(), Failure> {
    let words = CoordinateNames::of(at);
    let name = &plane.report.name;
    let note = format!("{made_from}; {}", verdict_line(plane));
    let measured = &plane.projection.mean;
    let [x, u] = words.projection_axes(&measured.grid);
    let difference = z(
        &measured.values,
        &prediction.projection.values,
        &plane.projection.standard_error,
    );
    let primal = Comparison {
        title: &format!(
            "{}: light field in ({}, {}), integrated over {} and {}",
            spaced(name),
            words.along[0],
            words.along[1],
            words.across[0],
            words.across[1]
        ),
        note: &note,
        x,
        y: u,
        quantity: words.light_field_quantity(),
        scale: Scale::Linear,
        measured: measured.values.view(),
        predicted: prediction.projection.values.view(),
        z: difference.view(),
    };
    write(
        results,
        &format!("{name}/primal"),
        &comparison(&primal).map_err(Failure::cannot_run)?,
    )?;

    let [rho, nu] = words.frequency_axes(&plane.measured.grid);
    let difference = radial_z(plane);
    let spectrum = Comparison {
        title: &format!(
            "{}: power spectrum, {}",
            spaced(name),
            match plane.measured.grid.azimuths {
                1 => "at azimuth 0".to_owned(),
                azimuths => format!("mean over {azimuths} azimuths"),
            }
        ),
        note: &note,
        x: rho,
        y: nu,
        quantity: spectrum_quantity(),
        scale: Scale::Decibel { floor: FLOOR },
        measured: plane.radial.power.view(),
        predicted: plane.predicted_radial.view(),
        z: difference.view(),
    };
    write(
        results,
        &format!("{name}/spectrum"),
        &comparison(&spectrum).map_err(Failure::cannot_run)?,
    )
}

/// The strip along the path; returns it as SVG.
pub fn path(
    results: &mut Results,
    case: &MeasuredScene,
    planes: &[PlaneComparison],
) -> Result<String, Failure> {
    let photons = case.measurement.emitted();
    let figure = strip_of(&case.scene, photons, &case.theories, planes, None)?;
    write(results, "path", &figure)?;
    Ok(figure.svg)
}

/// The planes in the order in which light meets them; in the style of a figure, with their
/// predicted spectra below. `photons` is the number emitted: a partial measurement has fewer than
/// the scene requests.
#[expect(
    clippy::too_many_lines,
    reason = "one drawing, from planes to its rows"
)]
pub fn strip_of(
    scene: &Scene,
    photons: u64,
    theories: &[Applicability],
    planes: &[PlaneComparison],
    style: Option<&Style>,
) -> Result<Figure, Failure> {
    let mut along: Vec<_> = scene
        .planes
        .iter()
        .zip(planes.iter().zip(theories))
        .collect();
    along.sort_by(|(a, _), (b, _)| {
        let place = |plane: &VirtualPlane| (plane.distance, plane.side == Side::After);
        place(a).partial_cmp(&place(b)).unwrap_or(Ordering::Equal)
    });
    let predicted = style.is_some();
    let columns = along.iter().map(|(plane, (compared, theory))| {
        let mut column = column(scene, plane, theory, compared);
        if predicted {
            column.predicted = Some(Picture {
                values: compared.predicted_radial.view(),
                ..column.spectrum.clone()
            });
        }
        column
    });
    let mut columns: Vec<StripColumn<'_>> = columns.collect();
    let dashed = dashed(&columns, planes);
    let chain_fails = planes.iter().any(|plane| {
        let chain = plane.report.first_order.as_ref();
        chain.is_some_and(|chain| chain.verdict == Verdict::Fail)
    });
    let off_chain = along.iter().map(|(_, (compared, _))| off_chain(compared));
    let off_chain: Vec<_> = off_chain.filter(|_| chain_fails).collect();
    for (column, values) in columns.iter_mut().zip(&off_chain) {
        column.off_chain = Some(Picture {
            values: values.view(),
            ..column.spectrum.clone()
        });
    }
    let mut section = drawing::cross_section(scene, along.iter().map(|(plane, _)| *plane));
    if predicted {
        // A figure has no room for a second cut, or for the light field in it.
        section.other = None;
    }
    let others = along.iter().map(|(plane, (compared, _))| {
        let grid = &compared.projection.mean.grid;
        let values = across(&compared.measured, [grid.half_x, grid.half_u])?;
        let slices = compared.measured.full();
        let power = |azimuth| {
            let slice = slices.index_axis(Axis(0), azimuth);
            slice.mapv(|value| value.norm_sqr())
        };
        let [own, other] = [0, compared.measured.grid.azimuths / 2].map(power);
        Some((across_axes(plane, grid), values, own, other))
    });
    let is_seen = !predicted && (section.other.is_some() || planes.iter().any(differs_across));
    let others: Option<Vec<_>> = if is_seen { others.collect() } else { None };
    for (column, ([x, y], values, own, other)) in columns.iter_mut().zip(others.iter().flatten()) {
        let spectrum = column.spectrum.clone();
        column.spectrum.values = own.view();
        // Of two lines through the origin the first is in the plane of incidence.
        let is_shear = |guide: &&Guide| guide.through == [0.0, 0.0];
        let shears: Vec<Guide> = column.guides.iter().filter(is_shear).copied().collect();
        if let [own, other] = shears[..] {
            column
                .guides
                .retain(|guide| *guide != other || own == other);
        }
        column.across = Some(AcrossPictures {
            light_field: Picture {
                x: x.clone(),
                y: y.clone(),
                values: values.view(),
            },
            spectrum: Picture {
                values: other.view(),
                ..spectrum
            },
            guides: shears.last().copied().into_iter().collect(),
        });
    }
    let shown = if others.is_some() {
        "at azimuth 0 below (*x*, *u*), and at 90° below (*y*, *v*)"
    } else {
        spectra_are(scene.planes.iter())
    };
    let drawn = Strip {
        title: &format!(
            "{}: the light field along the path, and its spectrum",
            scene.name
        ),
        note: &format!(
            "{} photons, seed {}; spectra are {}.{dashed}",
            grouped(photons),
            scene.run.seed,
            shown
        ),
        section: &section,
        columns,
        light_field: light_field_quantity(),
        spectrum: spectrum_quantity(),
        full_radial: full_radial_quantity(),
        floor: FLOOR,
    };
    strip(&drawn, &style.copied().unwrap_or_default()).map_err(Failure::cannot_run)
}

/// A description of which spectra of planes are drawn.
pub fn spectra_are<'a>(planes: impl Iterator<Item = &'a VirtualPlane>) -> &'static str {
    let counts: Vec<usize> = planes.map(|plane| plane.grid.azimuths).collect();
    match counts.iter().filter(|count| **count == 1).count() {
        0 => "means over azimuths",
        slices if slices == counts.len() => "those at azimuth 0",
        _ => "means over azimuths, or those at azimuth 0 where there is one",
    }
}

/// A description of the dashed lines of a strip.
fn dashed(columns: &[StripColumn<'_>], planes: &[PlaneComparison]) -> &'static str {
    let most = columns.iter().map(|column| column.guides.len()).max();
    let is_exact = planes.iter().all(|p| p.report.class == Class::Exact);
    match (most, is_exact) {
        (None | Some(0), _) => "",
        (Some(1), true) => " Dashed: predicted, *ν* = −*d* *ρ*.",
        (_, true) => " Dashed: predicted, *ν* = −*d* *ρ*, and its replicas.",
        (_, false) => {
            " Dashed: where the chain puts the light, in the plane of incidence and across it."
        }
    }
}

/// The difference of the photons from the first-order chain, in percent of the largest measured
/// |S|, [ρ, ν].
fn off_chain(compared: &PlaneComparison) -> Array2<f64> {
    let power = &compared.radial.power;
    let peak = power.iter().copied().fold(0.0, f64::max);
    match &compared.off_chain {
        Some(off) => off.mapv(|off| 100.0 * (off / peak).sqrt()),
        None => Array2::from_elem(power.dim(), f64::NAN),
    }
}

/// The full radial spectrum of a plane, measured and predicted.
pub fn full_radial<'a>(
    plane: &VirtualPlane,
    compared: &'a FullRadialComparison,
) -> [Picture<'a>; 2] {
    let [x, y] = full_radial_axes(plane, &compared.measured);
    [&compared.measured.power, &compared.predicted].map(|power| Picture {
        x: x.clone(),
        y: y.clone(),
        values: power.view(),
    })
}

/// The column of pictures under a plane.
fn column<'a>(
    scene: &Scene,
    plane: &VirtualPlane,
    applicability: &Applicability,
    compared: &'a PlaneComparison,
) -> StripColumn<'a> {
    let projection = &compared.projection.mean;
    let words = CoordinateNames::of(plane);
    let [x, u] = words.projection_axes(&projection.grid);
    let [rho, nu] = words.frequency_axes(&compared.measured.grid);
    StripColumn {
        light_field: Picture {
            x,
            y: u,
            values: projection.values.view(),
        },
        spectrum: Picture {
            x: rho,
            y: nu,
            values: compared.radial.power.view(),
        },
        across: None,
        predicted: None,
        full_radial: compared
            .full_radial
            .as_ref()
            .map(|full| full_radial(plane, full)),
        off_chain: None,
        verdict: verdict_lines(compared),
        guides: match (&applicability.theory, &compared.report.first_order) {
            (Theory::Parallel(_), _) if compared.report.in_window > 0 => guides(scene, plane),
            // A lobe leaves no line of light, unlike a mirror.
            (Theory::Specular(_), Some(first_order)) => ridges(scene, &first_order.chain.matrix),
            _ => Vec::new(),
        },
    }
}

/// The source of a picture, in a line.
pub fn made_from(summary: &Summary) -> String {
    format!(
        "{}, {} photons, seed {}",
        summary.scene,
        grouped(summary.photons),
        summary.seed
    )
}

/// Lines where theory puts the light: along ν = −d ρ after travel d, and, at a distance h behind
/// blockers of frequency f that the window and the frequencies can resolve, the same line through
/// (± f, ∓ h f). A diffuse surface keeps only ν = 0, and travel begins again.
fn guides(scene: &Scene, plane: &VirtualPlane) -> Vec<Guide> {
    let reflected = plane.leg > 0;
    let through = |through| Guide {
        through,
        slope: -scene.path.along(plane),
        is_across: false,
    };
    let behind = scene
        .blockers
        .iter()
        .filter(|layer| !reflected && stands_before(layer.distance, scene, plane));
    let replicas = behind.flat_map(|layer| {
        let h = plane.distance - layer.distance;
        let (period, most) = (2.0 * plane.window.x.half_width(), plane.grid.rho.max());
        let seen = |pitch: &f64| *pitch < period && *pitch * most >= 1.0;
        let frequency = layer.pitch.filter(seen).map(|pitch| 1.0 / pitch);
        frequency.map_or(Vec::new(), |f| vec![[f, -h * f], [-f, h * f]])
    });
    std::iter::once([0.0, 0.0])
        .chain(replicas)
        .map(through)
        .collect()
}

/// Lines where the chain puts the light of a picture, in the plane of incidence and across it:
/// light of a projector lies along ρ where it begins, light of a beam along ν, and content at Ω
/// goes to A⁻ᵀ Ω.
fn ridges(scene: &Scene, matrix: &[[f64; 4]; 4]) -> Vec<Guide> {
    let slope = |i: usize| {
        let [position, slope] = [matrix[i], matrix[i + 2]];
        let free = if scene.light.is_distant() { i } else { i + 2 };
        -position[free] / slope[free]
    };
    let guides = [0, 1].map(|i| Guide {
        through: [0.0, 0.0],
        slope: slope(i),
        is_across: i == 1,
    });
    let same = (guides[0].slope - guides[1].slope).abs() <= NEAR * guides[0].slope.abs().max(1.0);
    let guides = guides.into_iter().take(if same { 1 } else { 2 });
    guides
        .filter(|guide| guide.slope.abs() < STEEPEST)
        .collect()
}

/// The relative difference of two slopes that coincide up to rounding.
const NEAR: f64 = 1e-9;

/// The distance in metres beyond which a line is vertical in any picture.
const STEEPEST: f64 = 1e6;

/// Draws the scene with its central ray and planes, as a PNG or SVG file to be written at `path`.
pub fn drawn_scene(scene: &Scene, path: &Path) -> Result<Vec<u8>, Failure> {
    let figure = section(
        &drawing::cross_section(scene, scene.planes.iter()),
        &scene.name,
        "",
    )
    .map_err(Failure::cannot_run)?;
    Ok(match path.extension().and_then(|e| e.to_str()) {
        Some("svg") => figure.svg.into_bytes(),
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

/// Writes a figure as PNG, SVG and the numbers behind it.
pub fn write(results: &mut Results, name: &str, figure: &Figure) -> Result<(), Failure> {
    let png = figure.png().map_err(Failure::cannot_run)?;
    results.write(&format!("{name}.png"), &png)?;
    results.write(&format!("{name}.svg"), figure.svg.as_bytes())?;
    results.write(&format!("{name}.csv"), figure.csv.as_bytes())
}

/// The verdict on a plane and its reasons, in a line.
pub fn verdict_line(plane: &PlaneComparison) -> String {
    verdict_lines(plane).join(", ")
}

/// The same in lines as narrow as a picture.
pub fn verdict_lines(plane: &PlaneComparison) -> Vec<String> {
    let report = &plane.report;
    let verdict = word(report.verdict);
    if report.verdict == Verdict::Undecided {
        return vec![p_value(report), verdict.to_owned()];
    }
    let chain = report.first_order.as_ref();
    let mut lines = match chain.filter(|chain| chain.verdict == Verdict::Fail) {
        Some(chain) => vec![
            format!("chain {} off: fail", table::percent(chain.excess)),
            format!("computed: {}", percent(chain.chain.error, 3)),
            format!("rays: {}", p_value(report)),
        ],
        None => vec![format!("{}, {verdict}", p_value(report))],
    };
    let chi2 = report.chi2_per_dof;
    lines.extend(chi2.map(|t| format!("*χ*^{{2}}/dof = {t:.3}")));
    let full_radial = report.full_radial.and_then(|full| full.p_value);
    lines.extend(full_radial.map(|p| format!("full radial *p* = {p:.3}")));
    // The disagreement is within that error, which is why the plane passes.
    let is_excused = report.exact_verdict() == Verdict::Pass && report.p_value < Some(0.001);
    let error = report.quadrature_error.filter(|_| is_excused);
    lines.extend(error.map(|error| format!("quadrature ± {}", percent(error, 3))));
    if plane.predicted.is_dark() && report.verdict == Verdict::Pass {
        lines.push("dark, as predicted".to_owned());
    }
    lines
}

fn p_value(report: &PlaneReport) -> String {
    match report.p_value {
        None => "no photons".to_owned(),
        Some(p) if p < 0.001 => "*p* < 0.001".to_owned(),
        Some(p) => format!("*p* = {p:.3}"),
    }
}
