//! Arguments of commands that a newcomer needs first.

use super::shared::one_of;
use clap::Args;
use clap_complete::Shell;
use etendue_scenes::{FIG9B, FIG10, TABLE1_SOLAR_OVEN, TABLE1_TEXTURED_GLOSSY, TABLE1_TRAVEL};
use std::path::PathBuf;

/// The texts of the scenes, each with its name and a description.
pub(crate) const SCENES: [(&str, &str, &str); 5] = [
    (
        FIG9B,
        "blockers",
        "A square light, small blockers and a floor",
    ),
    (
        TABLE1_TRAVEL,
        "travel",
        "A slide of bars at three distances",
    ),
    (TABLE1_SOLAR_OVEN, "mirror", "A beam on a hollow mirror"),
    (
        TABLE1_TEXTURED_GLOSSY,
        "glossy",
        "A projector and a glossy sphere with a texture",
    ),
    (
        FIG10,
        "curved",
        "Seven steps of a reflection off a curved glossy surface",
    ),
];

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue new && etendue run blockers.ron
  etendue new mirror --out my.ron")]
pub(crate) struct NewArgs {
    /// Scene to write
    #[arg(value_name = "NAME", value_parser = one_of(SCENES), default_value = SCENES[0].1)]
    pub(crate) text: &'static str,

    /// File to write; a file that exists is not replaced [default: NAME.ron]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue completions bash > ~/.local/share/bash-completion/completions/etendue
  etendue completions zsh > ~/.zfunc/_etendue")]
pub(crate) struct CompletionsArgs {
    /// Shell that reads the script
    #[arg(value_name = "SHELL")]
    pub(crate) shell: Shell,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue man > etendue.1
  etendue man run | man -l -")]
pub(crate) struct ManArgs {
    /// Command to describe [default: the program]
    #[arg(value_name = "COMMAND")]
    pub(crate) command: Option<String>,
}
