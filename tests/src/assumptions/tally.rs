//! Summary of all trials, with a row for each assumption.

use super::kind::{DARK, UNKNOWN, assumptions};
use super::trial::TrialEnding;
use super::{AssumptionOptions, TriedScene};
use crate::report::Bound::AtLeast;
use crate::report::{self, Check, ReportSection};
use etendue_compare::Verdict;

/// Maximum number of scenes named in a list.
const NAMED: usize = 4;

/// The outcomes of the planes that violate an assumption.
#[derive(Default)]
struct AssumptionRow {
    planes: usize,
    /// Number of planes that violate only the assumption of this row.
    alone: usize,
    speechless: usize,
    skipped: usize,
    panics: usize,
    /// Names of the scenes whose planes failed.
    fails: Vec<String>,
    undecided: usize,
    passes: usize,
    /// Number of planes that photons reach.
    lit: usize,
}

impl AssumptionRow {
    fn new(says: &str, tried: &[TriedScene]) -> Self {
        let mut row = Self::default();
        for (scene, trials) in tried {
            let broken = trials.iter().flatten();
            for trial in broken.filter(|trial| trial.broken.contains(says)) {
                row.planes += 1;
                row.alone += usize::from(trial.ending.is_some());
                row.count(scene, trial.ending.as_ref());
            }
        }
        row
    }

    fn count(&mut self, scene: &str, ending: Option<&TrialEnding>) {
        match ending {
            None => {}
            Some(TrialEnding::Panicked(_)) => self.panics += 1,
            Some(TrialEnding::Speechless) => self.speechless += 1,
            Some(TrialEnding::Skipped) => self.skipped += 1,
            Some(TrialEnding::Judged { verdict, inside }) => {
                self.lit += usize::from(*inside > 0);
                match verdict {
                    Verdict::Fail => self.fails.push(scene.to_owned()),
                    Verdict::Undecided => self.undecided += 1,
                    Verdict::Pass => self.passes += 1,
                }
            }
        }
    }

    fn judged(&self) -> usize {
        self.fails.len() + self.undecided + self.passes
    }

    /// Returns, as text, how many of the judged planes failed, and the names of the first scenes
    /// with failed planes.
    fn caught(&self) -> String {
        let mut named = self.fails.clone();
        named.dedup();
        named.truncate(NAMED);
        match (self.judged(), named.is_empty()) {
            (0, _) => "–".to_owned(),
            (judged, true) => format!("0 of {judged}"),
            (judged, false) => {
                format!("{} of {judged}: {}", self.fails.len(), named.join(", "))
            }
        }
    }
}

/// The table, with checks that the violation of each tested assumption is detected.
pub(super) fn section(
    options: &AssumptionOptions,
    random: &[TriedScene],
    kept: &[TriedScene],
) -> ReportSection {
    let mut rows = Vec::new();
    let (mut skipped, mut panics) = (0, 0);
    for says in assumptions() {
        let [row, other] = [random, kept].map(|tried| AssumptionRow::new(says, tried));
        skipped += row.skipped + other.skipped;
        panics += row.panics + other.panics;
        let lit = row.lit + other.lit;
        let judged = row.judged() + other.judged();
        let fails = (row.fails.len() + other.fails.len()) as f64;
        let planes = row.planes + other.planes;
        if says == UNKNOWN && planes == 0 {
            continue;
        }
        let unnamed = Check::none("planes", planes);
        let caught = Check::new("caught", fails, AtLeast(1.0))
            .because("at least one judged plane must be rejected");
        let dark = Check::none("lit", lit);
        let checks = [
            (says == UNKNOWN).then_some(unnamed),
            (says != DARK && judged > 0).then_some(caught),
            (says == DARK).then_some(dark),
        ];
        let checks = checks.into_iter().flatten().collect();
        let mut cells = vec![says.to_owned()];
        cells.extend([row.planes, row.alone, row.speechless].map(|count| count.to_string()));
        let [first, second] = if says == DARK {
            [format!("{lit} of {judged} have photons"), "–".to_owned()]
        } else {
            [row.caught(), other.caught()]
        };
        cells.push(first);
        cells.extend([row.undecided, row.passes].map(|count| count.to_string()));
        cells.push(second);
        rows.push(report::Row::new(cells, checks));
    }
    let drawn = random.iter().filter(|(_, trials)| trials.is_some()).count();
    ReportSection::new(
        format!("Assumptions, seed {}", options.seed),
        format!(
            "Planes that break an assumption of theory are predicted all the same and compared \
             with photons. There are {drawn} random scenes and {} scenes of the repository, with \
             {} photons for each plane. {skipped} planes were left out, because their predictions \
             take more than a minute, and {panics} panicked. Required: photons reject at least one \
             prediction for each assumption that is tried, no prediction panics, and no photon \
             arrives where theory says that it is dark.",
            kept.len(),
            options.photons
        ),
        "assumption | planes that break it | planes that break only it | no theory to try | \
         rejected, in scenes | undecided | passed all the same | rejected, scenes of the \
         repository",
        rows,
    )
    .with_checks(vec![Check::none("panics", panics)])
}
