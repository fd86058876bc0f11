//! `etendue import`: what a scene of another program holds.

use crate::args::ImportArgs;
use crate::print::deliver;
use etendue_store::Failure;
use etendue_view::{contents, load};

/// `etendue import`: returns the exit code.
pub(crate) fn import(args: &ImportArgs) -> Result<u8, Failure> {
    let imported = load(&args.scene.source())?;
    deliver(&contents(&imported).join("\n"))?;
    Ok(0)
}
