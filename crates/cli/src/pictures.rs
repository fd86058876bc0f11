//! The pictures of a run: light field and spectrum of each plane, and the strip along the path.

use crate::drawing;
use crate::failure::Failure;
use crate::files::{radial_z, z};
use crate::results::Results;
use crate::summary::Summary;
use crate::table::word;
use etendue_compare::{Class, PlaneComparison, Prediction, stands_before};
use etendue_field::{FrequencyAxis, Light, ProjectionGrid, Side, SliceGrid, VirtualPlane};
use etendue_figures::{
    Axis, Column, Comparison, Figure, Guide, Picture, Quantity, Scale, Strip, comparison, section,
    strip,
};
use etendue_scene::Scene;
use std::cmp::Ordering;
use std::fs;
use std::path::Path;

/// Lowest level of a spectrum's colors, in decibels below its peak.
const FLOOR: f64 = -50.0;

/// `primal` and `spectrum` of a plane.
pub(crate) fn plane(
    results: &mut Results,
    summary: &Summary,
    prediction: &Prediction,
    plane: &PlaneComparison,
) -> Result<(), Failure> {
    let name = &plane.report.name;
    let note = format!("{}; {}", made_from(summary), verdict_line(plane));
    let measured = &plane.projection.mean;
    let [x, u] = projection_axes(&measured.grid);
    let difference = z(
        &measured.values,
        &prediction.projection.values,
        &plane.projection.standard_error,
    );
    let primal = Comparison {
        title: &format!(
            "{}: light field in (*x*, *u*), integrated over *y* and *v*",
            spaced(name)
        ),
        note: &note,
        x,
        y: u,
        quantity: light_field_quantity(),
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

    let [rho, nu] = frequency_axes(&plane.measured.grid);
    let difference = radial_z(plane);
    let spectrum = Comparison {
        title: &format!(
            "{}: radial spectrum, mean over {} azimuths",
            spaced(name),
            plane.measured.grid.azimuths
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

/// The strip along the path: the planes in the order in which light meets them.
pub(crate) fn path(
    results: &mut Results,
    summary: &Summary,
    scene: &Scene,
    planes: &[PlaneComparison],
) -> Result<(), Failure> {
    let mut along: Vec<(&VirtualPlane, &PlaneComparison)> =
        scene.planes.iter().zip(planes).collect();
    along.sort_by(|(a, _), (b, _)| {
        let place = |plane: &VirtualPlane| (plane.distance, plane.side == Side::After);
        place(a).partial_cmp(&place(b)).unwrap_or(Ordering::Equal)
    });
    let columns = along
        .iter()
        .map(|(plane, compared)| column(scene, plane, compared));
    let columns: Vec<Column<'_>> = columns.collect();
    let guided = |more: usize| columns.iter().any(|column| column.guides.len() > more);
    let dashed = match (guided(0), guided(1)) {
        (true, true) => " Dashed: predicted, *ν* = −*d* *ρ*, and its replicas.",
        (true, false) => " Dashed: predicted, *ν* = −*d* *ρ*.",
        _ => "",
    };
    let figure = strip(&Strip {
        title: &format!(
            "{}: the light field along the path, and its spectrum",
            scene.name
        ),
        note: &format!(
            "{:e} photons, seed {}; spectra are means over azimuths.{dashed}",
            summary.photons as f64, summary.seed
        ),
        section: &drawing::cross_section(scene, along.iter().map(|(plane, _)| *plane)),
        columns,
        light_field: light_field_quantity(),
        spectrum: spectrum_quantity(),
        floor: FLOOR,
    })
    .map_err(Failure::cannot_run)?;
    write(results, "path", &figure)
}

/// What is shown under a plane.
fn column<'a>(scene: &Scene, plane: &VirtualPlane, compared: &'a PlaneComparison) -> Column<'a> {
    let projection = &compared.projection.mean;
    let [x, u] = projection_axes(&projection.grid);
    let [rho, nu] = frequency_axes(&compared.measured.grid);
    Column {
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
        verdict: verdict_line(compared),
        guides: match (compared.report.class, &compared.report.first_order) {
            (Class::Exact, _) if compared.report.in_window > 0 => guides(scene, plane),
            (Class::FirstOrder, Some(first_order)) => ridges(scene, &first_order.chain.matrix),
            _ => Vec::new(),
        },
    }
}

/// What a picture was made from, in a line.
fn made_from(summary: &Summary) -> String {
    format!(
        "{}, {:e} photons, seed {}",
        summary.scene, summary.photons as f64, summary.seed
    )
}

/// Where theory puts the light: along ν = −d ρ after travel d, and, at a distance h behind blockers of
/// frequency f that the window and the frequencies can tell from a single one, the same line through (± f, ∓ h f). A diffuse surface leaves what lies at ν = 0, and travel begins anew.
fn guides(scene: &Scene, plane: &VirtualPlane) -> Vec<Guide> {
    let reflected = plane.leg > 0;
    let through = |through| Guide {
        through,
        slope: -scene.path.along(plane),
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

/// Where the chain puts the light of a picture, in the plane of incidence and across it: a projector's lies along ρ where it begins, a
/// beam's along ν, and content at Ω goes to A⁻ᵀ Ω.
fn ridges(scene: &Scene, matrix: &[[f64; 4]; 4]) -> Vec<Guide> {
    let slope = |i: usize| {
        let [position, slope] = [matrix[i], matrix[i + 2]];
        match scene.light {
            Light::Beam { .. } => -position[i] / slope[i],
            _ => -position[i + 2] / slope[i + 2],
        }
    };
    let through = [0.0, 0.0];
    let slopes = [0, 1].map(slope).into_iter();
    let guides = slopes.filter(|slope| slope.abs() < STEEPEST);
    guides.map(|slope| Guide { through, slope }).collect()
}

/// Metres beyond which a line is upright in any picture.
const STEEPEST: f64 = 1e6;

/// Draws the scene with its central ray and planes into a PNG or SVG file.
pub(crate) fn draw_scene(scene: &Scene, path: &Path) -> Result<(), Failure> {
    let figure = section(
        &drawing::cross_section(scene, scene.planes.iter()),
        &scene.name,
        "",
    )
    .map_err(Failure::cannot_run)?;
    let bytes = match path.extension().and_then(|e| e.to_str()) {
        Some("svg") => figure.svg.into_bytes(),
        Some("png") => figure.png().map_err(Failure::cannot_run)?,
        _ => {
            let message = format!(
                "--draw {}: the file must end in .png or .svg",
                path.display()
            );
            return Err(Failure::bad_input(message));
        }
    };
    fs::write(path, bytes).map_err(|e| Failure::write(path, e))
}

/// Writes a figure as PNG, SVG and the numbers behind it.
fn write(results: &mut Results, name: &str, figure: &Figure) -> Result<(), Failure> {
    let png = figure.png().map_err(Failure::cannot_run)?;
    results.write(&format!("{name}.png"), &png)?;
    results.write(&format!("{name}.svg"), figure.svg.as_bytes())?;
    results.write(&format!("{name}.csv"), figure.csv.as_bytes())
}

fn projection_axes(grid: &ProjectionGrid) -> [Axis; 2] {
    [
        Axis::edges("*x*", "m", [-grid.half_x, grid.half_x]),
        Axis::edges("*u*", "", [-grid.half_u, grid.half_u]),
    ]
}

fn frequency_axes(grid: &SliceGrid) -> [Axis; 2] {
    let axis = |name, unit, axis: &FrequencyAxis| {
        Axis::centers(name, unit, [-axis.max(), axis.max()], axis.count())
    };
    [
        axis("*ρ*", "cycles/m", &grid.rho),
        axis("*ν*", "cycles per unit slope", &grid.nu),
    ]
}

fn light_field_quantity() -> Quantity {
    Quantity::new("∬ *L W* d*y* d*v*", "W m^{−2} sr^{−1} m")
}

fn spectrum_quantity() -> Quantity {
    Quantity::new("⟨|*S*_{φ}|^{2}⟩", "")
}

fn verdict_line(plane: &PlaneComparison) -> String {
    let p = match plane.report.p_value {
        None => "no photons".to_owned(),
        Some(p) if p < 0.001 => "*p* < 0.001".to_owned(),
        Some(p) => format!("*p* = {p:.3}"),
    };
    let chi2 = plane.report.chi2_per_dof;
    let chi2 = chi2.map_or(String::new(), |t| format!(", *χ*^{{2}}/dof = {t:.3}"));
    format!("{p}{chi2}, {}", word(plane.report.verdict))
}

/// A name as read: underscores are spaces.
pub(crate) fn spaced(name: &str) -> String {
    name.replace('_', " ")
}
