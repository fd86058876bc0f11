//! Runs one trial: starts a command in a folder, disturbs the command, and then checks the folder.

use super::check::{self, IndexState, NO_HASH};
use super::disk::{FullDisk, Mount, limited};
use super::task::{KillTask, Verb};
use crate::hostile::child;
use crate::hostile::dice::Dice;
use crate::hostile::folder::{self, Folder};
use std::fs;
use std::io;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A disturbance other than a kill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum KillTrouble {
    Nothing,
    TwoWriters,
    FullDisk(FullDisk),
}

/// A kind of finding, whose occurrences are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Finding {
    TwoWriters,
    FullDisk,
    /// The index of the folder belongs to the earlier result (`Before`), is missing (`Between`), or
    /// is new (`After`).
    Before,
    Between,
    After,
    Whole,
    /// A writer was refused because the other writer was writing.
    Refused,
    // The finding `Broken` and all findings listed after `Broken` are faults.
    Broken,
    NoHash,
    Lost,
    /// An undisturbed writer ended with a wrong exit code.
    Exit,
    NextFailed,
    Leftover,
    /// A result that the user has edited was overwritten.
    Overwritten,
}

impl Finding {
    pub(super) const COUNT: usize = 14;

    pub(super) fn is_bad(self) -> bool {
        self as usize >= Self::Broken as usize
    }
}

/// The findings of a trial, each with a text that describes it if it is a fault.
pub(super) type Findings = Vec<(Finding, String)>;

/// The folder in which trials run, and the path of the tested program.
#[derive(Debug)]
pub(super) struct TrialBench<'a> {
    pub(super) program: &'a Path,
    pub(super) at: &'a Path,
}

impl TrialBench<'_> {
    /// Runs a trial in a fresh folder, and then removes this folder.
    pub(super) fn trial(
        &self,
        task: &KillTask,
        trouble: KillTrouble,
        dice: &mut Dice,
    ) -> io::Result<Findings> {
        let place = self.at.join("trial");
        let out = place.join("out");
        fs::create_dir_all(&out)?;
        let mount = match trouble {
            KillTrouble::FullDisk(FullDisk::Tmpfs) => Some(Mount::new(&out, room(task, dice))?),
            _ => None,
        };
        folder::write(&place.join("in"), &task.inputs)?;
        folder::write(&out, &task.before)?;
        let mut findings = Findings::new();
        self.disturbed(task, trouble, dice, &mut findings)?;
        let left = folder::read(&out)?;
        judge(task, &left, "after it", &mut findings);
        let found = if left.get(task.verb.index()) == task.before.get(task.verb.index()) {
            Finding::Before
        } else if left.contains_key(task.verb.index()) {
            Finding::After
        } else {
            Finding::Between
        };
        findings.push((found, String::new()));
        mount.as_ref().map_or(Ok(()), Mount::widen)?;
        self.next(task, &mut findings)?;
        self.edited(task, &mut findings)?;
        drop(mount);
        fs::remove_dir_all(&place)?;
        Ok(findings)
    }

    /// Starts one or two writers, and either kills the first writer at a random moment or
    /// disturbs none.
    fn disturbed(
        &self,
        task: &KillTask,
        trouble: KillTrouble,
        dice: &mut Dice,
        findings: &mut Findings,
    ) -> io::Result<()> {
        let blocks = 1 + dice.length(1000);
        let command = || match trouble {
            KillTrouble::FullDisk(FullDisk::Limit) => limited(self.program, blocks),
            _ => Command::new(self.program),
        };
        let moment = task.takes.mul_f64(1.2 * dice.unit());
        let wait = task.takes.mul_f64(0.5 * dice.unit() * dice.unit());
        let alone = trouble != KillTrouble::Nothing && dice.one_in(2);
        let signal = *dice.pick(&["KILL", "KILL", "KILL", "TERM", "INT"]);
        let mut writers = vec![self.start(command(), task, 2)?];
        let start = Instant::now();
        if trouble == KillTrouble::TwoWriters {
            std::thread::sleep(wait);
            writers.push(self.start(command(), task, 3)?);
        }
        if !alone {
            std::thread::sleep(moment.saturating_sub(start.elapsed()));
            end(&mut writers[0], signal)?;
        }
        let mut codes = Vec::new();
        for writer in &mut writers {
            codes.push(ended(writer)?);
        }
        match trouble {
            KillTrouble::TwoWriters => findings.push((Finding::TwoWriters, String::new())),
            KillTrouble::FullDisk(_) => findings.push((Finding::FullDisk, String::new())),
            KillTrouble::Nothing => (),
        }
        let undisturbed = if alone { &codes[..] } else { &codes[1..] };
        let known = |code: &Option<i32>| matches!(code, Some(0 | 1 | 3 | 4));
        let refused = |code: &Option<i32>| *code == Some(3);
        let all_refused = trouble == KillTrouble::TwoWriters && alone && codes.iter().all(refused);
        if !undisturbed.iter().all(known) || all_refused {
            findings.push((Finding::Exit, format!("exit codes {undisturbed:?}")));
        } else if trouble == KillTrouble::TwoWriters && undisturbed.iter().any(refused) {
            findings.push((Finding::Refused, String::new()));
        }
        Ok(())
    }

    fn start(&self, mut command: Command, task: &KillTask, seed: u64) -> io::Result<Child> {
        command
            .args(task.verb.arguments(seed))
            .current_dir(self.at.join("trial"))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
    }

    /// An undisturbed run must succeed, and afterwards the folder must contain only the result
    /// and the user's files.
    fn next(&self, task: &KillTask, findings: &mut Findings) -> io::Result<()> {
        let place = self.at.join("trial");
        let ended = child::call(self.program, &place, &task.verb.arguments(5), self.at)?;
        if !matches!(ended.code, Some(0 | 1 | 4)) {
            let message = String::from_utf8_lossy(&ended.stderr)
                .trim()
                .replace('\n', " ");
            findings.push((Finding::NextFailed, format!("the next run: {message}")));
            return Ok(());
        }
        let files = folder::read(&place.join("out"))?;
        judge(task, &files, "after the next run", findings);
        let index = files.get(task.verb.index()).cloned().flatten();
        let listed = check::listed(task.verb.index(), &index.unwrap_or_default());
        let listed = listed.unwrap_or_default();
        let own = [task.verb.index(), "timing.json"];
        let belongs = |name: &str| {
            own.contains(&name)
                // The finished points of a killed sweep remain in the folder as separate results,
                // which the next sweep uses.
                || (task.verb == Verb::Sweep && name.starts_with("points/"))
                || task.foreign.contains_key(name)
                || listed.iter().any(|(known, _)| known == name)
        };
        let mut stray = files.iter().filter(|(_, bytes)| bytes.is_some());
        if let Some((name, _)) = stray.find(|(name, _)| !belongs(name)) {
            findings.push((Finding::Leftover, format!("{name} is left over")));
        } else if let Some(name) = files.keys().find(|name| is_unfinished(task, name)) {
            findings.push((Finding::Leftover, format!("{name} is left over")));
        }
        Ok(())
    }

    /// If the user has edited a result, the result is protected: the command is refused and
    /// changes nothing.
    fn edited(&self, task: &KillTask, findings: &mut Findings) -> io::Result<()> {
        let place = self.at.join("trial");
        let out = place.join("out");
        let index = fs::read(out.join(task.verb.index())).unwrap_or_default();
        let listed = check::listed(task.verb.index(), &index).unwrap_or_default();
        let mut theirs = listed.iter().map(|(name, _)| name);
        let Some(name) = theirs.find(|name| !task.foreign.contains_key(*name)) else {
            return Ok(());
        };
        fs::write(out.join(name), "edited")?;
        let before = folder::read(&out)?;
        let ended = child::call(self.program, &place, &task.verb.arguments(6), self.at)?;
        let after = folder::read(&out)?;
        let changed = folder::differences(&before, &after);
        if ended.code != Some(3) || !changed.is_empty() {
            let changed = &changed[..changed.len().min(3)];
            let words = format!("edited {name}: exit {:?}, changed {changed:?}", ended.code);
            findings.push((Finding::Overwritten, words));
        }
        Ok(())
    }
}

/// Checks whether this file is a remnant of a killed writer. Remnants of a killed writer may stay
/// in the folder of a sweep's point, because they are removed when the point is run again.
fn is_unfinished(task: &KillTask, name: &str) -> bool {
    let is_point = task.verb == Verb::Sweep && name.starts_with("points/");
    name.contains(".etendue") && !is_point
}

/// The size of a disk that has space for the existing files and for a random part of the
/// new files.
fn room(task: &KillTask, dice: &mut Dice) -> u64 {
    // Each file and folder occupies whole pages.
    let pages = |bytes: &Option<Vec<u8>>| 1 + bytes.as_ref().map_or(0, Vec::len).div_ceil(4096);
    let there: usize = task.before.values().map(pages).sum();
    let room = 4 + dice.below(there * 6 / 5);
    4096 * (there + room) as u64
}

/// Kills a child process if the process has not ended yet.
fn end(child: &mut Child, signal: &str) -> io::Result<()> {
    if signal == "KILL" {
        return child.kill();
    }
    let mut kill = Command::new("kill");
    kill.args([format!("-{signal}"), child.id().to_string()]);
    kill.stderr(Stdio::null()).status().map(drop)
}

/// Waits for a child process, and returns its exit code, or `None` if the process was killed or
/// has hung.
fn ended(child: &mut Child) -> io::Result<Option<i32>> {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status.code());
        }
        if start.elapsed() > child::LONGEST {
            child.kill()?;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Checks the index of a folder, the files that the index lists, and the user's files.
fn judge(task: &KillTask, files: &Folder, when: &str, findings: &mut Findings) {
    match check::state(files, task.verb.index()) {
        IndexState::Absent => (),
        IndexState::Whole => findings.push((Finding::Whole, String::new())),
        IndexState::Broken(reason) if reason.ends_with(NO_HASH) => {
            findings.push((Finding::NoHash, format!("{when}: {reason}")));
        }
        IndexState::Broken(reason) => findings.push((Finding::Broken, format!("{when}: {reason}"))),
    }
    let mut foreign = task.foreign.iter();
    if let Some((name, _)) = foreign.find(|(name, bytes)| files.get(*name) != Some(bytes)) {
        findings.push((Finding::Lost, format!("{when}: {name} is gone or changed")));
    }
}
