//! The tables of a study of variance, for a terminal.

use super::{
    AxisSetPower, CountReport, PlaneVariance, SamplerReport, VarianceCurve, VarianceOptions,
};
use etendue_field::{brief, fixed, grouped, percent, uncertain};
use etendue_report::table::{aligned, below_header};
use etendue_spectrum::Uncertain;

/// Number of sets of axes in a row.
const SETS_PER_ROW: usize = 3;

/// Means by the spectrum and by single rays that differ by more than this number of standard errors
/// are reported.
const MAX_DIFFERENCE: f64 = 4.0;

/// All tables.
#[must_use]
pub fn text(found: &PlaneVariance, options: &VarianceOptions) -> String {
    let mut lines = head(found, options);
    lines.push(String::new());
    lines.push(format!(
        "power by nonzero axes, as a share of the variance (frequencies up to {}):",
        options.frequencies
    ));
    lines.extend(sets(&found.axis_sets));
    for sampler in &found.samplers {
        lines.push(String::new());
        lines.extend(of_sampler(sampler, found.moments.mean.value));
    }
    lines.join("\n")
}

fn head(found: &PlaneVariance, options: &VarianceOptions) -> Vec<String> {
    let [x, u, y, v] = found.half_widths.map(brief);
    let moments = &found.moments;
    let shown = |number: Uncertain| uncertain(number.value, number.error);
    let mut lines = vec![
        format!(
            "{}: Box windows |x| < {x}, |u| < {u}, |y| < {y}, |v| < {v}; found with {} sets of points",
            found.plane,
            grouped(options.shifts.into())
        ),
        format!(
            "mean: {} by the spectrum, {} by single rays",
            shown(found.mean_by_photons),
            shown(moments.mean)
        ),
        format!(
            "variance over the window: {}, of which {} at frequencies up to {}",
            shown(moments.variance),
            percent(found.inside, 1),
            options.frequencies
        ),
    ];
    if options.light_points {
        let words = "u and v are the point (x, y) on the light from which a ray comes, in metres";
        lines.insert(1, words.to_owned());
    }
    if moments.noise.value > 0.0 {
        let noise = shown(moments.noise);
        lines.push(format!(
            "noise of single radiances (paths that scatter): {noise}"
        ));
    }
    let [photons, rays] = [found.mean_by_photons, moments.mean];
    let error = (photons.error * photons.error + rays.error * rays.error).sqrt();
    if (photons.value - rays.value).abs() > MAX_DIFFERENCE * error {
        lines.push("warning: the means differ by more than their errors".to_owned());
    }
    if !found.has_last_octave {
        lines.push(
            "warning: the highest frequencies have no power above their noise, so the tail counts as for independent points; use more photons, or lower --frequencies"
                .to_owned(),
        );
    }
    lines
}

/// The table of sets of axes.
fn sets(sets: &[AxisSetPower]) -> Vec<String> {
    let cell = |set: &AxisSetPower| {
        let share = [set.share.value, set.share.error].map(|share| 100.0 * share);
        [
            set.axes.concat(),
            format!("{} %", uncertain(share[0], share[1])),
        ]
    };
    let row = |sets: &[AxisSetPower]| {
        let cells = sets.iter().flat_map(cell);
        let missing = (sets.len()..SETS_PER_ROW).flat_map(|_| [String::new(), String::new()]);
        cells.chain(missing).collect()
    };
    aligned(sets.chunks(SETS_PER_ROW).map(row).collect())
}

/// The tables of one sampler.
fn of_sampler(report: &SamplerReport, mean: f64) -> Vec<String> {
    let name = &report.sampler;
    let mut lines = of_curve(name, &report.shifted, mean);
    let worst = report.shifted.counts.iter().filter_map(worst);
    if name.starts_with("sobol") {
        lines.extend(worst);
    }
    if let Some(unshifted) = &report.unshifted {
        lines.extend(of_curve(&format!("{name}, not shifted"), unshifted, mean));
    }
    lines
}

fn of_curve(name: &str, curve: &VarianceCurve, mean: f64) -> Vec<String> {
    if curve.counts.is_empty() {
        return vec![format!(
            "{name}: it has no sets with these numbers of points"
        )];
    }
    let slope = match (curve.predicted_slope, curve.found_slope) {
        (Some(predicted), Some(found)) => format!(
            ": Var is as N to the power {} (predicted), {} (found)",
            fixed(predicted, 2),
            uncertain(found.value, found.error)
        ),
        _ => String::new(),
    };
    let header = [
        "N",
        "error predicted",
        "error found",
        "ratio of Var",
        "gain predicted",
        "found",
        "tail",
    ];
    let rows = curve.counts.iter().map(|count| row(count, mean).to_vec());
    let mut lines = vec![format!("{name}{slope}")];
    lines.extend(aligned(below_header(&header, rows)));
    if curve.counts.iter().any(|count| count.is_undecided) {
        lines.push(
            "undecided: more than 20 % of the prediction is tail, and a fixed set may have peaks there"
                .to_owned(),
        );
    }
    lines
}

/// A row of the table of a sampler. Errors are relative to the mean.
fn row(count: &CountReport, mean: f64) -> [String; 7] {
    let error = |variance: Uncertain| {
        let value = variance.value.max(0.0).sqrt() / mean;
        // The relative error of a root is half that of its square.
        let relative = 0.5 * variance.error / variance.value;
        format!("{} %", uncertain(100.0 * value, 100.0 * value * relative))
    };
    let known = |text: String| {
        if count.is_undecided {
            "undecided".to_owned()
        } else {
            text
        }
    };
    [
        count.count.to_string(),
        known(error(count.predicted)),
        error(count.found),
        known(uncertain(count.ratio.value, count.ratio.error)),
        known(fixed(count.predicted_gain, 3)),
        fixed(count.found_gain, 3),
        percent(count.tail.max(0.0), 0),
    ]
}

/// The frequencies at which a sampler is worse than independent points.
fn worst(count: &CountReport) -> Option<String> {
    let worse = count.worse.as_ref()?;
    let worst = worse.worst.first()?;
    let [x, u, y, v] = worst.frequency;
    Some(format!(
        "N = {}: {} times independent points at ({x}, {u}, {y}, {v}), and above them at {} of the power",
        count.count,
        fixed(worst.ratio, 2),
        percent(worse.share.max(0.0), 1)
    ))
}
