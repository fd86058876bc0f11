//! Attacks the program from outside. The program runs as a child process, and is given mutated
//! input of every kind.
//!
//! A case is a function of the seed and the number of the case, so that each case can be repeated
//! alone.

mod bytes;
mod case;
pub(crate) mod child;
pub(crate) mod dice;
pub(crate) mod folder;
#[cfg(test)]
mod fuzz;
pub(crate) mod index;
mod meshes;
mod npz;
mod pictures;
mod scenes;
pub(crate) mod stages;
mod table;
mod text;
mod worlds;

use crate::progress::{CountedProgress, progress};
use crate::report::ReportSection;
use case::{Attack, CaseOutcome, InputKind};
use dice::Dice;
use std::fs;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use table::Tallies;

/// Options of the attack on the program.
#[derive(Debug, clap::Args)]
pub(crate) struct HostileOptions {
    /// Number of cases.
    #[arg(long, default_value_t = 20_000)]
    count: u64,
    /// Seed of the cases.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Run only this case, and keep it whatever its outcome.
    #[arg(long)]
    case: Option<u64>,
    /// Only run `check` on scenes, without tracing them.
    #[arg(long)]
    quick: bool,
    /// Number of cases that run in parallel [default: one for each core].
    #[arg(long)]
    threads: Option<usize>,
    /// Folder for the inputs and command lines of cases with a fault.
    #[arg(long, default_value = "target/hostile")]
    keep: PathBuf,
    /// Program to attack [default: etendue in the same folder].
    #[arg(long)]
    etendue: Option<PathBuf>,
}

/// The valid inputs from which cases are derived.
struct Seeds {
    scenes: Vec<String>,
    meshes: [meshes::Meshes; 2],
    pictures: [Vec<Vec<u8>>; 2],
    stages: Vec<stages::Seed>,
}

impl Seeds {
    fn new(program: &Path, at: &Path) -> io::Result<Self> {
        Ok(Self {
            scenes: scenes::seeds()?,
            meshes: meshes::seeds().map_err(|fault| io::Error::other(fault.to_string()))?,
            pictures: pictures::seeds()?,
            stages: stages::seeds(program, at)?,
        })
    }

    fn attack(&self, seed: u64, case: u64) -> io::Result<Attack> {
        let mut dice = Dice::new(seed, case);
        Ok(match InputKind::of(case) {
            InputKind::Scene => scenes::attack(&self.scenes, &mut dice),
            InputKind::Mesh => meshes::attack(&self.meshes, &mut dice),
            InputKind::Picture => pictures::attack(&self.pictures, &mut dice),
            InputKind::Part => stages::part(&self.stages, &mut dice)?,
            InputKind::Prediction => stages::prediction(&self.stages, &mut dice)?,
            InputKind::World => worlds::attack(&mut dice),
        })
    }
}

/// Runs all cases.
pub(crate) fn hostile(options: &HostileOptions) -> io::Result<ReportSection> {
    let program = child::program(options.etendue.as_deref())?;
    let place = tempfile::tempdir()?;
    let seeds = Seeds::new(&program, place.path())?;
    let cases = match options.case {
        Some(case) => case..case + 1,
        None => 0..options.count,
    };
    let bar = progress(cases.end - cases.start, "cases");
    let outcomes = on_threads(options.threads, cases, &bar, |thread, number| {
        let at = place.path().join(thread.to_string());
        fs::create_dir_all(&at)?;
        let mut attack = seeds.attack(options.seed, number)?;
        attack.then = attack.then.filter(|_| !options.quick);
        let mut outcome = case::run(&program, &attack, &at)?;
        if !outcome.faults.is_empty() || options.case.is_some() {
            keep(options, number, &attack, &outcome)?;
        }
        // Logs of twenty thousand cases would take much memory.
        outcome.log = String::new();
        Ok(outcome)
    })?;
    let mut tallies = Tallies::default();
    for (number, outcome) in &outcomes {
        tallies.add(*number, outcome);
    }
    Ok(tallies.section(options.seed))
}

/// Returns `one(thread, number)` for each of the numbers, in order, computed on the given number of
/// threads, or one for each core. The bar counts the numbers.
pub(crate) fn on_threads<T: Send>(
    threads: Option<usize>,
    numbers: Range<u64>,
    bar: &CountedProgress,
    one: impl Fn(usize, u64) -> io::Result<T> + Sync,
) -> io::Result<Vec<(u64, T)>> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicU64::new(numbers.start);
    let worker = |thread: usize| -> io::Result<Vec<(u64, T)>> {
        let mut found = Vec::new();
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= numbers.end {
                return Ok(found);
            }
            found.push((number, one(thread, number)?));
            bar.one();
        }
    };
    let worker = &worker;
    let mut all = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.unwrap_or(cores).max(1))
            .map(|i| scope.spawn(move || worker(i)))
            .collect();
        let joined = workers.into_iter().map(|worker| {
            let joined = worker.join();
            joined.unwrap_or_else(|_| Err(io::Error::other("a thread has panicked")))
        });
        let all: io::Result<Vec<Vec<_>>> = joined.collect();
        all.map(|all| all.into_iter().flatten().collect::<Vec<_>>())
    })?;
    bar.end();
    all.sort_by_key(|(number, _)| *number);
    Ok(all)
}

/// Saves the input and the outcome of a case.
fn keep(
    options: &HostileOptions,
    number: u64,
    attack: &Attack,
    outcome: &CaseOutcome,
) -> io::Result<()> {
    let at = options.keep.join(format!("{}-{number}", options.seed));
    if at.exists() {
        fs::remove_dir_all(&at)?;
    }
    folder::write(&at.join("work"), &attack.files)?;
    let again = format!(
        "etendue-validation hostile --seed {} --case {number}\n{:?}\n\n{}",
        options.seed, outcome.faults, outcome.log
    );
    fs::write(at.join("case.txt"), again)
}
