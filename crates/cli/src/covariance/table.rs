//! Formats covariances as a table.

use etendue_field::{tidy, uncertain};
use etendue_predict::{AXES, CovarianceReport};
use etendue_report::table::{aligned, below_header};

/// The matrix entries that are shown: variances, and the covariances that arise as light travels.
const SHOWN: [[usize; 2]; 6] = [[0, 0], [0, 2], [2, 2], [1, 1], [1, 3], [3, 3]];

/// A table of covariances for each plane, with remarks.
pub(super) fn text(reports: &[CovarianceReport]) -> String {
    let mut lines = vec![
        "Covariance of the power spectrum. The units are cycles² per m², cycles² per (m × slope) and cycles² per slope²."
            .to_owned(),
        "The column \"traced\" covers all frequencies; the other columns cover only the band."
            .to_owned(),
    ];
    for report in reports {
        lines.push(String::new());
        lines.extend(plane(report));
    }
    lines.join("\n")
}

fn plane(report: &CovarianceReport) -> Vec<String> {
    let [rho, _, nu, _] = report.band.map(tidy);
    let mut lines = vec![format!(
        "{}: |ρ| ≤ {rho} cycles/m, |ν| ≤ {nu} cycles/slope",
        report.name
    )];
    let header = ["", "traced", "in band", "exact", "measured"];
    let entries = SHOWN.map(|[i, j]| {
        let of = |matrix: &Option<[[f64; 4]; 4]>| number(matrix.map(|matrix| matrix[i][j]));
        vec![
            format!("{} {}", AXES[i], AXES[j]),
            of(&report.traced),
            of(&report.traced_in_band),
            of(&report.exact),
            measured(
                report.measured.map(|matrix| matrix[i][j]),
                report.error.map(|matrix| matrix[i][j]),
            ),
        ]
    });
    let slice = report.slice.iter().zip(["ρ ρ", "ρ ν", "ν ν"]);
    let slice = slice.map(|(moment, name)| {
        vec![
            format!("azimuth 0: {name}"),
            String::new(),
            number(moment.traced),
            number(moment.found.predicted),
            measured(moment.found.measured, moment.found.error),
        ]
    });
    lines.extend(aligned(below_header(
        &header,
        entries.into_iter().chain(slice),
    )));
    lines.extend(report.remarks.iter().map(|remark| format!("  {remark}")));
    lines
}

fn number(value: Option<f64>) -> String {
    value.map_or("–".to_owned(), |value| format!("{value:.4}"))
}

fn measured(value: Option<f64>, error: Option<f64>) -> String {
    match (value, error) {
        (Some(value), Some(error)) => uncertain(value, error),
        _ => "–".to_owned(),
    }
}
