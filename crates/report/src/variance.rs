//! Draws predicted and found variances against the number of points.

use etendue_field::fixed;
use etendue_figures::{AxisQuantity, Curve, CurveKind, CurvePanel, Curves, Figure, Style, curves};
use etendue_pipeline::table::spaced;
use etendue_pipeline::variance::PlaneVariance;
use etendue_store::Failure;
use etendue_variance::SamplerReport;

/// Draws a panel for each sampler.
pub fn drawn(scene: &str, found: &PlaneVariance) -> Result<Figure, Failure> {
    let samplers = found
        .samplers
        .iter()
        .filter(|sampler| !sampler.shifted.counts.is_empty());
    let figure = Curves {
        title: format!(
            "{scene}, {}: variance of a mean of *N* radiances",
            spaced(&found.plane)
        ),
        note:
            "points are shifted at random on the torus; titles have the slopes predicted and found"
                .to_owned(),
        y: AxisQuantity::new("Var", ""),
        panels: samplers
            .map(|sampler| panel(sampler, found.moments.variance.value))
            .collect(),
    };
    curves(&figure, &Style::default()).map_err(Failure::cannot_run)
}

fn panel(sampler: &SamplerReport, variance: f64) -> CurvePanel {
    let report = &sampler.shifted;
    let points = |of: fn(&etendue_variance::CountReport) -> [f64; 2]| {
        let counts = report.counts.iter();
        let points = counts.map(|count| {
            let [value, error] = of(count);
            [count.count as f64, value, error]
        });
        points.collect()
    };
    let independent = report.counts.iter().map(|count| {
        let n = count.count as f64;
        [n, variance / n, 0.0]
    });
    let mut curves = vec![
        Curve::new(
            CurveKind::Rival,
            "independent points",
            independent.collect(),
        ),
        Curve::new(
            CurveKind::Theory,
            "predicted",
            points(|count| [count.predicted.value, 0.0]),
        ),
        Curve::new(
            CurveKind::Measured,
            "found",
            points(|count| [count.found.value, count.found.error]),
        ),
    ];
    if report.counts.iter().all(|count| count.is_undecided) {
        curves.remove(1);
    }
    let slopes = match (report.predicted_slope, report.found_slope) {
        (Some(predicted), Some(found)) => {
            let [predicted, found] =
                [predicted, found.value].map(|s| fixed(s, 2).replace('-', "−"));
            format!(": {predicted}, {found}")
        }
        _ => String::new(),
    };
    CurvePanel {
        title: format!("{}{slopes}", sampler.sampler),
        x: AxisQuantity::new("*N*", ""),
        curves,
        is_log: [true, true],
    }
}
