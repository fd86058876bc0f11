//! Implements `etendue figure`, which draws the figures of Durand et al. 2005 and figures of the
//! user's scenes.

use crate::args::FigureArgs;
use crate::conclude::code_of;
use crate::print::say;
use crate::progress::Terminal;
use crate::threads::on_threads;
use crate::warnings;
use etendue_paper::{FigureRequest, Wanted, make_all, subjects};
use etendue_store::{ArgumentStyle, Failure};

/// Runs `etendue figure`; returns the exit code.
pub(crate) fn figure(args: &FigureArgs) -> Result<u8, Failure> {
    let arguments = ArgumentStyle::Command;
    let wanted = args.names.iter();
    let wanted = wanted.map(|name| Wanted::named(name, &args.set, arguments));
    let request = FigureRequest {
        wanted: wanted.collect(),
        set: args.set.clone(),
        plane: args.plane.clone(),
        style: args.style.clone(),
        quality: args.quality,
        out: args.out.clone(),
        force: args.work.force.force,
        arguments,
    };
    let subjects = subjects(&request)?;
    for warning in subjects.iter().flat_map(|subject| subject.warnings()) {
        if !args.work.quiet {
            warnings::warn(warning);
        }
    }
    on_threads(&args.work.threads, || {
        let terminal = Terminal::new(args.work.quiet);
        let worst = make_all(&request, &subjects, &terminal)?;
        if !args.work.quiet {
            say(&format!("figures in {}", args.out.display()));
        }
        Ok(code_of(worst))
    })
}
