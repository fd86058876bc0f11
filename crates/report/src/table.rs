//! Formats the tables of a run's results.

use etendue_compare::{FirstOrderReport, ParameterReport, PlaneReport, TESTS, Verdict, sidak};
use etendue_field::{brief, decimals, fixed, grouped, uncertain};
use etendue_pipeline::Summary;
use etendue_store::Failure;

/// The table of planes, the table of parameters, and the verdict, as printed by
/// `etendue run`.
pub fn text(summary: &Summary) -> String {
    let ledger = summary
        .ledger_imbalance
        .map(|imbalance| match imbalance.abs() {
            0.0 => ", flux conserved exactly".to_owned(),
            imbalance => format!(", flux conserved to {imbalance:.0e}"),
        });
    let mut lines = vec![
        format!(
            "{}: {} photons, seed {}{}{}",
            summary.scene,
            grouped(summary.photons),
            summary.seed,
            summary.scene_file.run.color.suffix(),
            ledger.unwrap_or_default(),
        ),
        String::new(),
    ];
    lines.extend(aligned(planes(summary)));
    lines.push(String::new());
    let parameters = parameters(summary);
    if parameters.len() > 1 {
        lines.extend(aligned(parameters));
        lines.push(String::new());
    }
    let full_radials = full_radials(summary);
    if full_radials.len() > 1 {
        lines.extend(aligned(full_radials));
        lines.push(String::new());
    }
    for plane in &summary.planes {
        let warnings = plane.warnings.iter();
        lines.extend(warnings.map(|w| format!("warning: {}: {w}", plane.name)));
    }
    lines.extend(summary.planes.iter().filter_map(on_chain));
    let inquiries = summary.inquiries.iter();
    lines.extend(inquiries.map(|inquiry| format!("{}: {}", inquiry.plane, inquiry.finding)));
    lines.push(format!("verdict: {}", verdict_text(summary)));
    lines.join("\n")
}

/// The message about a first-order chain that does not agree with the photons.
pub fn on_chain(plane: &PlaneReport) -> Option<String> {
    let FirstOrderReport { chain, verdict, .. } = plane.first_order.as_ref()?;
    let name = &plane.name;
    let printed = if chain.as_printed {
        ", as printed,"
    } else {
        ""
    };
    match verdict {
        Verdict::Pass => None,
        Verdict::Fail if chain.radiance_defect.abs() >= chain.defect => Some(format!(
            "{name}: the first-order chain{printed} has a wrong scale: it gives the central ray {} of its true radiance",
            percent(Some(1.0 + chain.radiance_defect)),
        )),
        Verdict::Fail => Some(format!(
            "{name}: the first-order chain{printed} has a wrong map: even close to the central ray, its rays are off by {} of the window's half-width",
            percent(Some(chain.defect)),
        )),
        Verdict::Undecided => Some(format!(
            "{name}: the first-order chain has an error of {} here and does not describe this light field",
            percent(Some(chain.error)),
        )),
    }
}

/// A table of the differences between measurement and prediction, plane by plane.
pub fn planes(summary: &Summary) -> Vec<Vec<String>> {
    let mut header = vec![
        "plane",
        "class",
        "in window",
        "χ²/dof",
        "p",
        "p of power",
        "rel. error",
        "noise alone",
        "shear slope [m]",
        "predicted",
    ];
    let chains = summary.planes.iter().any(|p| p.first_order.is_some());
    header.extend(chains.then_some("chain off by (computed)"));
    header.push("verdict");
    let row = |plane: &PlaneReport| {
        let mut row = vec![
            plane.name.clone(),
            plane.class.to_string(),
            grouped(plane.in_window),
            number(plane.chi2_per_dof, 3),
            number(plane.p_value, 5),
            number(plane.radial.and_then(|radial| radial.p_value), 5),
            percent(plane.relative_error),
            percent(plane.noise_limit),
            match (plane.slope.measured, plane.slope.error) {
                (Some(value), Some(error)) => uncertain(value, error),
                _ => number(None, 0),
            },
            predicted(plane),
        ];
        row.extend(chains.then(|| chain(plane)));
        row.push(word(plane.verdict).to_owned());
        row
    };
    below_header(&header, summary.planes.iter().map(row))
}

/// The difference between the photons and the first-order chain, and the expected value of
/// this difference.
pub fn chain(plane: &PlaneReport) -> String {
    let Some(first_order) = &plane.first_order else {
        return "–".to_owned();
    };
    let error = 100.0 * first_order.chain.error;
    format!("{} ({error:.3} %)", off_by(first_order))
}

/// Errors below this limit, in per cent, are too small for the digits of [`percent`].
const LEAST_ERROR: f64 = 5e-4;

/// The difference between the photons and the first-order chain, without the part due to
/// noise. If its square is below two standard errors, the text is an upper bound.
pub fn off_by(chain: &FirstOrderReport) -> String {
    let Some([square, error]) = chain.squared_excess() else {
        return percent(None);
    };
    if square > 2.0 * error {
        let excess = square.sqrt();
        let error = 100.0 * error / (2.0 * excess);
        return match error < LEAST_ERROR {
            true => percent(Some(excess)),
            false => uncertain(100.0 * excess, error) + " %",
        };
    }
    let most = (square.max(0.0) + 2.0 * error).sqrt();
    format!("< {}", percent(Some(most)))
}

/// A table of the parameters of the chain, as measured by the photons.
pub fn parameters(summary: &Summary) -> Vec<Vec<String>> {
    let header = [
        "plane",
        "parameter",
        "scene",
        "measured",
        "smallest detectable change",
    ];
    let row = |plane: &PlaneReport, parameter: &ParameterReport| {
        let [measured, change] = measured(parameter);
        vec![
            plane.name.clone(),
            with_unit(&parameter.name, &parameter.unit),
            brief(parameter.scene),
            measured,
            change,
        ]
    };
    let rows = summary.planes.iter().flat_map(|plane| {
        let parameters = plane.parameters.iter();
        parameters.map(move |parameter| row(plane, parameter))
    });
    below_header(&header, rows)
}

/// A table of the differences between measured and predicted full radial spectra, plane
/// by plane.
fn full_radials(summary: &Summary) -> Vec<Vec<String>> {
    let header = [
        "plane",
        "bins of the full radial spectrum",
        "χ²/bin",
        "p",
        "rel. error",
        "noise alone",
        "aliasing [σ]",
    ];
    let rows = summary.planes.iter().filter_map(|plane| {
        let found = plane.full_radial?;
        Some(vec![
            plane.name.clone(),
            found.power.bins.to_string(),
            number(found.power.chi2_per_bin, 3),
            number(found.power.p_value, 5),
            percent(found.power.relative_error),
            percent(found.power.noise_limit),
            number(found.aliasing, 2),
        ])
    });
    below_header(&header, rows)
}

/// A name with its unit in brackets.
pub fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() {
        name.to_owned()
    } else {
        format!("{name} [{unit}]")
    }
}

/// The measured value of a parameter, and the smallest change of the parameter that the
/// photons can detect. This change is a share of the parameter, or has the parameter's unit if the
/// parameter is zero or a position, which may be zero by chance. If the smallest detectable change is larger than
/// the parameter, both texts are “–”. If the error of the value is larger than the value, only the
/// text of the value is “–”.
fn measured(parameter: &ParameterReport) -> [String; 2] {
    let value = uncertain(parameter.measured, parameter.error);
    if parameter.scene.abs() < 1e-12 || parameter.name.starts_with("position ") {
        let change = format!("{:.1e} {}", parameter.detectable, parameter.unit);
        return [value, change.trim_end().to_owned()];
    }
    let share = (parameter.detectable / parameter.scene).abs();
    let change = if share > 1.0 {
        number(None, 0)
    } else {
        etendue_field::percent(share, 2)
    };
    if share > 1.0 || parameter.error > parameter.measured.abs() {
        [number(None, 0), change]
    } else {
        [value, change]
    }
}

/// Aligns columns, text to the left and numbers to the right. A column is as wide as its widest
/// cell, and two spaces separate columns.
pub fn aligned(rows: Vec<Vec<String>>) -> Vec<String> {
    let width = |column: usize| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        cells.max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..rows[0].len()).map(width).collect();
    let text = |column: usize| {
        let is_text = |cell: &String| cell.starts_with(|c: char| c.is_ascii_alphabetic());
        rows.get(1).is_some_and(|row| is_text(&row[column]))
    };
    let is_text: Vec<bool> = (0..widths.len()).map(text).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).zip(&is_text);
        let padded: Vec<String> = cells
            .map(|((cell, &width), text)| {
                if *text {
                    format!("{cell:<width$}")
                } else {
                    format!("{cell:>width$}")
                }
            })
            .collect();
        padded.join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect()
}

/// A table as CSV.
pub fn csv(
    header: &[String],
    rows: impl IntoIterator<Item = Vec<String>>,
) -> Result<Vec<u8>, Failure> {
    let text = etendue_figures::csv_text(header, rows).map_err(Failure::cannot_run)?;
    Ok(text.into_bytes())
}

/// The rows of a table below its header.
pub fn below_header(
    header: &[&str],
    rows: impl IntoIterator<Item = Vec<String>>,
) -> Vec<Vec<String>> {
    let header = header.iter().map(|name| (*name).to_owned()).collect();
    std::iter::once(header).chain(rows).collect()
}

/// A sentence with the verdict of a run and its reasons.
pub fn verdict_text(summary: &Summary) -> String {
    let with = |verdict: Verdict| -> Vec<&PlaneReport> {
        let planes = summary.planes.iter();
        planes.filter(|p| p.verdict == verdict).collect()
    };
    let names = |planes: &[&PlaneReport]| -> String {
        let names: Vec<&str> = planes.iter().map(|p| p.name.as_str()).collect();
        names.join(", ")
    };
    let alpha = 100.0 * summary.alpha;
    match summary.verdict {
        Verdict::Pass => {
            let fields = summary.planes.iter().filter(|p| p.full_radial.is_some());
            let tests = TESTS * summary.planes.len() + fields.count();
            let level = sidak(summary.alpha, tests);
            format!(
                "pass: no plane disagrees with its prediction (α = {alpha} % over all planes: p ≥ {level:.4} at each)"
            )
        }
        Verdict::Fail => {
            let is_exact = |plane: &&PlaneReport| plane.exact_verdict() == Verdict::Fail;
            let (measured, chains): (Vec<_>, Vec<_>) =
                with(Verdict::Fail).into_iter().partition(is_exact);
            let said = |what: &str, planes: &[&PlaneReport]| {
                (!planes.is_empty()).then(|| format!("{what} at {}", names(planes)))
            };
            let said = [
                said("measured and predicted disagree", &measured),
                said("the first-order chain is wrong", &chains),
            ];
            format!(
                "fail: {}",
                said.into_iter().flatten().collect::<Vec<_>>().join("; ")
            )
        }
        Verdict::Undecided => {
            let open = with(Verdict::Undecided).into_iter();
            undecided(open.filter_map(|plane| Some((&plane.name, plane.undecided.clone()?))))
        }
    }
}

/// The reasons why planes are undecided, in a sentence.
pub(crate) fn undecided<'a>(planes: impl Iterator<Item = (&'a String, String)>) -> String {
    let reasons = planes.map(|(name, reason)| format!("\n  {name}: {reason}"));
    format!("undecided:{}", reasons.collect::<String>())
}

/// The predicted slope with the same number of digits as the measured slope.
fn predicted(plane: &PlaneReport) -> String {
    match (plane.slope.predicted, plane.slope.error) {
        (Some(value), Some(error)) if error > 0.0 => fixed(value, decimals(error)),
        (value, _) => number(value, 4),
    }
}

/// A verdict as a word.
pub fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "pass",
        Verdict::Fail => "fail",
        Verdict::Undecided => "undecided",
    }
}

/// A number with `digits` digits after the point, or `–` if there is no number.
pub fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or("–".to_owned(), |v| fixed(v, digits))
}

/// A share in per cent, or `–` if there is no share.
pub fn percent(value: Option<f64>) -> String {
    value.map_or("–".to_owned(), |share| etendue_field::percent(share, 3))
}

/// A name for display, with spaces in place of underscores.
pub fn spaced(name: &str) -> String {
    name.replace('_', " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_compare::FirstOrderChain;

    #[test]
    fn what_photons_cannot_tell_is_not_shown() {
        let shown = |scene: f64, value: f64, error: f64| {
            measured(&ParameterReport {
                name: "side".to_owned(),
                unit: "m".to_owned(),
                scene,
                measured: value,
                error,
                detectable: 3.86 * error,
            })
        };
        assert_eq!(shown(0.2, 0.21, 0.01), ["0.210 ± 0.010", "19.30 %"]);
        assert_eq!(shown(2.0, -113.0, 41.0), ["–", "–"]);
        assert_eq!(shown(1.0, 1.0, 6.3e-6)[1], "0.0024 %");
        assert_eq!(shown(2.0, 0.1, 0.2), ["–", "38.60 %"]);
        assert_eq!(shown(0.0, 0.1, 0.2), ["0.10 ± 0.20", "7.7e-1 m"]);
        let position = ParameterReport {
            name: "position x of b".to_owned(),
            unit: "m".to_owned(),
            scene: 1e-5,
            measured: 1e-3,
            error: 2e-3,
            detectable: 8e-3,
        };
        assert_eq!(measured(&position), ["0.0010 ± 0.0020", "8.0e-3 m"]);
    }

    #[test]
    fn a_difference_below_its_noise_is_a_bound() {
        let shown = |excess: f64, excess_bound: f64| {
            off_by(&FirstOrderReport {
                chain: FirstOrderChain {
                    error: 0.0,
                    defect: 0.0,
                    radiance_defect: 0.0,
                    matrix: [[0.0; 4]; 4],
                    covariance: [None; 2],
                    foci: Vec::new(),
                    as_printed: false,
                },
                excess: Some(excess),
                excess_bound: Some(excess_bound),
                resolvable: None,
                p_value: None,
                exact: Verdict::Pass,
                verdict: Verdict::Pass,
            })
        };
        // The standard error of the square is 1e-5: the bound is 1.645 of these errors above.
        let bound = |square: f64| (square + 1.645e-5).sqrt();
        // √0.1225 = 0.35, with the error 1e-5 / (2 · 0.35).
        assert_eq!(shown(0.35, bound(0.1225)), "35.0000 ± 0.0014 %");
        assert_eq!(shown(3.5, bound(12.25)), "350.000 %");
        // √(0 + 2e-5) = 0.00447.
        assert_eq!(shown(0.0, bound(0.0)), "< 0.447 %");
        assert_eq!(shown(-0.003, bound(-9e-6)), "< 0.447 %");
    }

    #[test]
    fn nothing_is_minus_zero() {
        assert_eq!(fixed(-0.004, 2), "0.00");
        assert_eq!(fixed(-0.006, 2), "-0.01");
        assert_eq!(uncertain(-0.04, 1.5), "0.0 ± 1.5");
    }
}
