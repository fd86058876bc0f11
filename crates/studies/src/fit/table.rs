//! The tables of a fit, for a terminal.

use crate::fit::result::Fitted;
use etendue_compare::Verdict;
use etendue_field::{brief, decimals, fixed, grouped, uncertain};
use etendue_report::table::aligned;

/// All tables, and the verdict.
#[must_use]
pub fn text(scene: &str, fitted: &Fitted) -> String {
    let photons = fitted
        .photons
        .map(|photons| format!(", {} photons", grouped(photons)));
    let mut lines = vec![
        format!(
            "{scene}: {}{}",
            fitted.planes.join(", "),
            photons.unwrap_or_default()
        ),
        String::new(),
    ];
    lines.extend(aligned(estimates(fitted)));
    if fitted.fields.len() > 1 && !fitted.correlations.is_empty() {
        lines.push(String::new());
        lines.extend(aligned(correlations(fitted)));
    }
    lines.push(String::new());
    if fitted.groups.is_none() {
        lines.push(
            "errors are those of the file: the noise of all frequencies is taken as independent"
                .to_owned(),
        );
    }
    if let Some(degeneracy) = &fitted.degeneracy {
        let times = 1.0 / degeneracy.information.sqrt();
        let times = match times < 1e3 {
            true => format!("{times:.0}"),
            false => "more than 1000".to_owned(),
        };
        lines.push(format!(
            "hard to tell apart: {} (the error of this change is {times} times that of a single field)",
            degeneracy.words,
        ));
    }
    for rival in fitted.minima.iter().skip(1) {
        let values = fitted.fields.iter().zip(&rival.values);
        let values = values.map(|(of, value)| format!("{} = {}", of.field, brief(*value)));
        let values: Vec<String> = values.collect();
        lines.push(format!(
            "another minimum: {}, p = {}",
            values.join(", "),
            p_value(rival.p_value)
        ));
    }
    lines.push(verdict(fitted));
    lines.join("\n")
}

fn p_value(p: Option<f64>) -> String {
    p.map_or("–".to_owned(), |p| format!("{p:.4}"))
}

fn estimates(fitted: &Fitted) -> Vec<Vec<String>> {
    let header = ["field", "scene", "fit", "alone", "bound"].map(str::to_owned);
    let error = |error: Option<f64>| match error {
        Some(error) if error > 0.0 => fixed(error, decimals(error)),
        _ => "–".to_owned(),
    };
    let row = |field: &super::FittedField| {
        let value = match field.error {
            Some(error) => uncertain(field.value, error),
            None => "not determined".to_owned(),
        };
        vec![
            field.field.clone(),
            brief(field.start),
            value,
            error(field.error_alone),
            error(field.bound),
        ]
    };
    std::iter::once(header.to_vec())
        .chain(fitted.fields.iter().map(row))
        .collect()
}

fn correlations(fitted: &Fitted) -> Vec<Vec<String>> {
    let names = fitted.fields.iter().map(|field| field.field.clone());
    let header = std::iter::once("correlation".to_owned()).chain(names.clone());
    let row = |(name, row): (String, &Vec<f64>)| {
        let numbers = row.iter().map(|correlation| fixed(*correlation, 2));
        std::iter::once(name).chain(numbers).collect()
    };
    std::iter::once(header.collect())
        .chain(names.zip(&fitted.correlations).map(row))
        .collect()
}

/// The verdict in words.
fn verdict(fitted: &Fitted) -> String {
    let p = p_value(fitted.p_value);
    match (fitted.verdict, &fitted.undecided) {
        (Verdict::Undecided, Some(why)) => format!("undecided, p = {p}: {why}"),
        (Verdict::Fail, _) => format!(
            "fail, p = {p} < {}: no values of the fields explain the measurement",
            brief(fitted.level)
        ),
        _ => format!(
            "pass, p = {p}: no disagreement is found between the scene with these values and the measurement"
        ),
    }
}
