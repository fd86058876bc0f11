//! A run that several processes measure, each of which has its own memory: one leads and hands out batches as others ask for them.
//!
//! What goes between them is bytes, and batches are told by their numbers: so the result has the same bits however many processes
//! there are, and whoever is faster. A process that leads measures as well.

use crate::args::{Cli, Command, RunArgs};
use crate::failure::Failure;
use crate::job::{Job, Options};
use crate::results::stored::VERSION;
use crate::threads::on_threads;
use crate::{ended, interrupt, run};
use clap::Parser;
use etendue_field::PhotonSource;
use etendue_spectrum::{Batch, Measurement, Watch, measure_watched};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

/// Processes that work together, by whatever carries bytes between them. Number 0 leads.
pub trait Crew: Sync {
    /// The number of this process.
    fn number(&self) -> usize;

    /// How many there are, this one included.
    fn count(&self) -> usize;

    /// Sends bytes to a process.
    ///
    /// # Errors
    /// In words, when they cannot be sent.
    fn send(&self, to: usize, bytes: &[u8]) -> Result<(), String>;

    /// Waits for bytes, from any process; tells whose they are.
    ///
    /// # Errors
    /// In words, when nothing can be received.
    fn receive(&self) -> Result<(usize, Vec<u8>), String>;
}

/// What a process says to the one that leads. An answer is the numbers of batches to measure; none ends the work.
#[derive(Debug, Serialize, Deserialize)]
enum Said {
    /// It has the scene with this key, and measures so many batches at a time.
    Ready { key: String, abreast: usize },
    /// What follows these words are the batches of these numbers, each of so many bytes.
    Done { batches: Vec<(u32, usize)> },
    /// It cannot measure.
    Failed { message: String },
}

/// What both sides must have in common: otherwise they would measure different things.
fn key(job: &Job) -> String {
    format!("{VERSION} {} {}", job.scene().hash(), job.scene().run.seed)
}

/// What a command line comes to in a crew; returns the exit code. Only `etendue run` is for many.
pub fn in_crew(line: impl IntoIterator<Item = OsString>, crew: &dyn Crew) -> u8 {
    let leads = crew.number() == 0;
    let args = match Cli::try_parse_from(line) {
        Ok(cli) => match cli.command {
            Command::Run(args) if args.target_error.is_none() => args,
            _ => {
                let message = "only `run`, without --target-error, is for several processes";
                return ended(Err(Failure::bad_input(message)), !leads);
            }
        },
        Err(error) => {
            // Whoever sees the terminal says it.
            if leads {
                let _ = error.print();
            }
            return u8::try_from(error.exit_code()).unwrap_or(2);
        }
    };
    if !leads {
        follow(&args, crew);
        return 0;
    }
    let led = Led {
        crew,
        dismissed: Mutex::default(),
    };
    let outcome = interrupt::install().and_then(|()| run::run_with(&args, Some(&led)));
    // Those who still wait for an answer, because there was nothing to measure or something failed.
    let dismissed = led.dismiss_all();
    ended(outcome.and_then(|code| dismissed.map(|()| code)), false)
}

/// The processes that this one leads.
pub(crate) struct Led<'a> {
    crew: &'a dyn Crew,
    /// Those whose work is ended.
    dismissed: Mutex<BTreeSet<usize>>,
}

fn held<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Led<'_> {
    /// Measures batches of a scene, here and wherever somebody asks for some.
    pub(crate) fn measure(
        &self,
        job: &Job,
        source: &dyn PhotonSource,
        batches: &[u32],
        watch: &dyn Watch,
    ) -> Result<Measurement, Failure> {
        let left = Left {
            batches: Mutex::new(batches.to_vec()),
            watch,
        };
        let planes = &job.scene().planes;
        let (own, others) = thread::scope(|scope| {
            let others = scope.spawn(|| self.serve(job, source, &left));
            let own = measure_watched(source, planes, batches, &left);
            (own, others.join())
        });
        let others =
            others.map_err(|_| Failure::cannot_run("the process that leads has failed"))??;
        let mut all = own;
        for batch in others {
            all.insert(batch).map_err(Failure::cannot_run)?;
        }
        Ok(all)
    }

    /// Answers whoever asks, until all have been told that there is no more.
    fn serve(
        &self,
        job: &Job,
        source: &dyn PhotonSource,
        left: &Left<'_>,
    ) -> Result<Vec<Batch>, Failure> {
        let mut found = Vec::new();
        let mut abreast = vec![1; self.crew.count()];
        while held(&self.dismissed).len() + 1 < self.crew.count() {
            let (who, bytes) = self.crew.receive().map_err(Failure::cannot_run)?;
            let (said, bytes) = Said::read(&bytes).map_err(Failure::cannot_run)?;
            match said {
                Said::Ready { key: theirs, .. } if theirs != key(job) => {
                    self.answer(who, &[])?;
                    return Err(Failure::cannot_run(format!(
                        "process {who} has another scene, or another version of Étendue"
                    )));
                }
                Said::Ready { abreast: most, .. } => abreast[who] = most,
                Said::Failed { message } => {
                    self.answer(who, &[])?;
                    return Err(Failure::cannot_run(format!("process {who}: {message}")));
                }
                Said::Done { batches } => {
                    let mut bytes = bytes;
                    for (number, length) in batches {
                        let (own, rest) = bytes.split_at_checked(length).unwrap_or_default();
                        bytes = rest;
                        let batch = job.unpacked(source, number, own)?;
                        left.watch.traced(batch.emitted);
                        left.watch.done(&batch);
                        found.push(batch);
                    }
                }
            }
            self.answer(who, &left.taken(abreast[who]))?;
        }
        Ok(found)
    }

    fn answer(&self, who: usize, batches: &[u32]) -> Result<(), Failure> {
        if batches.is_empty() {
            held(&self.dismissed).insert(who);
        }
        let bytes: Vec<u8> = batches.iter().flat_map(|b| b.to_le_bytes()).collect();
        self.crew.send(who, &bytes).map_err(Failure::cannot_run)
    }

    fn dismiss_all(&self) -> Result<(), Failure> {
        while held(&self.dismissed).len() + 1 < self.crew.count() {
            let (who, _) = self.crew.receive().map_err(Failure::cannot_run)?;
            self.answer(who, &[])?;
        }
        Ok(())
    }
}

/// The batches that nobody has taken.
struct Left<'a> {
    batches: Mutex<Vec<u32>>,
    watch: &'a dyn Watch,
}

impl Left<'_> {
    /// Takes the last ones, as many as that: this process goes through them from the first.
    fn taken(&self, most: usize) -> Vec<u32> {
        let mut batches = held(&self.batches);
        let mut taken = Vec::new();
        while taken.len() < most.max(1)
            && let Some(batch) = batches.pop()
        {
            if self.watch.wants(batch) {
                taken.push(batch);
            }
        }
        taken
    }
}

impl Watch for Left<'_> {
    fn traced(&self, photons: u64) {
        self.watch.traced(photons);
    }

    fn wants(&self, batch: u32) -> bool {
        let mut batches = held(&self.batches);
        let Some(at) = batches.iter().position(|other| *other == batch) else {
            return false;
        };
        batches.remove(at);
        self.watch.wants(batch)
    }

    fn done(&self, batch: &Batch) {
        self.watch.done(batch);
    }
}

/// Measures whatever the process that leads asks for.
fn follow(args: &RunArgs, crew: &dyn Crew) {
    let options = Options {
        set: args.scene.set.clone(),
        photons: args.photons.photons,
        seed: args.photons.seed,
        method: args.photons.method,
    };
    let work = || -> Result<(), Failure> {
        let job = Job::read(&args.scene.path, &options)?;
        let source = job.source()?;
        let mut said = Said::Ready {
            key: key(&job),
            abreast: rayon::current_num_threads(),
        };
        let mut bytes = Vec::new();
        loop {
            crew.send(0, &said.with(&bytes))
                .map_err(Failure::cannot_run)?;
            let (_, answer) = crew.receive().map_err(Failure::cannot_run)?;
            let numbers: Vec<u32> = answer
                .as_chunks()
                .0
                .iter()
                .map(|bytes| u32::from_le_bytes(*bytes))
                .collect();
            if numbers.is_empty() {
                return Ok(());
            }
            let found = measure_watched(&*source, &job.scene().planes, &numbers, &Alone);
            let mut batches = Vec::new();
            bytes.clear();
            for batch in found.batches() {
                let packed = job.packed(batch)?;
                batches.push((batch.index, packed.len()));
                bytes.extend(packed);
            }
            said = Said::Done { batches };
        }
    };
    if let Err(Failure { message, .. }) = on_threads(&args.threads, work) {
        // The one that leads says so and ends the run; it may be gone itself.
        let _ = crew.send(0, &Said::Failed { message }.with(&[]));
        let _ = crew.receive();
    }
}

/// Nobody looks on.
struct Alone;

impl Watch for Alone {
    fn traced(&self, _photons: u64) {}
}

impl Said {
    /// The length of the words, the words, and bytes that they are about.
    fn with(&self, bytes: &[u8]) -> Vec<u8> {
        let words = serde_json::to_vec(self).unwrap_or_default();
        let length = (words.len() as u64).to_le_bytes();
        [&length, words.as_slice(), bytes].concat()
    }

    fn read(bytes: &[u8]) -> Result<(Self, &[u8]), String> {
        let fault = || "a message between processes is damaged".to_owned();
        let (length, rest) = bytes.split_first_chunk().ok_or_else(fault)?;
        let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| fault())?;
        let (words, rest) = rest.split_at_checked(length).ok_or_else(fault)?;
        Ok((serde_json::from_slice(words).map_err(|_| fault())?, rest))
    }
}
