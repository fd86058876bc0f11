//! Implements `etendue completions` and `etendue man`, which describe the command line to a shell
//! and to `man`.

use crate::args::{Cli, CompletionsArgs, ManArgs};
use crate::print::deliver_bytes;
use clap_mangen::Man;
use etendue_store::Failure;

/// The name of the program.
const NAME: &str = "etendue";

/// Runs `etendue completions`; returns the exit code.
pub(crate) fn completions(args: &CompletionsArgs) -> Result<u8, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::grouped_command(), NAME, &mut script);
    deliver_bytes(&script)?;
    Ok(0)
}

/// Runs `etendue man`; returns the exit code.
pub(crate) fn man(args: &ManArgs) -> Result<u8, Failure> {
    let mut all = Cli::grouped_command();
    all.build();
    let page = match &args.command {
        None => all,
        Some(name) => {
            let found = all.find_subcommand(name).cloned();
            let found = found.ok_or_else(|| {
                let allowed = "allowed: a command that etendue --help lists";
                Failure::bad_input(format!("{name} is no command; {allowed}"))
            })?;
            found.display_name(format!("{NAME}-{name}"))
        }
    };
    let mut text = Vec::new();
    Man::new(page)
        .render(&mut text)
        .map_err(Failure::cannot_run)?;
    deliver_bytes(&text)?;
    Ok(0)
}
