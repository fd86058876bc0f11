//! Statements in the paper's text, each tested by a number.

use super::{blockers, spreading};
use crate::report::Bound::{AtLeast, AtMost};
use crate::report::{Check, ReportSection, Row};

/// A statement with its measured number.
pub(super) struct Statement {
    pub(super) said: &'static str,
    pub(super) measured: String,
    pub(super) number: f64,
    /// The expected range of the measured number, which is known in advance.
    pub(super) expected: [f64; 2],
    /// The conclusion about the statement: "holds", or the part of it that holds.
    pub(super) holds: &'static str,
}

/// The section.
pub(super) fn words() -> ReportSection {
    let all = blockers::statements()
        .into_iter()
        .chain(spreading::statements());
    let rows = all.map(|s| {
        let [low, high] = s.expected;
        let checks = [AtLeast(low), AtMost(high)];
        let checks = checks.map(|bound| {
            Check::new("number", s.number, bound).because("bounds fixed before the run")
        });
        let cells = vec![
            s.said.to_owned(),
            s.measured,
            format!("{:.4e}", s.number),
            format!("{} … {}", bound(low), bound(high)),
            s.holds.to_owned(),
        ];
        Row::new(cells, checks.into())
    });
    ReportSection::new(
        "What the paper says in words",
        "No photons are traced here: the numbers come from quadratures in ray space and from \
         closed forms of strips. Where a statement holds only in part, the rows after it show \
         where it does not hold. Required: the number is within the bounds beside it.",
        "statement | measured | number | required | holds | verdict",
        rows,
    )
}

fn bound(x: f64) -> String {
    if x > 0.0 && x < 1e-3 {
        format!("{x:.0e}")
    } else {
        x.to_string()
    }
}
