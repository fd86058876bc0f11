//! `etendue figure`: the figures of Durand et al. 2005, and figures of the user's scenes.

use crate::args::FigureArgs;
use crate::conclude::code_of;
use crate::print::say;
use crate::progress::Terminal;
use crate::threads::on_threads;
use crate::warnings;
use etendue_compare::Verdict;
use etendue_paper::{Request, make, subjects};
use etendue_pipeline::table::word;
use etendue_pipeline::{Reporter, Work};
use etendue_store::Failure;
use std::time::Instant;

/// `etendue figure`: returns the exit code.
pub(crate) fn figure(args: &FigureArgs) -> Result<u8, Failure> {
    let request = Request {
        names: args.names.clone(),
        set: args.set.clone(),
        plane: args.plane.clone(),
        style: args.style.clone(),
        quality: args.quality,
        out: args.out.clone(),
        force: args.force.force,
    };
    let subjects = subjects(&request)?;
    for warning in subjects.iter().flat_map(|subject| subject.warnings()) {
        if !args.quiet {
            warnings::warn(warning);
        }
    }
    on_threads(&args.threads, || {
        let terminal = Terminal::new(args.quiet);
        let bar = terminal.begin(Work::Steps {
            verb: "drawing",
            total: subjects.len(),
            things: "figures",
        });
        let mut worst = Verdict::Pass;
        for subject in &subjects {
            bar.name(subject.name());
            let begun = Instant::now();
            let verdict = make(&request, subject, &terminal)?;
            terminal.note(&format!(
                "figure {}: {}, {:.1} s: {}",
                subject.name(),
                word(verdict),
                begun.elapsed().as_secs_f64(),
                subject.about()
            ));
            worst = worst.and(verdict);
            bar.advance(1);
        }
        drop(bar);
        if !args.quiet {
            say(&format!("figures in {}", args.out.display()));
        }
        Ok(code_of(worst))
    })
}
