//! Defines the results of a validation: numbers that are checked against bounds, and tables that
//! show these numbers.

use crate::rows::Line;
use etendue_compare::{PlaneReport, Verdict};

/// The requirement that a number must meet; NaN meets no requirement.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Bound {
    Below(f64),
    AtMost(f64),
    AtLeast(f64),
    Above(f64),
}

/// A number, the requirement that it must meet, and the reason for the requirement.
#[derive(Clone, Debug)]
pub(crate) struct Check {
    pub(crate) id: &'static str,
    pub(crate) figure: f64,
    bound: Bound,
    reason: &'static str,
}

/// The name of the check of p, where p compares photons with the exact prediction.
pub(crate) const EXACT: &str = "exact";

/// A number and the requirement that it must meet, without a reason yet.
#[must_use]
pub(crate) struct Requirement {
    id: &'static str,
    figure: f64,
    bound: Bound,
}

impl Requirement {
    /// Adds the reason for the requirement.
    pub(crate) fn because(self, reason: &'static str) -> Check {
        let Self { id, figure, bound } = self;
        Check {
            id,
            figure,
            bound,
            reason,
        }
    }
}

impl Check {
    /// Creates a requirement, which becomes a check when its reason is given.
    #[expect(clippy::new_ret_no_self, reason = "a check needs a reason")]
    pub(crate) fn new(id: &'static str, figure: f64, bound: Bound) -> Requirement {
        Requirement { id, figure, bound }
    }

    /// A check that a fact is true. The checked number is 1 if the fact is true, and 0
    /// otherwise.
    pub(crate) fn fact(id: &'static str, holds: bool, reason: &'static str) -> Self {
        Self::new(id, f64::from(holds), Bound::AtLeast(1.0)).because(reason)
    }

    /// Creates a check that a p-value is at least `level`; a missing p-value counts as 0.
    pub(crate) fn p(id: &'static str, p: Option<f64>, level: f64) -> Self {
        let bound = Bound::AtLeast(level);
        Self::new(id, p.unwrap_or(0.0), bound).because("α over all planes")
    }

    /// A check of photons against the exact prediction, judged as in a run. The check
    /// passes if p passes. It also passes if the stated error of the prediction is below the
    /// resolution and may explain the difference.
    pub(crate) fn exact(report: &PlaneReport, level: f64) -> Self {
        let check = Self::p(EXACT, report.p_value, level);
        if check.passes() || report.exact_verdict() != Verdict::Pass {
            return check;
        }
        Self {
            bound: Bound::AtLeast(0.0),
            reason: "within the stated error of the prediction",
            ..check
        }
    }

    /// A check that photons are in the window of a plane.
    pub(crate) fn light(report: &PlaneReport) -> Self {
        let light = report.in_window as f64;
        Self::new("light", light, Bound::AtLeast(1.0)).because("p says nothing without light")
    }

    /// A check that a number of occurrences is zero.
    pub(crate) fn none(id: &'static str, count: usize) -> Self {
        Self::new(id, count as f64, Bound::AtMost(0.0)).because("none may occur")
    }

    pub(crate) fn passes(&self) -> bool {
        self.held().2
    }

    /// The requirement in words, the bound, and whether the number meets the requirement.
    fn held(&self) -> (&'static str, f64, bool) {
        let figure = self.figure;
        match self.bound {
            Bound::Below(bound) => ("below", bound, figure < bound),
            Bound::AtMost(bound) => ("at most", bound, figure <= bound),
            Bound::AtLeast(bound) => ("at least", bound, figure >= bound),
            Bound::Above(bound) => ("above", bound, figure > bound),
        }
    }

    fn told(&self) -> String {
        let (id, figure, reason) = (self.id, self.figure, self.reason);
        let (words, bound, _) = self.held();
        format!("{id}: {figure}, required {words} {bound} ({reason})\n")
    }
}

fn failed(checks: &[Check]) -> impl Iterator<Item = &Check> {
    checks.iter().filter(|check| !check.passes())
}

/// The larger of two numbers, where NaN counts as the largest.
pub(crate) fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}

/// A p-value as text, or a dash if there is none.
pub(crate) fn number(x: Option<f64>) -> String {
    x.map_or("–".to_owned(), |x| format!("{x:.5}"))
}

/// A share in per cent, or a dash if there is none.
pub(crate) fn percent(x: Option<f64>) -> String {
    x.map_or("–".to_owned(), |x| format!("{:.3} %", 100.0 * x))
}

/// The cells on the comparison of photons with the exact prediction and the chain of a
/// plane: photons in the window, noise, p, and the error, the excess, the bound of the excess and
/// the resolvable excess of the chain.
pub(crate) fn plane_cells(report: &PlaneReport) -> [String; 7] {
    let first = report.first_order.as_ref();
    [
        report.in_window.to_string(),
        percent(report.noise_limit),
        number(report.p_value),
        percent(first.map(|first| first.chain.error)),
        percent(first.and_then(|first| first.excess)),
        percent(first.and_then(|first| first.excess_bound)),
        percent(first.and_then(|first| first.resolvable)),
    ]
}

/// The verdict on a prediction in words.
pub(crate) const fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "accepted",
        Verdict::Fail => "rejected",
        Verdict::Undecided => "undecided",
    }
}

/// A row of a results table, with the checks of this row.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) cells: Vec<String>,
    pub(crate) checks: Vec<Check>,
    /// The rows of the paper's Table 1 to which this row applies.
    pub(crate) lines: Vec<Line>,
}

impl Row {
    pub(crate) fn new(cells: Vec<String>, checks: Vec<Check>) -> Self {
        Self {
            cells,
            checks,
            lines: Vec::new(),
        }
    }

    pub(crate) fn of(self, lines: impl IntoIterator<Item = Line>) -> Self {
        Self {
            lines: lines.into_iter().collect(),
            ..self
        }
    }

    /// Checks whether the row has checks, and all of them pass.
    pub(crate) fn passes(&self) -> bool {
        !self.checks.is_empty() && failed(&self.checks).next().is_none()
    }

    fn verdict(&self) -> String {
        if self.passes() {
            return "pass".to_owned();
        }
        let ids: Vec<&str> = failed(&self.checks).map(|check| check.id).collect();
        format!("FAIL: {}", ids.join(", "))
    }
}

/// One validation: a Markdown table, the checks of its rows, and the checks of the table as a
/// whole.
#[derive(Debug)]
pub(crate) struct ReportSection {
    title: String,
    text: String,
    header: &'static str,
    pub(crate) rows: Vec<Row>,
    checks: Vec<Check>,
}

impl ReportSection {
    /// Creates a section. The text describes the procedure and the requirements that the rows must
    /// meet. The header has the column headings, separated by ` | `. If each row has one cell less
    /// than the table has headings, the last column shows the verdict on the row.
    pub(crate) fn new(
        title: impl Into<String>,
        text: impl Into<String>,
        header: &'static str,
        rows: impl IntoIterator<Item = Row>,
    ) -> Self {
        Self {
            title: title.into(),
            text: text.into(),
            header,
            rows: rows.into_iter().collect(),
            checks: Vec::new(),
        }
    }

    pub(crate) fn with_text(self, text: String) -> Self {
        Self { text, ..self }
    }

    /// Adds checks of the table as a whole, in addition to the checks of its rows.
    pub(crate) fn with_checks(self, checks: Vec<Check>) -> Self {
        Self { checks, ..self }
    }

    pub(crate) fn passes(&self) -> bool {
        self.failures().is_empty()
    }

    /// The section on a planted fault. The section passes if at least one check of `self`
    /// fails, although without the fault all checks of `self` pass.
    pub(crate) fn planted(mut self, title: String, text: &str, is_sound: bool) -> Self {
        let is_seen = !self.passes();
        self.rows.iter_mut().for_each(|row| row.checks.clear());
        self.checks = vec![
            Check::fact(
                "sound",
                is_sound,
                "without the fault all checks must pass, else a failure shows nothing",
            ),
            Check::fact(
                "seen",
                is_seen,
                "a check must fail, because a fault is planted",
            ),
        ];
        Self {
            title,
            text: text.to_owned(),
            ..self
        }
    }

    pub(crate) fn markdown(&self) -> String {
        // A vertical bar inside a text would end the table cell.
        let line = |cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(|c| c.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let header: Vec<String> = self.header.split(" | ").map(str::to_owned).collect();
        let rule = vec!["---".to_owned(); header.len()];
        let row = |row: &Row| {
            let mut cells = row.cells.clone();
            if cells.len() < header.len() {
                cells.push(row.verdict());
            }
            line(&cells)
        };
        let rows: String = self.rows.iter().map(row).collect();
        let outcome = match self.failures() {
            none if none.is_empty() => "**passed**\n".to_owned(),
            failures => format!("**FAILED**\n\n{failures}"),
        };
        format!(
            "## {}\n\n{}\n\n{}{}{rows}\nOutcome: {outcome}",
            self.title,
            self.text,
            line(&header),
            line(&rule)
        )
    }

    /// A line for each failed check, which begins with the first cells of its row.
    fn failures(&self) -> String {
        let of_row = |row: &Row| {
            let line = |check: &Check| format!("* {}: {}", row.cells[..2].join(", "), check.told());
            failed(&row.checks).map(line).collect::<String>()
        };
        let of_all = failed(&self.checks).map(|check| format!("* {}", check.told()));
        self.rows.iter().map(of_row).chain(of_all).collect()
    }
}
