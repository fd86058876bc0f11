//! Collects the results of a complete validation for every row of the paper's Table 1.

use crate::report::Bound::AtLeast;
use crate::report::{Check, EXACT, ReportSection, Row};

/// A row of the paper's Table 1. Each row of a section names the rows of Table 1 to which it
/// applies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Line {
    Travel,
    Visibility,
    Incidence,
    Outgoing,
    Curvature,
    Cosine,
    Mirror,
    Brdf,
    Texture,
    Separable,
    SpaceVarying,
    Environment,
}

const SHEAR: &str = "shear";
const SCALE: &str = "scale, spatial";
const TURN: &str = "reflection of angles";
const TIMES: &str = "multiplication";
const SPREAD: &str = "convolution";

/// All rows, each with its name, and its operator in ray space and in Fourier space.
const LINES: [(Line, [&str; 3]); 12] = [
    (Line::Travel, ["travel", SHEAR, SHEAR]),
    (Line::Visibility, ["visibility", TIMES, SPREAD]),
    (Line::Incidence, ["light incidence", SCALE, SCALE]),
    (Line::Outgoing, ["outgoing angle", SCALE, SCALE]),
    (Line::Curvature, ["curvature", SHEAR, SHEAR]),
    (Line::Cosine, ["cosine term", TIMES, SPREAD]),
    (Line::Mirror, ["mirror (section 4.2)", TURN, TURN]),
    (Line::Brdf, ["BRDF", SPREAD, TIMES]),
    (Line::Texture, ["texture mapping", TIMES, SPREAD]),
    (
        Line::Separable,
        [
            "separable BRDF",
            "multiplication, then convolution",
            "convolution, then multiplication",
        ],
    ),
    (
        Line::SpaceVarying,
        [
            "space-varying BRDF",
            "semi-convolution, angles",
            "semi-convolution, space",
        ],
    ),
    (
        Line::Environment,
        [
            "environment map (section 6.1)",
            "shear by k, multiplication",
            "product at Ωx/k",
        ],
    ),
];

/// The results for every row of Table 1, collected from the sections of all parts of the
/// validation.
pub(crate) fn rows(sections: &[ReportSection]) -> ReportSection {
    ReportSection::new(
        "Every row",
        "Each row is one operator of Table 1, and the table counts the checks of this operator in \
         the sections below. *Without photons* counts checks by quadrature and by traced rays. \
         *Planes with photons* counts the planes right after the operator that are measured with \
         photons. *Smallest p* is the smallest p-value of these planes against the exact \
         prediction. Required: a row has both kinds of checks, and all of them pass. On some \
         planes, the noise of photons from nets is below the error of the prediction, which comes \
         from its transform and its quadrature. Such a plane passes with a small p if the stated \
         error of the prediction may explain the whole difference.",
        "row | in ray space | in Fourier space | without photons | planes with photons | smallest \
         p | verdict",
        LINES.map(|(line, words)| row(line, words, sections)),
    )
}

fn row(line: Line, words: [&str; 3], sections: &[ReportSection]) -> Row {
    let all = sections.iter().flat_map(|section| &section.rows);
    let of_line = all.filter(|row| row.lines.contains(&line));
    // If a row of a section has a check of p, photons test this row.
    let (planes, others): (Vec<&Row>, Vec<&Row>) = of_line.partition(|row| exact(row).is_some());
    let mut cells = words.map(str::to_owned).to_vec();
    let mut checks = Vec::new();
    for (id, rows) in [("without photons", &others), ("with photons", &planes)] {
        let passed = rows.iter().filter(|row| row.passes()).count();
        cells.push(format!("{passed} of {}", rows.len()));
        let (passed, all) = (passed as f64, rows.len().max(1) as f64);
        checks.push(
            Check::new(id, passed, AtLeast(all))
                .because("all must pass, and there must be at least one"),
        );
    }
    let p = planes.iter().filter_map(|row| exact(row));
    cells.push(p.fold(1.0, f64::min).to_string());
    Row::new(cells, checks)
}

/// The check of p against the exact prediction, if the row has such a check.
fn exact(row: &Row) -> Option<f64> {
    let check = row.checks.iter().find(|check| check.id == EXACT);
    check.map(|check| check.figure)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Bound::Below;

    fn section(cells: &[&str], checks: Vec<Check>) -> ReportSection {
        let cells = cells.iter().map(ToString::to_string).collect();
        ReportSection::new(
            "Some",
            "",
            "operator | said | verdict",
            [Row::new(cells, checks).of([Line::Texture])],
        )
    }

    fn texture(sections: &[ReportSection]) -> String {
        let rows = rows(sections);
        let markdown = rows.markdown();
        let row = markdown.lines().find(|row| row.contains("texture mapping"));
        row.expect("the row").to_owned()
    }

    fn off(figure: f64) -> Vec<Check> {
        vec![Check::new("off", figure, Below(1e-9)).because("rounding")]
    }

    #[test]
    fn a_row_needs_checks_of_both_kinds_and_all_of_them() {
        let without = || section(&["texture", "–"], off(1e-12));
        let with = |p| section(&["texture", "–"], vec![Check::p(EXACT, p, 0.01)]);
        let both = [without(), with(Some(0.3))];
        assert!(texture(&both).ends_with("1 of 1 | 1 of 1 | 0.3 | pass |"));
        let one = texture(&both[1..]);
        assert!(one.ends_with("0 of 0 | 1 of 1 | 0.3 | FAIL: without photons |"));
        for (p, shown) in [(Some(0.001), "0.001"), (None, "0")] {
            let row = texture(&[without(), with(p)]);
            let end = format!("1 of 1 | 0 of 1 | {shown} | FAIL: with photons |");
            assert!(row.ends_with(&end), "{row}");
        }
    }

    #[test]
    fn words_do_not_make_a_failing_check_pass() {
        let p = || section(&["texture", "pass"], vec![Check::p(EXACT, Some(0.3), 0.01)]);
        // The checked number of the row is too large or NaN, or the row has no check.
        for checks in [off(1e-6), off(f64::NAN), Vec::new()] {
            let planted = section(&["texture", "pass"], checks);
            let shown = planted.markdown();
            assert!(shown.contains("| texture | pass | FAIL"), "{shown}");
            let row = texture(&[planted, p()]);
            assert!(
                row.ends_with("0 of 1 | 1 of 1 | 0.3 | FAIL: without photons |"),
                "{row}"
            );
        }
        let planted = section(&["texture", "pass"], off(1e-6));
        assert!(!planted.passes());
        let shown = planted.markdown();
        assert!(shown.contains("Outcome: **FAILED**"), "{shown}");
        let told = "* texture, pass: off: 0.000001, required below 0.000000001 (rounding)\n";
        assert!(shown.ends_with(told), "{shown}");
    }
}
