//! Measures the seconds of each stage of a run, and defines the content of `timing.json`.

use etendue_store::sealed::json;
use etendue_store::{COMMIT, machine};
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// A measurement of the seconds that each stage takes.
#[derive(Debug)]
pub struct Stopwatch {
    last: Instant,
    seconds: BTreeMap<&'static str, f64>,
}

impl Stopwatch {
    /// Starts the clock.
    pub fn start() -> Self {
        Self {
            last: Instant::now(),
            seconds: BTreeMap::new(),
        }
    }

    /// Ends a stage.
    pub fn lap(&mut self, stage: &'static str) {
        self.seconds
            .insert(stage, self.last.elapsed().as_secs_f64());
        self.last = Instant::now();
    }

    /// The seconds that a stage took.
    pub fn seconds(&self, stage: &str) -> Option<f64> {
        self.seconds.get(stage).copied()
    }

    /// The content of `timing.json`.
    pub fn json(&self, photons: u64) -> Vec<u8> {
        #[derive(Serialize)]
        struct Timing<'a> {
            /// The commit of the program.
            commit: Option<&'static str>,
            /// The command line.
            command: Vec<String>,
            seconds: &'a BTreeMap<&'static str, f64>,
            threads: usize,
            /// Number of emitted photons per second of tracing and transforming.
            photons_per_second: Option<f64>,
            peak_memory_bytes: Option<u64>,
        }
        let words = std::env::args_os().map(|word| word.to_string_lossy().into_owned());
        json(&Timing {
            commit: COMMIT.get().copied().filter(|commit| !commit.is_empty()),
            command: words.collect(),
            seconds: &self.seconds,
            threads: rayon::current_num_threads(),
            photons_per_second: self
                .seconds("trace")
                .map(|seconds| photons as f64 / seconds),
            peak_memory_bytes: machine::peak_memory(),
        })
    }
}
