//! Maps how fast light changes with angle at the camera, over a picture: measured, and by the
//! criterion of Durand et al. 2005.

use super::scene::{BATCHES, ProbeRequest, ProbedScene};
use super::words::{ON_GRID, criterion};
use etendue_figures::{Axis, AxisQuantity, Comparison, Scale, comparison};
use etendue_paths::{BackwardProbe, Budget, Probe};
use etendue_pipeline::{Reporter, Work};
use etendue_report::pictures;
use etendue_spectrum::bandwidth::bandwidth_nu;
use etendue_spectrum::{CrossPower, estimate, measure};
use etendue_store::Failure;
use etendue_store::Results;
use etendue_store::exr::{Part, exr};
use etendue_store::npz::Npz;
use etendue_store::sealed::json;
use ndarray::{Array2, Axis as ArrayAxis};
use rayon::prelude::*;
use serde_json::json as tree_of;
use std::path::PathBuf;

const FILES: [&str; 5] = ["map.exr", "map.npz", "map.png", "map.svg", "map.csv"];
/// A bandwidth of a spectrum with more noise than this share is not shown.
const MAX_NOISE: f64 = 0.6;

/// A bandwidth with a larger relative standard error is not shown, because with few rays its
/// jackknife is unreliable.
const MAX_ERROR: f64 = 0.2;

/// The results for a pixel; NaN where there is no light, or too much noise.
#[derive(Clone, Copy, Debug)]
struct MapPoint {
    /// The frequency below which 95 % of the power in the window lies, in the azimuth where it is largest, cycles per slope, with its standard error.
    measured: f64,
    error: f64,
    /// The bandwidth by Eq. 20, corrected.
    criterion: f64,
    /// The bandwidth of the window alone, a lower bound of the measured one.
    window: f64,
    /// The number of shading samples along a direction.
    samples: f64,
}

impl MapPoint {
    const UNKNOWN: Self = Self {
        measured: f64::NAN,
        error: f64::NAN,
        criterion: f64::NAN,
        window: f64::NAN,
        samples: f64::NAN,
    };
}

/// A quantity of each pixel.
type MapLayer = fn(&MapPoint) -> f64;

/// The result of a map of bandwidths.
#[derive(Debug)]
pub struct BandwidthMap {
    /// The results folder.
    pub folder: PathBuf,
    /// A comparison of measured and predicted bandwidths, in words.
    pub words: String,
}

/// Bandwidths at the camera for `w` × `h` pixels, evenly spaced over the picture.
pub fn map_bandwidths(
    request: &ProbeRequest,
    [w, h]: [usize; 2],
    reporter: &dyn Reporter,
) -> Result<BandwidthMap, Failure> {
    let case = &ProbedScene::read(request)?;
    let name = format!("{}-map", case.name());
    let (results, folder) = case.claim(name, FILES.map(str::to_owned).to_vec())?;
    let bar = reporter.begin(Work::Steps {
        verb: "probing",
        total: w * h,
        things: "pixels",
    });
    let points = (0..w * h).into_par_iter().map(|i| {
        let point = point(case, [i % w, i / w], [w, h]);
        bar.advance(1);
        point
    });
    let points: Vec<MapPoint> = points.collect::<Result<_, Failure>>()?;
    drop(bar);
    let map = Array2::from_shape_vec((h, w), points).map_err(Failure::cannot_run)?;
    write(case, results, &map, reporter)?;
    let words = words(&map);
    Ok(BandwidthMap { folder, words })
}

/// The bandwidths behind one pixel of the lattice.
fn point(case: &ProbedScene<'_>, at: [usize; 2], lattice: [usize; 2]) -> Result<MapPoint, Failure> {
    let pixel = [0, 1].map(|i| (2 * at[i] + 1) * case.camera.size[i] / (2 * lattice[i]));
    let question = case.question(pixel, 4);
    let Some(mut probe) = Probe::new(&case.paths, &case.camera, &question) else {
        return Ok(MapPoint::UNKNOWN);
    };
    probe.planes.truncate(1);
    let number = (at[1] * lattice[0] + at[0]) as u64;
    let budget = Budget {
        each: case.request.rays.div_ceil(u64::from(BATCHES)),
        seed: case.request.seed.wrapping_add(number << 32),
    };
    let rays = BackwardProbe::new(&probe, budget);
    let found = measure(&rays, &probe.planes, 0..BATCHES, &|_| {});
    let power = CrossPower::new(&found, 0).map_err(Failure::cannot_run)?;
    let nu = power.bandwidth(bandwidth_nu).map(|widest| widest.value);
    let noise = estimate::noise(&found, 0).map_err(Failure::cannot_run)?;
    let is_clear = noise.is_some_and(|noise| noise <= MAX_NOISE);
    let nu = nu.filter(|nu| is_clear && nu.error <= MAX_ERROR * nu.value);
    Ok(MapPoint {
        measured: nu.map_or(f64::NAN, |nu| nu.value),
        error: nu.map_or(f64::NAN, |nu| nu.error),
        criterion: criterion(&probe.stops[0]).unwrap_or(f64::NAN),
        window: ON_GRID / probe.planes[0].window.u.half_width(),
        samples: nu.map_or(f64::NAN, |nu| 2.0 * nu.value * probe.pixel_slope),
    })
}

fn write(
    case: &ProbedScene<'_>,
    mut results: Results,
    map: &Array2<MapPoint>,
    reporter: &dyn Reporter,
) -> Result<(), Failure> {
    let (h, w) = map.dim();
    let layers: [(&'static str, MapLayer); 5] = [
        ("measured", |point| point.measured),
        ("error", |point| point.error),
        ("criterion", |point| point.criterion),
        ("window", |point| point.window),
        ("samples", |point| point.samples),
    ];
    let mut made_from = case.made_from();
    made_from["map"] = tree_of!([w, h]);
    made_from["rays"] = tree_of!(case.request.rays);
    let mut npz = Npz::new();
    let mut parts = Vec::new();
    for (name, of) in layers {
        npz = npz.add(name, &map.map(of))?;
        #[expect(clippy::cast_possible_truncation, reason = "EXR viewers want 32 bits")]
        let samples = map.iter().map(|point| of(point) as f32).collect();
        parts.push(Part { name, samples });
    }
    results.write(FILES[0], &exr([w, h], parts, &made_from)?)?;
    results.write(FILES[1], &npz.bytes()?)?;
    pictures::write(&mut results, "map", &drawn(case, map)?)?;
    let finished = results.finish(|files| {
        made_from["files"] = tree_of!(files);
        json(&made_from)
    })?;
    if let Some(message) = finished.replaced_message() {
        reporter.note(&message);
    }
    Ok(())
}

fn drawn(
    case: &ProbedScene<'_>,
    map: &Array2<MapPoint>,
) -> Result<etendue_figures::Figure, Failure> {
    // In pictures y points upwards.
    let of = |value: MapLayer| {
        let mut rows = map.map(value);
        rows.invert_axis(ArrayAxis(0));
        rows.reversed_axes()
    };
    let [w, h] = case.camera.size.map(|n| n as f64);
    let name = case.name();
    comparison(&Comparison {
        title: &format!("{name}: bandwidth at the camera"),
        note: &format!(
            "95 % of the power in windows {} pixels wide; criterion: Eq. 20, corrected, for light of all frequencies, or the bandwidth of the window alone where that is larger",
            case.request.window
        ),
        x: Axis::edges("column", "pixels", [0.0, w]),
        y: Axis::edges("row", "pixels", [0.0, h]).reversed(),
        // On a linear scale a few pixels at the edges of curved objects would take the whole range.
        quantity: AxisQuantity::new("log_{10} *B*", "cycles/slope"),
        scale: Scale::Linear,
        sides: ["measured", "criterion"],
        measured: of(|point| libm::log10(point.measured)).view(),
        predicted: of(|point| libm::log10(expected(point))).view(),
        z: of(|point| (point.measured - expected(point)) / point.error).view(),
        finer: None,
    })
    .map_err(Failure::cannot_run)
}

/// The expected measurement: the bandwidth of the criterion, or of the window where that is larger.
fn expected(point: &MapPoint) -> f64 {
    // NaN is kept.
    if point.criterion < point.window {
        point.window
    } else {
        point.criterion
    }
}

/// A comparison of measured and predicted bandwidths.
fn words(map: &Array2<MapPoint>) -> String {
    let seen = map
        .iter()
        .filter(|point| point.measured.is_finite())
        .count();
    let is_told = |point: &&MapPoint| expected(point).max(point.measured) > 1.15 * point.window;
    let told = map.iter().filter(is_told);
    let ratio = |point: &MapPoint| point.measured / expected(point);
    let mut ratios: Vec<f64> = told.map(ratio).filter(|x| x.is_finite()).collect();
    ratios.sort_unstable_by(f64::total_cmp);
    let all = ratios.len();
    let mut lines = vec![format!(
        "{seen} of {} bandwidths were measured, the others are dark or too noisy; {all} are at surfaces with a lobe and above the bandwidth of the window alone",
        map.len()
    )];
    if all > 0 {
        let at = |tenths: usize| ratios[(all - 1) * tenths / 10];
        let above = ratios.iter().filter(|ratio| **ratio > 1.1).count();
        lines.push(format!(
            "measured bandwidth over criterion: median {:.3}, first and last decile {:.3} and {:.3}; more than 1.1 at {:.1} % of these pixels",
            at(5),
            at(1),
            at(9),
            100.0 * above as f64 / all as f64
        ));
    }
    lines.join("\n")
}
