//! Tests statements in the paper's text with photons. The table has a row for each statement.

mod blockers;
mod criteria;
mod locality;
mod number;
mod scene;
mod surfaces;

use crate::report::Bound::AtMost;
use crate::report::{Check, ReportSection, Row};
use number::ClaimNumber;
pub(crate) use scene::ClaimRun;

/// Maximum deviation of a measured number from its prediction, in standard errors.
const PULL: f64 = 4.0;
const CHANCE: &str = "by chance, 1 of 16,000 numbers is farther off, and there are about 60 \
    numbers";

/// A statement of the paper, with the result that photons give for it.
struct Claim {
    said: &'static str,
    /// A text that describes the measured numbers.
    shown: String,
    numbers: Vec<ClaimNumber>,
    /// Checks in addition to the check that each number agrees with its prediction.
    checks: Vec<Check>,
    /// The conclusion about the statement: "holds", or the part of it that holds.
    holds: &'static str,
}

/// The section.
pub(crate) fn claims(run: ClaimRun) -> ReportSection {
    let parts = [
        blockers::claims,
        surfaces::claims,
        criteria::claims,
        locality::claims,
    ];
    let rows = parts
        .iter()
        .flat_map(|claims| claims(run).into_iter().map(row));
    ReportSection::new(
        "What the paper says in words, with photons",
        format!(
            "The scenes are in `scenes/words/`, and the rows of a statement vary some of their \
             fields. The seed is {}. Numbers are read from measured spectra, with their jackknife \
             errors over 64 batches. The numbers in brackets come from the prediction of the same \
             scene, by the same estimator. The bounds were fixed before the run. Required: each \
             number is within {PULL} errors of its prediction, and the numbers are as the \
             statement says, or as the column *holds* says if the statement does not hold.",
            run.seed
        ),
        "statement | numbers | measured (predicted) | holds | verdict",
        rows,
    )
}

fn row(claim: Claim) -> Row {
    let texts: Vec<String> = claim.numbers.iter().map(ClaimNumber::text).collect();
    let cells = vec![
        claim.said.to_owned(),
        claim.shown,
        texts.join(", "),
        claim.holds.to_owned(),
    ];
    let pulls = claim.numbers.iter().map(|number| number.pull().abs());
    let worst = pulls.fold(0.0, crate::report::worse);
    let mut checks = vec![Check::new("pull", worst, AtMost(PULL)).because(CHANCE)];
    checks.extend(claim.checks);
    Row::new(cells, checks)
}

/// Checks that each number is smaller than the previous one by more than noise.
fn decreasing(numbers: &[ClaimNumber]) -> Check {
    let falls = numbers.windows(2).all(|pair| {
        let error = pair[0].error.hypot(pair[1].error);
        pair[0].value - pair[1].value > PULL * error
    });
    Check::fact(
        "falling",
        falls,
        "each number is below the one before, beyond noise",
    )
}
