//! Implements `etendue import`: describes a scene of another program.

use crate::args::ImportArgs;
use crate::print::deliver;
use etendue_store::Failure;
use etendue_view::Contents;

/// Runs `etendue import`; returns the exit code.
pub(crate) fn import(args: &ImportArgs) -> Result<u8, Failure> {
    let contents = Contents::read(&args.scene.source())?;
    deliver(&contents.lines().join("\n"))?;
    Ok(0)
}
