//! One case of an attack: its input, the commands that are run on this input, and the faults in
//! their outcome.

use super::child::{self, Ended, LARGEST, LONGEST};
use super::folder::{self, Folder};
use std::fs;
use std::io;
use std::os::unix::fs::symlink;
use std::path::Path;

/// A kind of input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum InputKind {
    Scene,
    Mesh,
    Picture,
    Part,
    Prediction,
    World,
}

impl InputKind {
    pub(crate) const ALL: [Self; 6] = [
        Self::Scene,
        Self::Mesh,
        Self::Picture,
        Self::Part,
        Self::Prediction,
        Self::World,
    ];

    /// The kind of input of a case; 40 % of all cases have scene files as input.
    pub(crate) fn of(case: u64) -> Self {
        match case % 20 {
            0..8 => Self::Scene,
            8..11 => Self::Mesh,
            11..14 => Self::Picture,
            14..16 => Self::Part,
            16..18 => Self::Prediction,
            _ => Self::World,
        }
    }
}

/// An attack: the input, and the commands run on it.
#[derive(Debug, Default)]
pub(crate) struct Attack {
    /// The input files, with the content that they have before the command runs.
    pub(crate) files: Folder,
    pub(crate) arguments: Vec<String>,
    /// A second command, which is run on the input if the first command accepts it.
    pub(crate) then: Option<Vec<String>>,
    /// The number of files that the second command may open at once; `None` if all it needs.
    pub(crate) open_files: Option<usize>,
    /// A link in the input folder, and the path to which it leads.
    pub(crate) link: Option<[&'static str; 2]>,
    /// The files before the mutation, if a run on these files may also be slow; a slow run on
    /// mutated files is then not a fault.
    pub(crate) sound: Option<Folder>,
    /// The summary that is expected if the input is accepted; `None` if the summary may differ.
    pub(crate) summary: Option<Vec<u8>>,
}

/// A fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HostileFault {
    /// A panic, or an undefined exit code.
    Panic,
    /// The process ended by a signal, or for lack of memory.
    Abort,
    Slow,
    Large,
    /// The process wrote a file outside the folder of results, or wrote any file although its
    /// exit code is 2.
    Wrote,
    /// The process wrote no error message, or a message that is long or has control characters, or
    /// a script with a line from an argument.
    Message,
    /// The process accepted a damaged input, and its result differs from the result for the valid
    /// input.
    Changed,
}

/// The stage that the program reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reached {
    Syntax,
    Values,
    Sound,
    Ran,
}

/// The outcome of a case.
#[derive(Debug)]
pub(crate) struct CaseOutcome {
    pub(crate) reached: Reached,
    pub(crate) faults: Vec<HostileFault>,
    pub(crate) seconds: f64,
    pub(crate) peak: u64,
    /// The command lines of a case and their outcomes, for inspection.
    pub(crate) log: String,
}

/// A word that some arguments contain at the beginning of a line.
pub(crate) const INJECTED: &str = "INJECTED";

/// Name of the input folder, which is inside the folder of the case.
const WORK: &str = "work";
/// Name of the only folder for results, which is inside the input folder.
pub(crate) const OUT: &str = "out";

/// A folder and a file beside the input folder, to which links lead.
const KEPT: &str = "elsewhere/kept";

/// Runs a case in a fresh folder within `at`, and then removes the fresh folder.
pub(crate) fn run(program: &Path, attack: &Attack, at: &Path) -> io::Result<CaseOutcome> {
    let place = at.join("case");
    let work = place.join(WORK);
    folder::write(&work, &attack.files)?;
    folder::write(&place, &folder::of([(KEPT, b"kept".to_vec())]))?;
    if let Some([name, target]) = attack.link {
        let link = work.join(name);
        fs::create_dir_all(link.parent().unwrap_or(&work))?;
        symlink(target, link)?;
    }
    let before = folder::read(&place)?;
    let mut outcome = CaseOutcome {
        reached: Reached::Values,
        faults: Vec::new(),
        seconds: 0.0,
        peak: 0,
        log: String::new(),
    };
    let ended = step(
        program,
        attack,
        &attack.arguments,
        (at, &before),
        &mut outcome,
    )?;
    if matches!(ended.code, Some(0 | 1 | 4)) {
        outcome.reached = Reached::Sound;
        if let Some(then) = &attack.then
            && is_small(&ended.stdout)
        {
            outcome.reached = Reached::Ran;
            step(program, attack, then, (at, &before), &mut outcome)?;
            if outcome.faults.contains(&HostileFault::Slow) && is_slow(program, attack, then, at)? {
                outcome.faults.retain(|fault| *fault != HostileFault::Slow);
            }
        }
        if let Some(summary) = &attack.summary
            && fs::read(work.join(OUT).join("summary.json")).ok().as_ref() != Some(summary)
        {
            outcome.faults.push(HostileFault::Changed);
        }
    } else if is_syntax(&ended.stderr) {
        outcome.reached = Reached::Syntax;
    }
    fs::remove_dir_all(&place)?;
    Ok(outcome)
}

/// Runs one command of a case and records the faults in its outcome.
fn step(
    program: &Path,
    attack: &Attack,
    arguments: &[String],
    (at, before): (&Path, &Folder),
    outcome: &mut CaseOutcome,
) -> io::Result<Ended> {
    let place = at.join("case");
    let files = attack
        .open_files
        .filter(|_| attack.then.as_deref() == Some(arguments));
    let work = place.join(WORK);
    let ended = match files {
        None => child::call(program, &work, arguments, at)?,
        Some(files) => {
            let script = format!("ulimit -n {files}; exec \"$0\" \"$@\"");
            let program = program.to_string_lossy().into_owned();
            let line = [&["-c".to_owned(), script, program], arguments].concat();
            child::call(Path::new("sh"), &work, &line, at)?
        }
    };
    let mut faults = faults(&ended);
    let mut wrong = wrote(before.clone(), arguments, &ended, &place)?;
    if !wrong.is_empty() {
        faults.push(HostileFault::Wrote);
        wrong.insert(0, "  changed on disk:".into());
    }
    outcome.seconds = outcome.seconds.max(ended.seconds);
    outcome.peak = outcome.peak.max(ended.peak);
    let message = String::from_utf8_lossy(&ended.stderr);
    let message: String = message.chars().take(4000).collect();
    outcome.log += &format!(
        "etendue {}\n  exit {:?}, signal {:?}, {:.2} s, {:.0} MB, faults {faults:?}\n{}\n\
         {message}\n",
        arguments.join(" "),
        ended.code,
        ended.signal,
        ended.seconds,
        ended.peak as f64 / 1e6,
        wrong.join(" "),
    );
    outcome.faults.extend(faults);
    Ok(ended)
}

/// Checks whether a run on the unmutated input also takes a large part of the time limit.
fn is_slow(program: &Path, attack: &Attack, then: &[String], at: &Path) -> io::Result<bool> {
    let Some(sound) = &attack.sound else {
        return Ok(false);
    };
    let place = at.join("sound");
    folder::write(&place, sound)?;
    let ended = child::call(program, &place, then, at)?;
    fs::remove_dir_all(&place)?;
    Ok(ended.seconds > LONGEST.as_secs_f64() / 3.0)
}

/// The faults that the exit code, message, time and memory of the process show.
fn faults(ended: &Ended) -> Vec<HostileFault> {
    let message = String::from_utf8_lossy(&ended.stderr);
    let slow = ended.hung || ended.seconds > LONGEST.as_secs_f64();
    let large = ended.peak > LARGEST;
    let panicked = message.contains("panicked");
    // If this test killed the process, the process does not count as aborted.
    let aborted = ended.signal.is_some() && !slow && !large;
    let aborted = aborted || message.contains("memory allocation of");
    let known = matches!(ended.code, None | Some(0..=4));
    let refused = matches!(ended.code, Some(2 | 3)) && !panicked && !aborted;
    let control = |c: char| c.is_control() && c != '\n';
    let script = String::from_utf8_lossy(&ended.stdout);
    let injected = script.lines().any(|line| line.starts_with(INJECTED));
    let unfit = message.trim().is_empty()
        || message.len() > 8192
        || message.contains(control)
        || std::str::from_utf8(&ended.stderr).is_err();
    [
        (HostileFault::Panic, panicked || !known),
        (HostileFault::Abort, aborted),
        (HostileFault::Slow, slow),
        (HostileFault::Large, large),
        (HostileFault::Message, injected || refused && unfit),
    ]
    .into_iter()
    .filter_map(|(fault, is)| is.then_some(fault))
    .collect()
}

/// The names of files that the command has changed although it must not change them. A
/// command may change only results, and only if it writes results and accepts the input.
fn wrote(
    mut expected: Folder,
    arguments: &[String],
    ended: &Ended,
    place: &Path,
) -> io::Result<Vec<String>> {
    let mut found = folder::read(place)?;
    let out = format!("{WORK}/{OUT}");
    let reads = arguments.first().is_some_and(|command| command == "check");
    if ended.code != Some(2) && !reads {
        let below = format!("{out}/");
        for folder in [&mut found, &mut expected] {
            folder.retain(|name, _| *name != out && !name.starts_with(&below));
        }
    }
    let names = folder::differences(&expected, &found);
    Ok(names.into_iter().map(str::to_owned).collect())
}

/// Checks whether the message gives the position of the fault in the text.
fn is_syntax(stderr: &[u8]) -> bool {
    let message = String::from_utf8_lossy(stderr);
    message.contains(": line ") && message.contains(", column ")
}

/// Maximum number of frequencies of a scene that is run. If a scene is slow only because of its
/// size, slowness is not a fault.
const MOST_FREQUENCIES: u64 = 200_000;

/// Checks whether the scene has few enough frequencies to be run. The output of `check` states
/// azimuths x rho x nu for each plane.
fn is_small(checked: &[u8]) -> bool {
    let text = String::from_utf8_lossy(checked);
    let planes = text.lines().filter(|line| line.contains("  measured at "));
    let count = |line: &str| {
        let words = line.split_whitespace().take(9);
        let numbers = words.filter_map(|word| word.parse::<u64>().ok());
        numbers.fold(1, u64::saturating_mul)
    };
    planes.map(count).fold(0, u64::saturating_add) <= MOST_FREQUENCIES
}
