//! Draws predicted and found variances against the number of points, or beside each other if each
//! sampler has only one number of points.

use super::{CountReport, PlaneVariance, SamplerReport, VarianceCurve};
use etendue_field::fixed;
use etendue_figures::{
    AxisQuantity, Chart, Curve, CurveKind, CurvePanel, Curves, Figure, Style, chart, curves,
};
use etendue_report::table::spaced;
use etendue_store::Failure;

/// The files in which the variances of a plane are drawn.
pub const NAMES: [&str; 3] = ["variance.png", "variance.svg", "variance.csv"];

/// Distance between the values of shifted and of other sets in a chart.
const ASIDE: f64 = 0.3;

/// The names and styles of predicted and of found variances of sets of one kind.
struct SetStyle {
    predicted: (CurveKind, &'static str),
    found: (CurveKind, &'static str),
}

/// Sets that are shifted.
const SHIFTED: SetStyle = SetStyle {
    predicted: (CurveKind::Theory, "predicted"),
    found: (CurveKind::Measured, "found"),
};

/// Sets that are not shifted.
const UNSHIFTED: SetStyle = SetStyle {
    predicted: (CurveKind::OtherTheory, "predicted, not shifted"),
    found: (CurveKind::OtherMeasured, "found, not shifted"),
};

/// Draws a panel for each sampler, or one chart of all samplers if each has only one number of
/// points.
pub fn drawn(scene: &str, found: &PlaneVariance) -> Result<Figure, Failure> {
    let samplers = found.samplers.iter();
    let samplers = samplers.filter(|sampler| !sampler.shifted.counts.is_empty());
    let samplers: Vec<&SamplerReport> = samplers.collect();
    let place = format!("{scene}, {}", spaced(&found.plane));
    let style = Style::default();
    let figure = if samplers.iter().all(|s| s.shifted.counts.len() == 1) {
        chart(&gains(&place, found, &samplers), &style)
    } else {
        curves(&variances(&place, found, &samplers), &style)
    };
    figure.map_err(Failure::cannot_run)
}

/// The variances of independent points times N.
fn of_independent(found: &PlaneVariance) -> f64 {
    found.moments.variance.value + found.moments.noise.value
}

/// A panel of variances against N for each sampler.
fn variances(place: &str, found: &PlaneVariance, samplers: &[&SamplerReport]) -> Curves {
    let has_unshifted = samplers.iter().any(|s| s.unshifted.is_some());
    let note = if has_unshifted {
        "points are shifted at random on the torus, or not shifted; titles have both slopes found"
    } else {
        "points are shifted at random on the torus; titles have the slopes predicted and found"
    };
    Curves {
        title: format!("{place}: variance of a mean of *N* radiances"),
        note: note.to_owned(),
        y: AxisQuantity::new("Var", ""),
        panels: samplers
            .iter()
            .map(|sampler| panel(sampler, of_independent(found), has_unshifted))
            .collect(),
    }
}

fn panel(sampler: &SamplerReport, independent: f64, has_unshifted: bool) -> CurvePanel {
    let both = [
        (Some(&sampler.shifted), SHIFTED),
        (sampler.unshifted.as_ref(), UNSHIFTED),
    ];
    let both = both
        .into_iter()
        .filter_map(|(curve, style)| Some((curve?, style)));
    let mut curves = vec![Curve::new(
        CurveKind::Rival,
        "independent points",
        points(&sampler.shifted, |count| {
            [independent / count.count as f64, 0.0]
        }),
    )];
    let mut slopes = Vec::new();
    for (curve, style) in both {
        curves.extend(of_sets(curve, &style));
        if !has_unshifted {
            slopes.extend(curve.predicted_slope);
        }
        slopes.extend(curve.found_slope.map(|slope| slope.value));
    }
    let slopes = slopes.iter().map(|s| fixed(*s, 2).replace('-', "−"));
    let slopes = slopes.collect::<Vec<_>>().join(", ");
    let between = if slopes.is_empty() { "" } else { ": " };
    CurvePanel {
        title: format!("{}{between}{slopes}", sampler.sampler),
        x: AxisQuantity::new("*N*", ""),
        curves,
        is_log: [true, true],
    }
}

/// The values of a curve with their errors, against N.
fn points(curve: &VarianceCurve, value: impl Fn(&CountReport) -> [f64; 2]) -> Vec<[f64; 3]> {
    let counts = curve.counts.iter();
    let point = |count| {
        let [value, error] = value(count);
        [count.count as f64, value, error]
    };
    counts.map(point).collect()
}

/// The predicted and the found variances. Predictions that are undecided are left out.
fn of_sets(curve: &VarianceCurve, style: &SetStyle) -> Vec<Curve> {
    let mut curves = Vec::new();
    let (kind, name) = style.predicted;
    if curve.counts.iter().any(|count| !count.is_undecided) {
        let predicted = points(curve, |count| [count.predicted.value, 0.0]);
        curves.push(Curve::new(kind, name, predicted));
    }
    let (kind, name) = style.found;
    let found = points(curve, |count| [count.found.value, count.found.error]);
    curves.push(Curve::new(kind, name, found));
    curves
}

/// A chart of N Var/σ² of all samplers, each with its only number of points.
fn gains(place: &str, found: &PlaneVariance, samplers: &[&SamplerReport]) -> Chart {
    let variance = found.moments.variance.value;
    let independent = of_independent(found) / variance;
    let has_unshifted = samplers.iter().any(|s| s.unshifted.is_some());
    let aside = if has_unshifted { 0.5 * ASIDE } else { 0.0 };
    let level = (0..samplers.len()).map(|i| [i as f64, independent, 0.0]);
    let mut curves = vec![Curve::new(
        CurveKind::Rival,
        "independent points",
        level.collect(),
    )];
    for (is_shifted, style) in [(true, SHIFTED), (false, UNSHIFTED)] {
        let mut of_kind: Vec<Curve> = Vec::new();
        for (i, sampler) in samplers.iter().enumerate() {
            let report = if is_shifted {
                Some(&sampler.shifted)
            } else {
                sampler.unshifted.as_ref()
            };
            let at = i as f64 + if is_shifted { -aside } else { aside };
            for mut curve in report.into_iter().flat_map(|curve| of_sets(curve, &style)) {
                for point in &mut curve.points {
                    let gain = point[0] / variance;
                    *point = [at, gain * point[1], gain * point[2]];
                }
                match of_kind.iter_mut().find(|other| other.name == curve.name) {
                    Some(other) => other.points.extend(curve.points),
                    None => of_kind.push(curve),
                }
            }
        }
        curves.extend(of_kind);
    }
    let name = |sampler: &&SamplerReport| {
        let n = sampler.shifted.counts[0].count;
        format!("{}, {n}", sampler.sampler)
    };
    Chart {
        title: format!("{place}: variance of a mean of *N* radiances, times *N*/σ^{{2}}"),
        note: "names have the number of points *N*; less is better".to_owned(),
        y: AxisQuantity::new("*N* Var/σ^{2}", ""),
        names: samplers.iter().map(name).collect(),
        curves,
    }
}
