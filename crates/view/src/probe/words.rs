//! The result of a probe, in words and in JSON.

use super::found::{Found, verdict};
use super::scene::ProbeRequest;
use etendue_compare::{Verdict, lobe_cutoff};
use etendue_field::{Lobe, percent, uncertain};
use etendue_paths::{Probe, Reflects, Stop};
use etendue_pipeline::table::aligned;
use etendue_spectrum::Uncertain;
use etendue_spectrum::bandwidth::Widest;
use etendue_spectrum::field::MatrixEstimate;
use etendue_store::ArgumentStyle;
use etendue_theory::shading::Criterion;
use etendue_world::World;
use serde_json::{Value, json as tree_of};

/// The angle of the central ray to the normal of a surface, radians.
fn angle(stop: &Stop) -> f64 {
    libm::acos(stop.cosine().clamp(-1.0, 1.0))
}

/// The paper's criterion for light that leaves a surface, in cycles per radian at the camera
/// (Durand et al. 2005, Eq. 20, corrected); `None` where the surface has no lobe.
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

pub(super) fn of_plane(found: &Found) -> Value {
    let number = |of: &Option<Widest<Uncertain>>| of.map(|of| [of.value.value, of.value.error]);
    let azimuth = |of: &Option<Widest<Uncertain>>| of.map(|of| of.azimuth);
    let mut tree = tree_of!({
        "report": found.comparison.report,
        "verdict": verdict(found),
        "photons_miss": found.misses,
        "bandwidth_95": { "nu": number(&found.nu), "rho": number(&found.rho) },
        "bandwidth_95_azimuth": { "nu": azimuth(&found.nu), "rho": azimuth(&found.rho) },
    });
    if let Some(covariance) = &found.covariance {
        tree["spectral_covariance"] = covariance.tree();
    }
    tree
}

fn word(reflects: Reflects) -> String {
    match reflects {
        Reflects::Nothing => "nothing: it is black from this side".to_owned(),
        Reflects::Diffuse => "diffuse".to_owned(),
        Reflects::Mirror => "mirror or smooth interface".to_owned(),
        Reflects::Lobe(lobe) => match lobe {
            Lobe::Lambertian => "diffuse".to_owned(),
            Lobe::Phong { exponent } => format!("Phong, exponent {exponent}"),
            Lobe::Beckmann { roughness } => format!("Beckmann, roughness {roughness}"),
            Lobe::Ggx { roughness } => format!("GGX, roughness {roughness}"),
        },
    }
}

/// The surfaces, the planes, and the sampling density that the picture needs.
pub(super) fn lines(
    request: &ProbeRequest,
    world: &World,
    probe: &Probe<'_>,
    found: &[&Found],
) -> Vec<String> {
    let arguments = request.source.arguments;
    let mut lines = surfaces(world, probe);
    lines.push(String::new());
    lines.extend(planes(found));
    lines.push(String::new());
    let open = found.iter().filter(|found| verdict(found) != Verdict::Pass);
    lines.extend(open.filter_map(|found| {
        let report = &found.comparison.report;
        // The comparison counts rays as photons, and both may be too few.
        let why = report.undecided.as_ref()?.split("; needs").next()?;
        let [rays, photons] = ["rays", "photons"].map(|name| arguments.name(name));
        let times = report.photons_needed.map(|n| n / request.rays as f64);
        let more = match times {
            Some(times) => format!(
                "about {} times as many {rays} and {photons} are needed",
                times.ceil()
            ),
            None => format!("more {rays} or {photons} may decide it"),
        };
        Some(format!("{}: {why}; {more}", report.name))
    }));
    if probe.stops.len() < usize::from(request.surfaces) {
        let count = probe.stops.len();
        lines.push(format!("The ray leaves the scene after surface {count}."));
    }
    if let Some(nu) = found.first().and_then(|camera| camera.nu) {
        lines.extend(bandwidths(probe, nu.value, arguments));
    }
    lines.extend(covariances(found));
    lines
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
        "95 % below ν [cycles/slope]",
        "95 % below ρ [cycles/m]",
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
            match found.misses {
                Some(what) => format!("undecided: photons do not find light from {what}"),
                None if found.is_dark() => "dark".to_owned(),
                None => format!("{:?}", report.verdict).to_lowercase(),
            },
        ]
    });
    table(head, rows)
}

/// The bandwidth of a Hann window of half-width 1 along its axes.
const OF_WINDOW: f64 = 0.557_22;

/// The bandwidth measured for a Hann window of half-width 1 alone, on the grid of a probe: cells
/// are as wide as half of the spectrum's main lobe, and along the diagonal the product of two
/// windows has a larger bandwidth than along the axes.
pub(super) const ON_GRID: f64 = 0.681_53;

/// Bandwidths at the camera, and the shading samples that they require.
fn bandwidths(probe: &Probe<'_>, measured: Uncertain, arguments: ArgumentStyle) -> Vec<String> {
    let samples = |cycles: f64| 2.0 * cycles * probe.pixel_slope;
    let line = |what: &str, cycles: f64| {
        let samples = samples(cycles);
        format!(
            "  {what:38}{cycles:10.3} cycles/slope  {samples:8.4} shading samples per pixel along a direction"
        )
    };
    let half_width = probe.planes[0].window.u.half_width();
    // Noise and the light's own shape change it by several per cent.
    let is_own = measured.value < 1.15 * ON_GRID / half_width;
    let mut lines = vec!["bandwidth at the camera".to_owned()];
    lines.push(line("measured, 95 % of the power", measured.value));
    lines.push(line("of the window alone", OF_WINDOW / half_width));
    lines.push(match criterion(&probe.stops[0]) {
        Some(cycles) => line("by Eq. 20, light of all frequencies", cycles),
        None => "  Eq. 20 describes lobes: it does not apply to this surface".to_owned(),
    });
    if is_own {
        lines.push(format!(
            "  The measured bandwidth is that of the window: a wider window ({}) shows the bandwidth of the light.",
            arguments.name("window")
        ));
    }
    lines
}

/// The entries along x, which lies in the plane of incidence, at each plane, and at the camera as propagated.
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
        rows.extend(traced.map(|of| row(format!("{name}, traced from leaving_1"), of)));
    }
    if rows.is_empty() {
        return Vec::new();
    }
    let table = aligned(std::iter::once(head.to_vec()).chain(rows).collect());
    std::iter::once(String::new()).chain(table).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::scene::FREQUENCIES;
    use etendue_field::{FrequencyAxis, Profile, SliceGrid};
    use etendue_spectrum::bandwidth::{BANDWIDTH_FRACTION, bandwidth, bandwidth_nu, widest};
    use ndarray::{Array1, Array3};

    /// ∫ W(t) cos(2π f t) dt over a Hann window of half-width 1, by the midpoint rule.
    fn transformed(frequency: f64) -> f64 {
        const POINTS: u32 = 1000;
        let window = Profile::Hann(1.0);
        let at = |i: u32| {
            let t = (f64::from(i) + 0.5) / f64::from(POINTS);
            window.value(t) * libm::cos(std::f64::consts::TAU * frequency * t)
        };
        2.0 * (0..POINTS).map(at).sum::<f64>() / f64::from(POINTS)
    }

    #[test]
    fn a_window_alone_has_the_bandwidths_that_are_printed() {
        let fine = FrequencyAxis {
            half: 2000,
            spacing: 0.0025,
        };
        let power: Array1<f64> = fine
            .values()
            .into_iter()
            .map(|f| transformed(f).powi(2))
            .collect();
        let found = bandwidth(power.view(), &fine, BANDWIDTH_FRACTION).unwrap_or_default();
        assert!((found - OF_WINDOW).abs() < 1e-4, "{found}"); // the tail beyond 5, and the curvature within a cell
        let axis = |half| FrequencyAxis { half, spacing: 0.5 };
        let grid = SliceGrid {
            azimuths: 4,
            rho: axis(0),
            nu: axis(FREQUENCIES),
        };
        let even = Array3::from_shape_fn(grid.half_shape(), |(k, _, j)| {
            let [_, _, u, v] = grid.frequency(k, 0.0, grid.nu.value(j));
            (transformed(u) * transformed(v)).powi(2)
        });
        let found = widest(even.view(), &grid, bandwidth_nu).map_or(0.0, |widest| widest.value);
        assert!((found - ON_GRID).abs() < 1e-4, "{found}"); // rounding of the constant, and the midpoint rule
    }
}
