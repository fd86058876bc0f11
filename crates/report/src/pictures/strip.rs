//! The strip along the path: the scene and, below it, the light field and spectrum of each plane.

use super::cross_section::{across, differs_across};
use super::finer::{Finer, finer_powers};
use super::seen::{Seen, full_radials, light_fields, spectra};
use super::{PictureFiles, verdict_lines};
use crate::drawing;
use etendue_compare::{Class, PlaneComparison, Verdict};
use etendue_field::{Side, Slices, VirtualPlane, grouped};
use etendue_figures::{AxisQuantity, Figure, Guide, Picture, PlateRow, Scale, Strip, Style, strip};
use etendue_pipeline::MeasuredScene;
use etendue_predict::{Applicability, Theory, stands_before};
use etendue_scene::Scene;
use etendue_store::Failure;
use ndarray::{Array2, Axis};
use rayon::prelude::*;
use std::cmp::Ordering;

/// Draws the strip along the path.
pub fn path(case: &MeasuredScene, planes: &[PlaneComparison]) -> Result<PictureFiles, Failure> {
    let photons = case.measurement.emitted();
    let figure = strip_of(&case.scene, photons, &case.theories, planes, None)?;
    PictureFiles::new("path".to_owned(), figure)
}

/// Draws the planes in the order in which light meets them, with predicted below measured spectra;
/// or, if the light at azimuth 0 differs from that at 90° and the strip is no figure, with measured
/// spectra at both. `photons` is the number of emitted photons, which is lower in a partial
/// measurement than the scene requests.
pub fn strip_of(
    scene: &Scene,
    photons: u64,
    theories: &[Applicability],
    planes: &[PlaneComparison],
    style: Option<&Style>,
) -> Result<Figure, Failure> {
    let along = in_order(scene, theories, planes);
    let is_figure = style.is_some();
    let mut section = drawing::cross_section(scene, along.iter().map(|at| at.seen.plane));
    let is_even = |plane: &VirtualPlane| plane.grid.azimuths.is_multiple_of(2);
    let differs = scene.planes.iter().all(is_even)
        && (section.other.is_some() || planes.iter().any(differs_across));
    if is_figure {
        // A figure has no space for a second cut and the light field of this cut.
        section.other = None;
    }
    let dashed = predicted_lines(&along, planes);
    let both = (differs && !is_figure).then(|| along.iter().map(BothSlices::of).collect());
    let both: Option<Vec<BothSlices>> = both.flatten();
    let off_chain = off_chains(&along);
    // Figures are not interpolated, because they were run at finer frequencies.
    let finer = along.par_iter().filter(|_| !is_figure && both.is_none());
    let finer: Vec<_> = finer
        .map(|at| finer_powers(at.seen.plane, at.seen.found))
        .collect();
    let rows = rows_of(&along, both.as_deref(), &finer, &off_chain, is_figure);
    let shown = match (&both, is_figure && differs) {
        (Some(_), _) => BOTH.to_owned(),
        (None, true) => format!("{}{MIXED}", spectra_are(scene.planes.iter())),
        (None, false) => spectra_are(scene.planes.iter()).to_owned(),
    };
    let drawn = Strip {
        title: &format!(
            "{}: the light field along the path, and its spectrum",
            scene.name
        ),
        note: &format!(
            "{} photons, seed {}{}; spectra are {shown}.{dashed}",
            grouped(photons),
            scene.run.seed,
            scene.file.run.color.suffix(),
        ),
        section: &section,
        rows,
        verdicts: along
            .iter()
            .map(|at| verdict_lines(at.seen.found))
            .collect(),
    };
    // Who draws a figure keeps its page low, with all of its parts.
    let figure = match style {
        Some(style) => strip(&drawn, style),
        None => Style::default().within_height(|style| strip(&drawn, style)),
    };
    figure.map_err(Failure::cannot_run)
}

/// The rows of pictures below the scene. `both` has the slices at 0 and at 90° if both are
/// shown, and `off_chain` has the distances from the chain if they are shown.
fn rows_of<'a>(
    along: &'a [PlaneOnPath<'_>],
    both: Option<&'a [BothSlices]>,
    finer: &'a [Option<[Array2<f64>; 2]>],
    off_chain: &'a [Array2<f64>],
    is_figure: bool,
) -> Vec<PlateRow<'a>> {
    let seen = || along.iter().map(|at| at.seen);
    let mut rows = vec![light_fields(
        "light field",
        false,
        seen().map(|seen| seen.light_field()),
    )];
    if let Some(both) = both {
        let sides = || seen().zip(both);
        let spectra_at = |side| sides().map(move |(seen, both)| both.spectrum(seen, side));
        rows.push(spectra("spectrum", false, spectra_at(0)));
        let across = sides().map(|(seen, both)| seen.across(both.light_field.view()));
        rows.push(light_fields("across", false, across));
        rows.push(spectra("its spectrum", false, spectra_at(1)));
    } else {
        let radial = |side: usize| {
            let finer = finer
                .iter()
                .map(move |both| Some(both.as_ref()?[side].view()));
            let finer = finer.chain(std::iter::repeat(None));
            along.iter().zip(finer).map(move |(at, finer)| {
                let PlaneComparison {
                    radial,
                    predicted_radial,
                    ..
                } = at.seen.found;
                Picture {
                    finer,
                    ..at.spectrum([&radial.power, predicted_radial][side])
                }
            })
        };
        rows.push(spectra("spectrum", false, radial(0)));
        rows.push(spectra("predicted", false, radial(1)));
    }
    if let Some([measured, predicted]) = full_radials(seen(), false) {
        rows.push(measured);
        rows.extend(is_figure.then_some(predicted));
    }
    if !off_chain.is_empty() {
        let quantity = AxisQuantity::new("off the chain", "% of the peak");
        let pictures = seen().zip(off_chain);
        let pictures = pictures.map(|(seen, values)| seen.spectrum(values.view()));
        let pictures = pictures.collect();
        rows.push(PlateRow {
            bar: Some("|*S* − chain|"),
            ..PlateRow::new("off the chain", quantity, Scale::Linear, true, pictures)
        });
    }
    rows
}

/// The note below a strip if the light at azimuth 0 differs from the light at 90°.
const BOTH: &str = "at azimuth 0 below (*x*, *u*), and at 90° below (*y*, *v*). The light field \
    in (*y*, *v*) is the inverse transform of the spectrum at 90°. This spectrum ends at the highest \
    frequencies of the grid, so edges have fringes (Gibbs phenomenon)";
/// The warning in a figure that shows the mean over azimuths although the slices at 0 and 90°
/// differ.
const MIXED: &str = "; the light differs between azimuths 0 and 90°";

/// A plane with its results, along the path.
struct PlaneOnPath<'a> {
    seen: Seen<'a>,
    /// Predicted lines over the spectrum.
    guides: Vec<Guide>,
}

/// The planes in the order in which light meets them.
fn in_order<'a>(
    scene: &'a Scene,
    theories: &'a [Applicability],
    planes: &'a [PlaneComparison],
) -> Vec<PlaneOnPath<'a>> {
    let each = scene.planes.iter().zip(planes).zip(theories);
    let each = each.map(|((plane, found), theory)| {
        let seen = Seen { plane, found };
        PlaneOnPath {
            seen,
            guides: all_guides(scene, seen, theory),
        }
    });
    let mut along: Vec<_> = each.collect();
    let place = |at: &PlaneOnPath<'_>| (at.seen.plane.distance, at.seen.plane.side == Side::After);
    along.sort_by(|a, b| place(a).partial_cmp(&place(b)).unwrap_or(Ordering::Equal));
    along
}

impl<'a> PlaneOnPath<'a> {
    /// A spectrum with its predicted lines.
    fn spectrum(&self, power: &'a Array2<f64>) -> Picture<'a> {
        Picture {
            guides: self.guides.clone(),
            ..self.seen.spectrum(power.view())
        }
    }
}

/// The light field in (y, v), and the spectra at azimuths 0 and 90° with their predicted lines.
struct BothSlices {
    light_field: Array2<f64>,
    spectra: [Array2<f64>; 2],
    finer: Option<[Array2<f64>; 2]>,
    guides: [Vec<Guide>; 2],
}

impl BothSlices {
    /// Returns `None` if there is no slice at 90°.
    fn of(at: &PlaneOnPath<'_>) -> Option<Self> {
        let measured = &at.seen.found.measured;
        let grid = &at.seen.found.projection.mean.grid;
        let light_field = across(measured, [grid.half_x, grid.half_u])?;
        let powers = |slices: &Slices| {
            let full = slices.full();
            [0, slices.grid.azimuths / 2].map(|azimuth| {
                let slice = full.index_axis(Axis(0), azimuth);
                slice.mapv(|value| value.norm_sqr())
            })
        };
        let finer = Finer::new(&measured.grid, &at.seen.plane.window);
        Some(Self {
            light_field,
            spectra: powers(measured),
            finer: finer.map(|finer| powers(&finer.of(measured))),
            guides: by_azimuth(&at.guides),
        })
    }

    /// The spectrum at azimuth 0 (side 0) or 90° (side 1).
    fn spectrum<'a>(&'a self, seen: Seen<'_>, side: usize) -> Picture<'a> {
        Picture {
            finer: self.finer.as_ref().map(|finer| finer[side].view()),
            guides: self.guides[side].clone(),
            ..seen.spectrum(self.spectra[side].view())
        }
    }
}

/// The lines over the spectra at azimuths 0 and 90°. If there are two lines through the
/// origin, the first line belongs to the plane of incidence.
fn by_azimuth(guides: &[Guide]) -> [Vec<Guide>; 2] {
    let is_shear = |guide: &&Guide| guide.through == [0.0, 0.0];
    let shears: Vec<Guide> = guides.iter().filter(is_shear).copied().collect();
    let mut own = guides.to_vec();
    if let [first, other] = shears[..]
        && other.is_across
    {
        own.retain(|guide| *guide != other || first == other);
    }
    // Behind parallel planes, each line belongs to a light, and to both pictures.
    let is_shared = shears.iter().all(|guide| !guide.is_across);
    let across = if is_shared {
        shears
    } else {
        shears.last().copied().into_iter().collect()
    };
    [own, across]
}

/// The differences between the photons and the first-order chains, if the map of one chain
/// is wrong.
fn off_chains(along: &[PlaneOnPath<'_>]) -> Vec<Array2<f64>> {
    let fails = along.iter().any(|at| {
        let chain = at.seen.found.report.first_order.as_ref();
        chain.is_some_and(|chain| chain.verdict == Verdict::Fail)
    });
    let each = along.iter().filter(|_| fails);
    each.map(|at| off_chain(at.seen.found)).collect()
}

/// Describes which spectra of planes are drawn.
pub fn spectra_are<'a>(planes: impl Iterator<Item = &'a VirtualPlane>) -> &'static str {
    let counts: Vec<usize> = planes.map(|plane| plane.grid.azimuths).collect();
    match counts.iter().filter(|count| **count == 1).count() {
        0 => "means over azimuths",
        slices if slices == counts.len() => "slices at azimuth 0",
        _ => "means over azimuths; at planes with only one azimuth, slices at azimuth 0",
    }
}

/// A description of the predicted lines of a strip.
fn predicted_lines(along: &[PlaneOnPath<'_>], planes: &[PlaneComparison]) -> &'static str {
    let mut guides = along.iter().flat_map(|at| &at.guides);
    let has_replicas = guides.clone().any(|guide| guide.through != [0.0, 0.0]);
    let is_exact = planes.iter().all(|p| p.report.class == Class::Exact);
    match (guides.next(), is_exact) {
        (None, _) => "",
        (_, true) if !has_replicas => " Lines at the edges: predicted, *ν* = −*d* *ρ*.",
        (_, true) => " Lines at the edges: predicted, *ν* = −*d* *ρ*, and its replicas.",
        (_, false) => {
            " Lines at the edges: the spectrum according to the chain, in the plane of incidence and orthogonal to it."
        }
    }
}

/// The difference between the photons and the first-order chain, in percent of the largest
/// measured |S|, [ρ, ν].
fn off_chain(compared: &PlaneComparison) -> Array2<f64> {
    let power = &compared.radial.power;
    let peak = power.iter().copied().fold(0.0, f64::max);
    match &compared.off_chain {
        Some(off) => off.mapv(|off| 100.0 * (off / peak).sqrt()),
        None => Array2::from_elem(power.dim(), f64::NAN),
    }
}

/// The predicted lines over the spectrum of a plane.
fn all_guides(scene: &Scene, seen: Seen<'_>, theory: &Applicability) -> Vec<Guide> {
    let report = &seen.found.report;
    match (&theory.theory, &report.first_order) {
        (Theory::Parallel(_), _) if report.in_window > 0 => {
            let lights = theory.of_lights(scene, seen.plane);
            let lights = lights.filter(|(.., of, _)| matches!(of.theory, Theory::Parallel(_)));
            let mut all: Vec<Guide> = Vec::new();
            for guide in lights.flat_map(|(of, seen, ..)| guides(of, seen)) {
                // Lights in one plane have the same lines.
                if !all.contains(&guide) {
                    all.push(guide);
                }
            }
            all
        }
        // After a mirror, the power of the spectrum lies along a line; after a lobe, it does not.
        (Theory::Path(view), Some(first_order)) if view.system.scatterers() == 0 => {
            ridges(scene, &first_order.chain.matrix)
        }
        _ => Vec::new(),
    }
}

/// Lines along which theory predicts the power of the spectrum. After light has travelled a
/// distance d, its spectrum lies along ν = −d ρ. At a distance h behind blockers of frequency f,
/// the spectrum also lies along parallel lines through (± f, ∓ h f). These lines are returned if
/// the window and the frequencies resolve them. After a diffuse surface, only ν = 0 remains, and d
/// is measured from this surface.
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

/// Lines for a picture, in the plane of incidence and across it. According to the chain,
/// the spectrum lies along these lines. At the light, the spectrum of a projector lies along ρ, and
/// the spectrum of a beam lies along ν. The map of the chain moves the value of the spectrum at Ω
/// to A⁻ᵀ Ω.
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

/// A line with a slope of at least this modulus, in metres, is left out, because it would be
/// vertical in any picture.
const STEEPEST: f64 = 1e6;
