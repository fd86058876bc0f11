//! The result of a probe, in words and in JSON.

use super::found::{Found, SecondEstimate};
use super::picture::PictureBandwidth;
use super::scene::ProbeRequest;
use etendue_compare::{Verdict, lobe_cutoff};
use etendue_field::{FrequencyAxis, Lobe, VirtualPlane, percent, uncertain};
use etendue_paths::{Probe, Reflects, Stop};
use etendue_report::table::aligned;
use etendue_spectrum::Uncertain;
use etendue_spectrum::bandwidth::Widest;
use etendue_spectrum::field::MatrixEstimate;
use etendue_store::ArgumentStyle;
use etendue_studies::variance::CONSTANT;
use etendue_studies::variance::table::text;
use etendue_theory::shading::Criterion;
use etendue_world::World;
use serde_json::{Value, json as tree_of};

/// If noise is more than this share of a spectrum, the noise is underestimated.
const NOISY: f64 = 0.3;

/// The angle of the central ray to the normal of a surface, radians.
fn angle(stop: &Stop) -> f64 {
    libm::acos(stop.cosine().clamp(-1.0, 1.0))
}

/// The paper's criterion for light that leaves a surface (Durand et al. 2005, Eq. 20,
/// corrected), in cycles per radian at the camera. Returns `None` if the surface has no lobe.
pub(super) fn criterion(stop: &Stop) -> Option<f64> {
    let Reflects::Lobe(lobe) = stop.reflects else {
        return None;
    };
    let angle = angle(stop);
    let of = Criterion {
        curvature: stop.curvature[0],
        incidence: angle,
        outgoing: angle,
        distance: stop.distance,
        blocker_distance: None,
        lobe_cutoff: lobe_cutoff(lobe)?,
        environment_cutoff: f64::INFINITY,
    };
    Some(of.environment())
}

pub(super) fn of_stop(world: &World, stop: &Stop) -> Value {
    tree_of!({
        "shape": world.shapes[stop.shape].name,
        "position": stop.position.to_array(),
        "normal": stop.normal.to_array(),
        "distance": stop.distance,
        "angle": angle(stop),
        "curvature": stop.curvature,
        "reflects": word(stop.reflects),
        "criterion": criterion(stop),
    })
}

pub(super) fn of_plane(request: &ProbeRequest, found: &Found, plane: &VirtualPlane) -> Value {
    let number = |of: &Option<Widest<Uncertain>>| of.map(|of| [of.value.value, of.value.error]);
    let azimuth = |of: &Option<Widest<Uncertain>>| of.map(|of| of.azimuth);
    let axis = |axis: &FrequencyAxis| tree_of!({ "max": axis.max(), "spacing": axis.spacing });
    let grid = &plane.grid;
    let mut tree = tree_of!({
        "report": found.comparison.report,
        "window": plane.window,
        "frequencies": { "azimuths": grid.azimuths, "rho": axis(&grid.rho), "nu": axis(&grid.nu) },
        "verdict": found.comparison.report.verdict,
        "judge": found.judge.word(),
        "rays": found.counts[0],
        "judge_rays": found.counts[1],
        "photons_miss": found.misses,
        "variation_95": { "nu": number(&found.nu), "rho": number(&found.rho) },
        "variation_95_azimuth": { "nu": azimuth(&found.nu), "rho": azimuth(&found.rho) },
    });
    if let Some(covariance) = &found.covariance {
        tree["spectral_covariance"] = covariance.tree();
    }
    if let (Some(options), Some(variance)) = (&request.variance, &found.variance) {
        tree["variance"] = variance.tree(options);
    }
    tree
}

fn word(reflects: Reflects) -> String {
    match reflects {
        Reflects::Nothing => "nothing: it is black from this side".to_owned(),
        Reflects::Diffuse | Reflects::Lobe(Lobe::Lambertian) => "diffuse".to_owned(),
        Reflects::Mirror => "mirror or smooth interface".to_owned(),
        Reflects::Lobe(mut lobe) => match (lobe.name(), lobe.number_mut()) {
            (name, Some((of, value))) => format!("{name}, {of} {value}"),
            (name, None) => name.to_owned(),
        },
    }
}

/// Lines on the surfaces, the planes, and the sampling density that the picture needs.
pub(super) fn lines(
    request: &ProbeRequest,
    world: &World,
    (probe, picture): (&Probe<'_>, &PictureBandwidth),
    found: &[&Found],
) -> Vec<String> {
    let arguments = request.source.arguments;
    let mut lines = surfaces(world, probe);
    lines.push(String::new());
    lines.extend(planes(found));
    lines.push(String::new());
    let open = found
        .iter()
        .filter(|found| found.comparison.report.verdict != Verdict::Pass);
    lines.extend(open.filter_map(|found| {
        let report = &found.comparison.report;
        // The comparison states only that there are too few photons, but there may also be too few
        // rays.
        let why = report.undecided.as_ref()?.split("; needs").next()?;
        let more = if found.needed.iter().all(|n| n.is_finite()) {
            let [rays, photons] = [("rays", found.needed[0]), ("photons", found.needed[1])]
                .map(|(name, n)| arguments.with(name, power_of_two(n, arguments)));
            // The noise is underestimated if it is a large part of the spectrum.
            let about = if report.noise_limit > Some(NOISY) {
                "at least"
            } else {
                "about"
            };
            format!("needs {about} {rays} and {photons}")
        } else {
            let [rays, photons] = ["rays", "photons"].map(|name| arguments.name(name));
            format!("more {rays} or {photons} may decide it")
        };
        Some(format!("{}: {why}; {more}", report.name))
    }));
    if probe.stops.len() < usize::from(request.surfaces) {
        let count = probe.stops.len();
        lines.push(format!("The ray leaves the scene after surface {count}."));
    }
    lines.extend(bandwidths(picture, arguments));
    lines.extend(covariances(found));
    if let Some(options) = &request.variance {
        for found in found {
            lines.push(String::new());
            lines.push(match &found.variance {
                Some(variance) => text(variance, options),
                None => format!(
                    "{}: {}",
                    found.comparison.report.name,
                    if found.is_dark() {
                        "dark, so its mean has no error"
                    } else {
                        CONSTANT
                    }
                ),
            });
        }
    }
    lines
}

/// The next power of two, as an argument is written.
fn power_of_two(count: f64, arguments: ArgumentStyle) -> String {
    let exponent = libm::log2(count).ceil().min(63.0);
    match arguments {
        ArgumentStyle::Command => format!("2^{exponent}"),
        ArgumentStyle::Python => format!("2**{exponent}"),
    }
}

/// A table with a header.
fn table(head: [&str; 6], rows: impl Iterator<Item = [String; 6]>) -> Vec<String> {
    let head = head.map(str::to_owned);
    aligned(std::iter::once(head).chain(rows).map(Vec::from).collect())
}

fn surfaces(world: &World, probe: &Probe<'_>) -> Vec<String> {
    let head = [
        "surface",
        "shape",
        "reflects",
        "distance",
        "angle [°]",
        "curvatures [1/m]",
    ];
    let rows = probe.stops.iter().enumerate().map(|(i, stop)| {
        let [along, across] = stop.curvature;
        [
            (i + 1).to_string(),
            match world.shapes[stop.shape].name.as_str() {
                "" => format!("number {}", stop.shape + 1),
                name => name.to_owned(),
            },
            word(stop.reflects),
            format!("{:.4}", stop.distance),
            format!("{:.2}", angle(stop).to_degrees()),
            format!("{along:.4}, {across:.4}"),
        ]
    });
    table(head, rows)
}

fn planes(found: &[&Found]) -> Vec<String> {
    let head = [
        "plane",
        "noise alone",
        "p",
        "bandwidth ν [cycles/slope]",
        "bandwidth ρ [cycles/m]",
        "verdict",
    ];
    let shown = |of: &Option<Widest<Uncertain>>| {
        of.map_or("–".to_owned(), |Widest { azimuth, value }| {
            let value = uncertain(value.value, value.error);
            format!("{value} at {:.0}°", azimuth.to_degrees())
        })
    };
    let rows = found.iter().map(|found| {
        let report = &found.comparison.report;
        let share = |x: Option<f64>| x.map_or("–".to_owned(), |x| percent(x, 3));
        [
            report.name.clone(),
            share(report.noise_limit),
            report.p_value.map_or("–".to_owned(), |p| format!("{p:.5}")),
            shown(&found.nu),
            shown(&found.rho),
            match (found.judge, found.misses) {
                (SecondEstimate::Photons, Some(what)) => {
                    format!("undecided: photons do not find light from {what}")
                }
                _ if found.is_dark() => "dark".to_owned(),
                (SecondEstimate::Photons, None) => format!("{:?}", report.verdict).to_lowercase(),
                (SecondEstimate::BsdfRays, _) => {
                    format!("{:?}, by BSDF rays", report.verdict).to_lowercase()
                }
            },
        ]
    });
    table(head, rows)
}

/// Lines on the bandwidths of the picture, and on the distances between shading samples
/// that these bandwidths require.
fn bandwidths(picture: &PictureBandwidth, arguments: ArgumentStyle) -> Vec<String> {
    let line = |what: &str, cycles: String, bandwidth: f64| {
        let samples = picture.spacing(bandwidth);
        format!("  {what:36}{cycles:>16} cycles/slope   {samples}")
    };
    let number = |cycles: f64| format!("{cycles:.3}");
    let measured = |of: Uncertain| uncertain(of.value, of.error);
    let (own, limit) = (picture.of_window(), picture.limit());
    let mut lines = vec![
        "bandwidth of the picture minus its mean, from backward rays alone".to_owned(),
        format!("  in a window {} pixels wide", picture.pixels),
    ];
    let mut advice = None;
    if let Some(Widest { azimuth, value }) = picture.widest() {
        let degrees = azimuth.to_degrees();
        lines.push(line(
            &format!("largest, at {degrees:.1}°"),
            measured(value),
            value.value,
        ));
        let across = picture.across();
        lines.push(match across {
            Some(value) => line("across this direction", measured(value), value.value),
            None => line("across this direction, below", number(limit), limit),
        });
        if let Some(value) = picture.unblurred() {
            let what = "largest without the window's blur";
            lines.push(line(what, number(value), value));
        }
        advice = Some(format!(
            "advice: place shading samples {} at {degrees:.0}°, and {} across this direction",
            picture.spacing(value.value),
            picture.spacing(across.map_or(limit, |across| across.value)),
        ));
    } else if picture.missed.is_some() {
        lines.push(line("above", number(picture.highest), picture.highest));
    } else if picture.variation.is_some() {
        lines.push(line("below", number(limit), limit));
    }
    lines.push(line("of the window alone", number(own), own));
    lines.push(match criterion(&picture.surface) {
        Some(cycles) => {
            let what = "Eq. 20, for light of all frequencies";
            line(what, number(cycles), cycles)
        }
        None => "  Eq. 20 describes lobes: it does not apply to this surface".to_owned(),
    });
    lines.push(advice.unwrap_or_else(|| unresolved(picture, arguments)));
    lines
}

/// What is known of a picture whose bandwidth is not measured.
fn unresolved(picture: &PictureBandwidth, arguments: ArgumentStyle) -> String {
    let [window, rays] = ["window", "rays"].map(|name| arguments.name(name));
    if let Some(share) = picture.missed {
        let why = format!(
            "{} of the variation is above the highest frequency of this window",
            percent(share, 2)
        );
        if picture.samples(picture.highest) >= 1.0 {
            format!("advice: place at least one shading sample in each pixel, because {why}")
        } else {
            format!("{why}; a narrower window ({window}) shows the bandwidth of the picture")
        }
    } else if picture.variation.is_some() {
        format!(
            "the picture is smooth in this window; a wider window ({window}) shows the bandwidth of the picture"
        )
    } else if picture.varies {
        format!("the picture varies, but noise hides its bandwidth: more {rays} would show it")
    } else {
        let share = picture.noise_share().filter(|share| *share < 1.0);
        let share = share.map_or("all".to_owned(), |share| percent(share, 2));
        format!(
            "no variation is above the noise, which has {share} of the power: the picture is even, or more {rays} are needed"
        )
    }
}

/// A row for each plane with the entries of the covariance along x, where x lies in the
/// plane of incidence. The camera has a second row with the propagated covariance.
fn covariances(found: &[&Found]) -> Vec<String> {
    let head = ["covariance", "ρx ρx", "ρx νu", "νu νu"].map(str::to_owned);
    let row = |name: String, of: &MatrixEstimate| {
        let entry = |i: usize, j: usize| uncertain(of.value[i][j], of.error[i][j]);
        vec![name, entry(0, 0), entry(0, 2), entry(2, 2)]
    };
    let mut rows = Vec::new();
    for found in found {
        let Some(covariance) = &found.covariance else {
            continue;
        };
        let name = &found.comparison.report.name;
        rows.extend(covariance.measured.as_ref().map(|of| row(name.clone(), of)));
        let traced = covariance.propagated.as_ref();
        rows.extend(traced.map(|of| row(format!("{name}, propagated from leaving_1"), of)));
    }
    if rows.is_empty() {
        return Vec::new();
    }
    let table = aligned(std::iter::once(head.to_vec()).chain(rows).collect());
    std::iter::once(String::new()).chain(table).collect()
}
