//! The outcomes of all cases, as a table with one row for each kind of input.

use super::case::{CaseOutcome, InputKind, Reached};
use crate::report::{Check, ReportSection, Row};
use std::collections::BTreeMap;

/// The numbers of cases with one kind of input, by outcome.
#[derive(Clone, Debug, Default)]
struct CaseTally {
    cases: u64,
    reached: [u64; 4],
    /// The numbers of faults, in the order of the headings.
    faults: [u64; 7],
    seconds: f64,
    peak: u64,
}

/// The numbers of cases, by kind of input.
#[derive(Debug, Default)]
pub(crate) struct Tallies {
    kinds: [CaseTally; InputKind::ALL.len()],
    /// Descriptions of the cases with faults, by the number of the case.
    bad: BTreeMap<u64, String>,
}

/// Maximum number of cases with faults that are listed.
const MOST_TOLD: usize = 60;

impl Tallies {
    pub(crate) fn add(&mut self, number: u64, outcome: &CaseOutcome) {
        let kind = InputKind::of(number);
        if !outcome.faults.is_empty() {
            let words = format!("* case {number}, {kind:?}: {:?}", outcome.faults);
            self.bad.insert(number, words);
        }
        let tally = &mut self.kinds[kind as usize];
        tally.cases += 1;
        tally.reached[outcome.reached as usize] += 1;
        for fault in &outcome.faults {
            tally.faults[*fault as usize] += 1;
        }
        tally.seconds = tally.seconds.max(outcome.seconds);
        tally.peak = tally.peak.max(outcome.peak);
    }

    /// The table, which passes if no case has a fault.
    pub(crate) fn section(&self, seed: u64) -> ReportSection {
        let pairs = InputKind::ALL.iter().zip(&self.kinds);
        let rows = pairs.map(|(kind, tally)| row(*kind, tally));
        let bad: Vec<&str> = self.bad.values().map(String::as_str).collect();
        let told = bad[..bad.len().min(MOST_TOLD)].join("\n");
        ReportSection::new(
            "Hostile input",
            format!(
                "The program reads files that were mutated at random, seed {seed}. Required: each \
                 case gives a result or one clear message, and takes at most 30 s and 1 GB. \
                 Nothing is written that is not a result, and a damaged folder never gives a \
                 different result.{}{told}",
                if bad.is_empty() { "" } else { "\n\n" }
            ),
            "input | cases | refused: syntax | refused: values | accepted | accepted and run | \
             panics | aborts | > 30 s | > 1 GB | wrote other files | bad message | different \
             result | longest time in s | most memory in MB",
            rows,
        )
        .with_checks(vec![Check::none("bad cases", bad.len())])
    }
}

fn row(kind: InputKind, tally: &CaseTally) -> Row {
    let reached = |reached| tally.reached[reached as usize];
    let share = |n: u64| match tally.cases {
        0 => "0".to_owned(),
        cases => format!("{n} ({:.0} %)", 100.0 * n as f64 / cases as f64),
    };
    let mut row = vec![
        format!("{kind:?}").to_lowercase(),
        tally.cases.to_string(),
        share(reached(Reached::Syntax)),
        share(reached(Reached::Values)),
        // A case that the program ran also counts as accepted.
        share(reached(Reached::Sound) + reached(Reached::Ran)),
        share(reached(Reached::Ran)),
    ];
    row.extend(tally.faults.map(|count| count.to_string()));
    row.push(format!("{:.1}", tally.seconds));
    row.push(format!("{:.0}", tally.peak as f64 / 1e6));
    Row::new(row, Vec::new())
}
