//! The program as a child process, with a time limit and a record of its peak memory.

use std::fs::{self, File};
use std::io;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Time after which a child counts as hung.
pub(crate) const LONGEST: Duration = Duration::from_secs(30);

/// Memory, in bytes. A child that uses more memory than this, for any input, uses too much.
pub(crate) const LARGEST: u64 = 1 << 30;

/// Memory at which a child is killed to protect the machine, bytes.
const DANGEROUS: u64 = 4 << 30;

/// The limits of processor time and wall-clock time for a child process.
#[derive(Clone, Copy)]
pub(crate) struct Limit {
    /// Wall-clock time.
    pub(crate) clock: Duration,
    /// Processor time, which does not depend on the load of the machine.
    pub(crate) work: Duration,
}

/// The outcome of a child process.
#[derive(Debug)]
pub(crate) struct Ended {
    /// The exit code; `None` if a signal ended it.
    pub(crate) code: Option<i32>,
    pub(crate) signal: Option<i32>,
    /// Whether the child was killed because it took too long.
    pub(crate) hung: bool,
    pub(crate) seconds: f64,
    /// The peak memory observed, bytes.
    pub(crate) peak: u64,
    pub(crate) stdout: Vec<u8>,
    pub(crate) stderr: Vec<u8>,
}

/// The path of the program that is attacked. If no path is given, the program is `etendue`
/// in the folder of this program.
pub(crate) fn program(given: Option<&Path>) -> io::Result<PathBuf> {
    let path = match given {
        Some(path) => path.to_owned(),
        None => std::env::current_exe()?.with_file_name("etendue"),
    };
    // The path is absolute because the children run in other folders.
    path.canonicalize().map_err(|error| {
        let shown = path.display();
        io::Error::other(format!(
            "{shown}: {error}; build it, or name it by --etendue"
        ))
    })
}

/// Runs `program` in `folder`, with its output in files in `scratch`, until it ends or takes too
/// long.
pub(crate) fn call(
    program: &Path,
    folder: &Path,
    arguments: &[String],
    scratch: &Path,
) -> io::Result<Ended> {
    let limit = Limit {
        clock: LONGEST,
        work: LONGEST,
    };
    call_within(limit, program, folder, arguments, scratch)
}

/// Runs a child process as [`call`] does, but with the given time limit.
pub(crate) fn call_within(
    limit: Limit,
    program: &Path,
    folder: &Path,
    arguments: &[String],
    scratch: &Path,
) -> io::Result<Ended> {
    let [out, err] = ["stdout", "stderr"].map(|name| scratch.join(name));
    let start = Instant::now();
    let mut child = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .env_remove("RUST_BACKTRACE")
        .stdin(Stdio::null())
        .stdout(File::create(&out)?)
        .stderr(File::create(&err)?)
        .spawn()?;
    let (peak, hung) = watch(&mut child, start, limit)?;
    let status = child.wait()?;
    Ok(Ended {
        code: status.code(),
        signal: status.signal(),
        hung,
        seconds: start.elapsed().as_secs_f64(),
        peak,
        stdout: fs::read(&out)?,
        stderr: fs::read(&err)?,
    })
}

/// Waits until the child process ends, or kills the process at a limit. Returns the peak memory of
/// the process, and whether the process took too long.
fn watch(child: &mut Child, start: Instant, limit: Limit) -> io::Result<(u64, bool)> {
    let status = format!("/proc/{}/status", child.id());
    let stat = format!("/proc/{}/stat", child.id());
    let mut peak = 0;
    loop {
        // A zombie process has no memory statistics.
        if let Some(now) = fs::read_to_string(&status).ok().and_then(|s| peak_of(&s)) {
            peak = peak.max(now);
        }
        if child.try_wait()?.is_some() {
            return Ok((peak, false));
        }
        let worked = fs::read_to_string(&stat).ok().and_then(|s| work_of(&s));
        let hung = start.elapsed() > limit.clock || worked > Some(limit.work);
        if hung || peak > DANGEROUS {
            child.kill()?;
            return Ok((peak, hung));
        }
        // Most child processes end within a few milliseconds.
        let early = start.elapsed() < Duration::from_millis(20);
        std::thread::sleep(Duration::from_millis(if early { 1 } else { 5 }));
    }
}

fn peak_of(status: &str) -> Option<u64> {
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes * 1024)
}

/// The processor time of a process, in user and kernel mode together.
pub(crate) fn work_of(stat: &str) -> Option<Duration> {
    // In this line of /proc, the program name in parentheses may contain spaces.
    let (_, fields) = stat.rsplit_once(')')?;
    let ticks = fields.split_whitespace().skip(11).take(2);
    let ticks: u64 = ticks.filter_map(|field| field.parse::<u64>().ok()).sum();
    // On any machine, Linux states processor times in hundredths of a second.
    Some(Duration::from_millis(10 * ticks))
}
