//! Implements `etendue schema`: prints the schema of scene files, for editors and as a page of
//! the book.

use crate::args::SchemaArgs;
use crate::print::deliver;
use etendue_store::Failure;

/// Runs `etendue schema`; returns the exit code.
pub(crate) fn schema(args: &SchemaArgs) -> Result<u8, Failure> {
    let text = match args.page {
        true => etendue_scene::page(),
        false => format!("{:#}", etendue_scene::schema()),
    };
    deliver(text.trim_end())?;
    Ok(0)
}
