//! Runs a scene with the program, as a user does, in a child process with a time limit.

use crate::hostile::child::{self, Ended, Limit};
use crate::hostile::stages::words;
use etendue_scene::SceneFile;
use ron::extensions::Extensions;
use ron::ser::PrettyConfig;
use serde_json::Value;
use std::fs;
use std::io;
use std::path::PathBuf;
use std::time::Duration;

/// The name of the scene file in the folder.
const SCENE: &str = "scene.ron";
/// Maximum wall-clock time of a run, as a multiple of the limit on processor time.
const LONGER: u32 = 10;
/// The exit code of a panic.
const PANIC: i32 = 101;
/// The exit codes for refused input, and for scenes that cannot be run.
const REFUSED: [i32; 2] = [2, 3];

/// The folders and limits for running scenes.
pub(super) struct Runner {
    pub(super) program: PathBuf,
    /// The folder of the scene file, pictures and meshes.
    pub(super) folder: PathBuf,
    /// A folder for results.
    pub(super) scratch: PathBuf,
    /// Limit on the processor time of a run; unlike wall-clock time, it does not depend on the
    /// load of the machine.
    pub(super) limit: Duration,
}

/// The outcome of a run.
pub(super) enum RunEnding {
    /// The run completed, with a verdict on each plane.
    Done(Vec<PlaneSummary>),
    /// The program refused the scene, for the given reason.
    Refused(String),
    /// The program panicked, with the given message.
    Panic(String),
    /// The run exceeded the time limit.
    Hang,
    /// The process was ended by a signal, or with an undefined exit code.
    Killed(String),
}

/// The summary that a run gives for one plane.
pub(super) struct PlaneSummary {
    pub(super) name: String,
    pub(super) class: String,
    pub(super) verdict: String,
    /// The p-values of the exact prediction and, if there is one, of the affine chain.
    pub(super) p: [Option<f64>; 2],
    /// Three errors: the relative error of the prediction, the limit of this error due to noise,
    /// and the stated error of the prediction.
    pub(super) errors: [Option<f64>; 3],
}

impl PlaneSummary {
    fn new(plane: &Value) -> Self {
        let text = |key: &str| plane[key].as_str().unwrap_or_default().to_owned();
        let number = |key: &str| plane[key].as_f64();
        Self {
            name: text("name"),
            class: text("class"),
            verdict: text("verdict"),
            p: [number("p_value"), plane["first_order"]["p_value"].as_f64()],
            errors: ["relative_error", "noise_limit", "quadrature_error"].map(number),
        }
    }

    pub(super) fn fails(&self) -> bool {
        self.verdict == "fail"
    }

    pub(super) fn is_undecided(&self) -> bool {
        self.verdict == "undecided"
    }

    /// Checks whether a measurement with the other tracer (photons or backward rays) replaced
    /// theory at this plane.
    pub(super) fn is_reference(&self) -> bool {
        self.class == "reference"
    }
}

/// A scene file as its text.
pub(crate) fn text(file: &SceneFile) -> io::Result<String> {
    let pretty = PrettyConfig::new().depth_limit(3);
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .to_string_pretty(file, pretty)
        .map_err(io::Error::other)
}

impl Runner {
    /// Runs a scene with the given seed of photons or of backward rays.
    pub(super) fn run(&self, file: &SceneFile, seed: u64, backward: bool) -> io::Result<RunEnding> {
        fs::write(self.folder.join(SCENE), text(file)?)?;
        let out = self.scratch.join("out");
        if out.exists() {
            fs::remove_dir_all(&out)?;
        }
        let method = if backward { "backward" } else { "photons" };
        let command = format!("run {SCENE} --quiet --threads 1 --seed {seed} --method {method}");
        let mut words = words(&command);
        words.extend(["--out".to_owned(), out.display().to_string()]);
        let limit = Limit {
            clock: LONGER * self.limit,
            work: self.limit,
        };
        let ended = child::call_within(limit, &self.program, &self.folder, &words, &self.scratch)?;
        if let Some(ending) = early(&ended) {
            return Ok(ending);
        }
        let summary = fs::read(out.join("summary.json"))?;
        let summary: Value = serde_json::from_slice(&summary).map_err(io::Error::other)?;
        let planes = summary["planes"].as_array().map(Vec::as_slice);
        let planes = planes.unwrap_or_default().iter();
        Ok(RunEnding::Done(planes.map(PlaneSummary::new).collect()))
    }
}

/// The outcome of a run without a result.
fn early(ended: &Ended) -> Option<RunEnding> {
    let stderr = String::from_utf8_lossy(&ended.stderr);
    if ended.hung {
        return Some(RunEnding::Hang);
    }
    match ended.code {
        Some(PANIC) => {
            let at = stderr.find("panicked").unwrap_or(0);
            let words = stderr[at..].lines().take(3);
            Some(RunEnding::Panic(words.collect::<Vec<_>>().join(" ")))
        }
        Some(code) if REFUSED.contains(&code) => Some(RunEnding::Refused(reason(&stderr))),
        Some(0 | 1 | 4) => None,
        code => Some(RunEnding::Killed(format!(
            "code {code:?}, signal {:?}, {} MB",
            ended.signal,
            ended.peak >> 20
        ))),
    }
}

/// Returns the reason for a refusal, without numbers and names, so that equal reasons can be
/// counted.
fn reason(stderr: &str) -> String {
    let lines = stderr.lines().filter(|line| {
        let line = line.trim_start();
        !line.is_empty() && !line.starts_with("warning") && !line.starts_with("note")
    });
    let words: Vec<&str> = lines.take(3).map(str::trim).collect();
    let text = words.join(" ");
    let (mut plain, mut quoted, mut depth) = (String::new(), false, 0_usize);
    for c in text.chars() {
        match c {
            '"' => quoted = !quoted,
            _ if quoted => {}
            // Parentheses enclose details.
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ if depth > 0 => {}
            '0'..='9' => {
                if !plain.ends_with('N') {
                    plain.push('N');
                }
            }
            '.' | '-' | '+' | 'e' if plain.ends_with('N') => {}
            _ => plain.push(c),
        }
    }
    plain.chars().take(300).collect()
}
