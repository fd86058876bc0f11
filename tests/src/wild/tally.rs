//! The outcomes of all random scenes, as a table.

use super::judge::{Culprit, JudgedScene, SceneTrouble};
use crate::report::{Check, ReportSection, Row};
use std::collections::BTreeMap;

/// Counts over scenes.
#[derive(Default)]
pub(super) struct Tally {
    scenes: usize,
    judged: usize,
    refused: BTreeMap<String, Vec<u64>>,
    verdicts: BTreeMap<String, usize>,
    runs: usize,
    fails: usize,
    chance: usize,
    /// Indices of scenes that could not be generated.
    undrawn: Vec<u64>,
    panics: Vec<u64>,
    hangs: Vec<u64>,
    killed: Vec<u64>,
    wrong: BTreeMap<Culprit, Vec<u64>>,
}

/// False rejection rate over all scenes of one search.
const ALPHA: f64 = 0.01;

impl Tally {
    pub(super) fn undrawn(&mut self, number: u64) {
        self.scenes += 1;
        self.undrawn.push(number);
    }

    pub(super) fn add(&mut self, number: u64, judged: &JudgedScene) {
        self.scenes += 1;
        if let Some(why) = &judged.refused {
            self.refused.entry(why.clone()).or_default().push(number);
        } else {
            self.judged += 1;
        }
        for verdict in &judged.verdicts {
            *self.verdicts.entry(verdict.clone()).or_default() += 1;
        }
        self.runs += judged.runs;
        self.fails += judged.fails;
        self.chance += judged.chance;
        for (trouble, _) in &judged.troubles {
            let list = match trouble {
                SceneTrouble::Panic => &mut self.panics,
                SceneTrouble::Hang => &mut self.hangs,
                SceneTrouble::Killed => &mut self.killed,
                SceneTrouble::Wrong { culprit, .. } => self.wrong.entry(*culprit).or_default(),
            };
            if list.last() != Some(&number) {
                list.push(number);
            }
        }
    }

    pub(super) fn section(&self, seed: u64) -> ReportSection {
        let mut rows = Vec::new();
        let mut row = |what: String, count: usize, which: &[u64]| {
            let shown: Vec<String> = which.iter().take(20).map(u64::to_string).collect();
            let cells = vec![what, count.to_string(), shown.join(", ")];
            rows.push(Row::new(cells, Vec::new()));
        };
        row("scenes".into(), self.scenes, &[]);
        let undrawn = "scenes that could not be drawn";
        row(undrawn.into(), self.undrawn.len(), &self.undrawn);
        for (why, which) in &self.refused {
            row(format!("refused: {why}"), which.len(), which);
        }
        row("scenes that were judged".into(), self.judged, &[]);
        for (verdict, count) in &self.verdicts {
            row(format!("planes, {verdict}"), *count, &[]);
        }
        row("runs with a verdict".into(), self.runs, &[]);
        let expected = ALPHA * self.runs as f64;
        let fails = format!("runs of these that fail ({expected:.1} expected by chance)");
        row(fails, self.fails, &[]);
        row("failures that do not repeat".into(), self.chance, &[]);
        let checks = vec![
            Check::none("panics", self.panics.len()),
            Check::none("hangs", self.hangs.len()),
            Check::none("killed", self.killed.len()),
            Check::none("wrong", self.wrong.len()),
        ];
        for (what, which) in [
            ("**panics**", &self.panics),
            ("**hangs**", &self.hangs),
            ("**killed**", &self.killed),
        ] {
            row(what.into(), which.len(), which);
        }
        for (culprit, which) in &self.wrong {
            let what = format!("**wrong**, failures that repeat: {}", culprit.says());
            row(what, which.len(), which);
        }
        ReportSection::new(
            format!("Wild scenes, seed {seed}"),
            "Scenes are drawn from the whole vocabulary of scene files. A scene that fails is run \
             with two other seeds. Required: no scene panics or hangs, and no plane fails again \
             with the other seeds.",
            "what | count | scenes",
            rows,
        )
        .with_checks(checks)
    }
}
