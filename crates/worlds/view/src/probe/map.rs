//! Makes maps of a picture that show how fast the light at the camera changes with angle. The
//! change is measured, and computed by the criterion of Durand et al. 2005.

use super::picture::PictureBandwidth;
use super::scene::{ProbeRequest, ProbedScene};
use super::words::criterion;
use crate::layers::write_exr;
use crate::world_source::finish;
use etendue_figures::{Axis, AxisQuantity, Comparison, Scale, comparison};
use etendue_pipeline::{Reporter, Work};
use etendue_report::pictures::PictureFiles;
use etendue_store::{ArgumentStyle, Failure, Results};
use ndarray::{Array2, Axis as ArrayAxis};
use rayon::prelude::*;
use serde_json::json as tree_of;
use std::path::PathBuf;

const FILES: [&str; 5] = ["map.exr", "map.npz", "map.png", "map.svg", "map.csv"];

/// What is known about the bandwidth of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PixelOutcome {
    Measured,
    /// The pixel sees no light.
    Dark,
    /// Noise hides the bandwidth.
    Noisy,
    /// The bandwidth is below the limit of the window.
    Smooth,
    /// The picture varies above the highest frequency.
    Fine,
}

impl PixelOutcome {
    fn of(picture: &PictureBandwidth) -> Self {
        if picture.missed.is_some() {
            Self::Fine
        } else if picture.widest().is_some() {
            Self::Measured
        } else if picture.variation.is_some() {
            Self::Smooth
        } else if picture.noise_share().is_none() {
            Self::Dark
        } else {
            Self::Noisy
        }
    }
}

/// The results for a pixel. A number is NaN if there is no light or too much noise.
#[derive(Clone, Copy, Debug)]
struct MapPoint {
    outcome: PixelOutcome,
    /// The bandwidth, in cycles per slope, of the picture minus its mean. It is taken along the
    /// direction in which it is largest; `error` is its standard error.
    measured: f64,
    error: f64,
    /// The direction of the largest bandwidth, radians from the right, counter-clockwise.
    azimuth: f64,
    /// The bandwidth perpendicular to the direction of the largest bandwidth.
    across: f64,
    /// The bandwidth by Eq. 20, corrected.
    criterion: f64,
    /// The bandwidth of the window alone, which is a lower bound of the measured bandwidth.
    window: f64,
    /// Width of the window, pixels.
    pixels: f64,
    /// The number of shading samples along a direction; at least this number if the picture varies
    /// above the highest frequency.
    samples: f64,
}

impl MapPoint {
    const UNKNOWN: Self = Self {
        outcome: PixelOutcome::Dark,
        measured: f64::NAN,
        error: f64::NAN,
        azimuth: f64::NAN,
        across: f64::NAN,
        criterion: f64::NAN,
        window: f64::NAN,
        pixels: f64::NAN,
        samples: f64::NAN,
    };
}

/// A function that selects one quantity of a pixel.
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
    let words = words(&map, request.source.arguments);
    Ok(BandwidthMap { folder, words })
}

/// The bandwidths behind one pixel of the lattice.
fn point(case: &ProbedScene<'_>, at: [usize; 2], lattice: [usize; 2]) -> Result<MapPoint, Failure> {
    let pixel = [0, 1].map(|i| (2 * at[i] + 1) * case.camera.size[i] / (2 * lattice[i]));
    let number = (at[1] * lattice[0] + at[0]) as u64;
    let seed = case.request.seed.wrapping_add(number << 32);
    let Some(picture) = PictureBandwidth::new(case, pixel, seed, &|_| {})? else {
        return Ok(MapPoint::UNKNOWN);
    };
    let known = |of: Option<f64>| of.unwrap_or(f64::NAN);
    let widest = picture.widest();
    let enough = match picture.missed {
        Some(_) => Some(picture.highest),
        None => widest.map(|it| it.value.value),
    };
    Ok(MapPoint {
        outcome: PixelOutcome::of(&picture),
        measured: known(widest.map(|it| it.value.value)),
        error: known(widest.map(|it| it.value.error)),
        azimuth: known(widest.map(|it| it.azimuth)),
        across: known(picture.across().map(|it| it.value)),
        criterion: known(criterion(&picture.surface)),
        window: picture.of_window(),
        pixels: picture.pixels,
        samples: known(enough.map(|bandwidth| picture.samples(bandwidth))),
    })
}

fn write(
    case: &ProbedScene<'_>,
    mut results: Results,
    map: &Array2<MapPoint>,
    reporter: &dyn Reporter,
) -> Result<(), Failure> {
    let (h, w) = map.dim();
    let layers: [(&'static str, MapLayer); 8] = [
        ("measured", |point| point.measured),
        ("error", |point| point.error),
        ("azimuth", |point| point.azimuth),
        ("across", |point| point.across),
        ("criterion", |point| point.criterion),
        ("window", |point| point.window),
        ("pixels", |point| point.pixels),
        ("samples", |point| point.samples),
    ];
    let mut made_from = case.made_from();
    made_from["map"] = tree_of!([w, h]);
    made_from["rays"] = tree_of!(case.request.rays);
    let layers = layers.map(|(name, of)| (name, map.iter().map(of).collect::<Vec<f64>>()));
    let each = layers.iter().map(|(name, values)| (*name, &values[..]));
    let npz = write_exr(&mut results, FILES[0], [w, h], each, &made_from)?;
    results.write(FILES[1], &npz.bytes()?)?;
    PictureFiles::new("map".to_owned(), drawn(case, map)?)?.write(&mut results)?;
    finish(results, made_from, None, reporter)
}

fn drawn(
    case: &ProbedScene<'_>,
    map: &Array2<MapPoint>,
) -> Result<etendue_figures::Figure, Failure> {
    // In figures the second axis points upwards, so the order of rows is reversed.
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
            "Measured in {}: the bandwidth of the picture minus its mean, along the direction with the largest bandwidth. Grey pixels are dark, noisy or smooth, or vary above the highest frequency. Criterion: the bandwidth by Eq. 20, corrected, for light of all frequencies, or the bandwidth of the window if that is larger",
            match case.request.window {
                Some(pixels) => format!("windows {pixels} pixels wide"),
                None => "the narrowest windows that show the bandwidth".to_owned(),
            }
        ),
        x: Axis::edges("column", "pixels", [0.0, w]),
        y: Axis::edges("row", "pixels", [0.0, h]).reversed(),
        // The scale is logarithmic because a few pixels at the edges of curved objects have much
        // larger values.
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

/// The bandwidth that the measurement should give. It is the larger of two bandwidths: the
/// bandwidth by the criterion, and the bandwidth of the window.
fn expected(point: &MapPoint) -> f64 {
    // This comparison is false for NaN, so NaN is returned.
    if point.criterion < point.window {
        point.window
    } else {
        point.criterion
    }
}

/// A comparison of measured and predicted bandwidths.
fn words(map: &Array2<MapPoint>, arguments: ArgumentStyle) -> String {
    let count = |outcome| map.iter().filter(|point| point.outcome == outcome).count();
    let [seen, dark, noisy, smooth, fine] = [
        PixelOutcome::Measured,
        PixelOutcome::Dark,
        PixelOutcome::Noisy,
        PixelOutcome::Smooth,
        PixelOutcome::Fine,
    ]
    .map(count);
    let ratio = |point: &MapPoint| point.measured / expected(point);
    let mut ratios: Vec<f64> = map.iter().map(ratio).filter(|x| x.is_finite()).collect();
    ratios.sort_unstable_by(f64::total_cmp);
    let all = ratios.len();
    let mut lines = vec![format!(
        "bandwidths were measured at {seen} of {} pixels, of which {all} show surfaces with a lobe. Of the others, {dark} are dark, and {smooth} are smooth: their bandwidth is below the bandwidth of the window",
        map.len()
    )];
    if noisy > 0 {
        let rays = arguments.name("rays");
        lines.push(format!(
            "noise hides the bandwidth of {noisy} pixels: more {rays} would show it"
        ));
    }
    if fine > 0 {
        lines.push(format!(
            "{fine} pixels vary above the highest frequency of the window: `samples` is the least number that they need"
        ));
    }
    if all > 0 {
        let at = |tenths: usize| ratios[(all - 1) * tenths / 10];
        let above = ratios.iter().filter(|ratio| **ratio > 1.1).count();
        lines.push(format!(
            "measured bandwidth divided by criterion: median {:.3}, first and last decile {:.3} and {:.3}; above 1.1 at {:.1} % of these pixels",
            at(5),
            at(1),
            at(9),
            100.0 * above as f64 / all as f64
        ));
    }
    lines.join("\n")
}
