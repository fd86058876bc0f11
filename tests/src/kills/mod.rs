//! Attacks on commands that write results: kills at random moments, two writers at once, and full
//! disks. After every disturbance, a folder must contain a complete result or no result.

mod check;
mod disk;
mod task;
mod trial;

use crate::hostile::child;
use crate::hostile::dice::Dice;
use crate::progress::progress;
use crate::report::{Check, ReportSection, Row};
use disk::FullDisk;
use std::io;
use std::path::PathBuf;
use task::Verb;
use trial::{Finding, KillTrouble, TrialBench};

/// Options of the trials with disturbed commands.
#[derive(Debug, clap::Args)]
pub(crate) struct KillOptions {
    /// Number of trials.
    #[arg(long, default_value_t = 200)]
    count: u64,
    /// Seed of the trials.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// How to simulate a full disk [default: tmpfs, if it can be mounted].
    #[arg(long)]
    full_disk: Option<FullDisk>,
    /// Program to test [default: etendue in the same folder].
    #[arg(long)]
    etendue: Option<PathBuf>,
}

/// How often each finding occurred with each command.
type Counts = [[u64; Finding::COUNT]; Verb::ALL.len()];

/// Runs all trials.
pub(crate) fn kills(options: &KillOptions) -> io::Result<ReportSection> {
    let program = child::program(options.etendue.as_deref())?;
    let place = tempfile::tempdir()?;
    let tasks = task::tasks(&program, place.path())?;
    let disk = options.full_disk.map_or_else(FullDisk::best, Ok)?;
    let troubles = [
        KillTrouble::Nothing,
        KillTrouble::TwoWriters,
        KillTrouble::FullDisk(disk),
    ];
    let bench = TrialBench {
        program: &program,
        at: place.path(),
    };
    let bar = progress(options.count, "trials");
    let mut counts = Counts::default();
    let mut told = Vec::new();
    let all = tasks.iter().flat_map(|task| troubles.map(|t| (task, t)));
    // Consecutive trials have different commands and disturbances, so a few trials cover all of
    // them.
    let all: Vec<_> = all.collect();
    for (number, at) in (0..options.count).zip((0..all.len()).cycle()) {
        let (task, trouble) = all[at * 5 % all.len()];
        let mut dice = Dice::new(options.seed, number);
        for (finding, words) in bench.trial(task, trouble, &mut dice)? {
            counts[task.verb as usize][finding as usize] += 1;
            if finding.is_bad() {
                told.push(format!(
                    "* trial {number}, {:?}, {trouble:?}: {words}",
                    task.verb
                ));
            }
        }
        bar.one();
    }
    bar.end();
    Ok(section(options, &counts, &told))
}

/// Maximum number of faults that are listed.
const MOST_TOLD: usize = 60;

fn section(options: &KillOptions, counts: &Counts, told: &[String]) -> ReportSection {
    let rows = Verb::ALL.iter().zip(counts).map(|(verb, counts)| {
        let ended = [Finding::Before, Finding::Between, Finding::After];
        let trials: u64 = ended.iter().map(|f| counts[*f as usize]).sum();
        let mut row = vec![format!("{verb:?}").to_lowercase(), trials.to_string()];
        row.extend(counts.iter().map(ToString::to_string));
        Row::new(row, Vec::new())
    });
    let mut text = format!(
        "Commands are killed at random moments, started twice at once, or run on full disks. \
        Their folders hold an earlier result and files of the user; seed {}. Required: every \
        index belongs to a whole result, every file of the user stays as it is, and the next run \
        succeeds and leaves nothing behind.",
        options.seed
    );
    if !told.is_empty() {
        text += "\n\n";
        text += &told[..told.len().min(MOST_TOLD)].join("\n");
    }
    ReportSection::new(
        "Kills",
        text,
        "command | trials | two writers | full disk | ended before the index | index gone | ended \
         after the index | whole results | second writer refused | broken results | index without \
         its hash | user files lost | unexpected exits | next run failed | leftovers after next \
         run | edited file overwritten",
        rows,
    )
    .with_checks(vec![Check::none("bad endings", told.len())])
}
