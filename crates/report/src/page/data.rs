//! The data of a run that a page shows.

use crate::pictures::{light_field_axes, light_field_quantity, spectrum_axes, verdict_line};
use crate::shell_word;
use crate::table::{self, on_chain, verdict_text};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use etendue_compare::{PlaneComparison, PlaneReport, Prediction, Verdict};
use etendue_field::{VirtualPlane, grouped};
use etendue_figures::Axis;
use etendue_pipeline::{MeasuredScene, Summary};
use etendue_scene::SceneFile;
use etendue_store::Method;
use etendue_store::arrays::{radial_z, z};
use ndarray::{Array2, ArrayView2, Axis as Along, Zip};
use serde::Serialize;

/// The largest size, in bytes, of the slices of all planes that a page contains. A page with
/// larger slices omits the slices and refers to `slices.npz`.
const MOST_SLICES: usize = 1_500_000;

#[derive(Serialize)]
struct RunData<'a> {
    scene: &'a str,
    verdict: Verdict,
    /// The verdict in a sentence.
    words: String,
    provenance: String,
    scene_file: &'a SceneFile,
    /// The address at which the explorer shows the scene.
    explorer: Option<&'a str>,
    /// The strip along the path, SVG.
    path: &'a str,
    planes: Vec<PlaneData<'a>>,
    /// The tables that the terminal also shows. The first row of each table is its header.
    tables: [Vec<Vec<String>>; 2],
}

#[derive(Serialize)]
struct PlaneData<'a> {
    report: &'a PlaneReport,
    /// The verdict with its p-value.
    words: String,
    /// The message about a first-order chain that does not pass.
    on_chain: Option<String>,
    axes: PageAxes,
    /// Azimuths, radians.
    azimuths: Vec<f64>,
    field: Grids,
    /// The unit of the light field.
    field_unit: String,
    /// The radial spectrum for ρ ≥ 0; the slices also have ρ ≥ 0.
    radial: Grids,
    /// A slice for each azimuth; `None` if the slices are too large.
    slices: Option<Vec<Grids>>,
}

#[derive(Serialize)]
struct PageAxes {
    x: Labelled,
    u: Labelled,
    rho: Labelled,
    nu: Labelled,
}

/// An axis, from the outer edge of its first cell to the outer edge of its last cell.
#[derive(Serialize)]
struct Labelled {
    name: String,
    unit: String,
    min: f64,
    max: f64,
    count: usize,
}

/// Three pictures, each as an array [x, y] of 32-bit numbers in base 64.
#[derive(Serialize)]
struct Grids {
    measured: String,
    predicted: String,
    z: String,
}

impl Labelled {
    fn new(axis: &Axis, count: usize) -> Self {
        let plain = |text: &str| text.replace('*', "").replace("^{2}", "²");
        Self {
            name: plain(&axis.quantity.name),
            unit: plain(&axis.quantity.unit),
            min: axis.min,
            max: axis.max,
            count,
        }
    }
}

impl Grids {
    fn new(
        measured: ArrayView2<'_, f64>,
        predicted: ArrayView2<'_, f64>,
        z: ArrayView2<'_, f64>,
    ) -> Self {
        let [measured, predicted, z] = [measured, predicted, z].map(encoded);
        Self {
            measured,
            predicted,
            z,
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the page only shows the numbers"
)]
fn encoded(values: ArrayView2<'_, f64>) -> String {
    let bytes = values
        .iter()
        .flat_map(|value| (*value as f32).to_le_bytes());
    STANDARD.encode(bytes.collect::<Vec<u8>>())
}

/// The data of a run as JSON. The data include the strip along the path as SVG, and the
/// address at which the explorer shows the scene, if there is one.
pub fn data(
    case: &MeasuredScene,
    summary: &Summary,
    planes: &[PlaneComparison],
    (path, explorer): (&str, Option<&str>),
) -> String {
    let slices: usize = planes.iter().map(|plane| 3 * 4 * plane.sigma.len()).sum();
    let each = case.scene.planes.iter().zip(planes).zip(&case.predictions);
    let each = each.map(|((plane, found), prediction)| {
        PlaneData::new(plane, found, prediction, slices <= MOST_SLICES)
    });
    let file = format!("{}.json", summary.scene);
    let method = match summary.method {
        Method::Difference | Method::Given => None,
        Method::Photons => Some(""),
        Method::Backward | Method::Even => Some(" --method backward"),
    };
    // Rays that were given cannot be traced again.
    let repeat = method.map_or(String::new(), |method| {
        format!(
            "\nto repeat: save the scene below as {file}, and run etendue run {} --photons {} --seed {}{method}",
            shell_word(&file),
            summary.photons,
            summary.seed,
        )
    });
    let provenance = format!(
        "etendue {}, {} {} in {} batches, seed {}, α = {}\nscene hash {}{repeat}",
        summary.version,
        grouped(summary.photons),
        summary.method.words(),
        summary.batches,
        summary.seed,
        summary.alpha,
        summary.scene_hash,
    );
    let run = RunData {
        scene: &summary.scene,
        verdict: summary.verdict,
        words: verdict_text(summary),
        provenance,
        scene_file: &summary.scene_file,
        explorer,
        path,
        planes: each.collect(),
        tables: [table::planes(summary), table::parameters(summary)],
    };
    serde_json::to_string(&run).unwrap_or_default()
}

impl<'a> PlaneData<'a> {
    fn new(
        plane: &VirtualPlane,
        found: &'a PlaneComparison,
        prediction: &Prediction,
        with_slices: bool,
    ) -> Self {
        let field = &found.projection.mean;
        let [x, u] = light_field_axes(plane, &field.grid);
        let [rho, nu] = spectrum_axes(plane);
        let grid = &found.measured.grid;
        let half =
            |values: &Array2<f64>| values.view().split_at(Along(0), grid.rho.half).1.to_owned();
        let predicted_field = &prediction.projection.values;
        let field_z = z(
            &field.values,
            predicted_field,
            &found.projection.standard_error,
        );
        let radial = [
            &found.radial.power,
            &found.predicted_radial,
            &radial_z(found),
        ]
        .map(half);
        Self {
            report: &found.report,
            words: verdict_line(found).replace('*', "").replace("^{2}", "²"),
            on_chain: on_chain(&found.report),
            axes: PageAxes {
                x: Labelled::new(&x, field.grid.bins),
                u: Labelled::new(&u, field.grid.bins),
                rho: Labelled::new(&rho, grid.rho.count()),
                nu: Labelled::new(&nu, grid.nu.count()),
            },
            azimuths: (0..grid.azimuths).map(|k| grid.azimuth(k)).collect(),
            field: Grids::new(field.values.view(), predicted_field.view(), field_z.view()),
            field_unit: light_field_quantity()
                .unit
                .replace("^{−2}", "⁻²")
                .replace("^{−1}", "⁻¹"),
            radial: Grids::new(radial[0].view(), radial[1].view(), radial[2].view()),
            slices: with_slices.then(|| slices(found)),
        }
    }
}

/// The pictures |S|², |F|² and |S − F|/σ at each azimuth.
fn slices(found: &PlaneComparison) -> Vec<Grids> {
    let measured = found.measured.half.outer_iter();
    let predicted = found.predicted.half.outer_iter();
    let both = measured.zip(predicted).zip(found.sigma.outer_iter());
    both.map(|((measured, predicted), sigma)| {
        let z = Zip::from(&measured)
            .and(&predicted)
            .and(&sigma)
            .map_collect(|m, p, sigma| {
                if *sigma > 0.0 {
                    (m - p).norm_sqr().sqrt() / sigma
                } else {
                    f64::NAN
                }
            });
        let power = |slice: &ArrayView2<'_, etendue_field::Complex>| slice.map(|s| s.norm_sqr());
        let (measured, predicted) = (power(&measured), power(&predicted));
        Grids::new(measured.view(), predicted.view(), z.view())
    })
    .collect()
}
