//! Work that several processes share, each of which has its own memory: one leads and hands out pieces as others ask for them.
//!
//! A piece is a batch of a run, a plane to predict, or a point of a sweep. What goes between processes is bytes, and pieces are told by
//! their numbers: so the result has the same bits however many processes there are, and whoever is faster, on processors of one kind. A process that leads works as well.

mod follow;
mod led;
mod message;

pub(crate) use led::Led;
pub(crate) use message::{Packed, Piece, joined, split};

use crate::args::{Cli, Command, RunArgs};
use crate::failure::Failure;
use crate::results::stored::VERSION;
use crate::{ended, interrupt, not_parsed, predict, run, sweep};
use clap::Parser;
use etendue_scene::Scene;
use std::ffi::OsString;

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

/// What a command line comes to in a crew; returns the exit code. `run`, `predict` and `sweep` are for many.
pub fn in_crew(line: impl IntoIterator<Item = OsString>, crew: &dyn Crew) -> u8 {
    let leads = crew.number() == 0;
    let command = match Cli::try_parse_from(line) {
        Ok(cli) => cli.command,
        Err(error) => {
            // Whoever sees the terminal says it.
            if leads {
                return not_parsed(&error);
            }
            return u8::try_from(error.exit_code()).unwrap_or(2);
        }
    };
    if !is_shared(&command) {
        let message =
            "only `run` without --target-error, `predict` and `sweep` are for several processes";
        return ended(Err(Failure::bad_input(message)), !leads);
    }
    if !leads {
        follow::follow(&command, crew);
        return 0;
    }
    let led = Led::new(crew);
    let outcome = interrupt::install().and_then(|()| match &command {
        Command::Run(args) => run::run_with(args, Some(&led)),
        Command::Predict(args) => predict::predict_with(args, Some(&led)),
        Command::Sweep(args) => sweep::sweep_with(args, Some(&led)),
        _ => Ok(0),
    });
    // The others wait for work, because there is no more or something failed.
    let dismissed = led.dismiss_all();
    ended(outcome.and_then(|code| dismissed.map(|()| code)), false)
}

fn is_shared(command: &Command) -> bool {
    match command {
        Command::Run(RunArgs { target_error, .. }) => target_error.is_none(),
        command => matches!(command, Command::Predict(_) | Command::Sweep(_)),
    }
}

/// What all processes must have in common: otherwise they would work on different things.
pub(crate) fn key<'a>(scenes: impl IntoIterator<Item = &'a Scene>) -> String {
    let scenes = scenes.into_iter();
    let words = scenes.map(|scene| format!(" {} {}", scene.hash(), scene.run.seed));
    let words: String = words.collect();
    format!("{VERSION} {}", blake3::hash(words.as_bytes()).to_hex())
}
