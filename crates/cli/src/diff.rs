//! Implements `etendue diff`: compares two results of one scene.

use crate::args::DiffArgs;
use crate::conclude::code_of;
use crate::print::{deliver, deliver_json};
use etendue_report::diff::{Diff, json, text};
use etendue_store::Failure;
use etendue_store::file_seal::SealKind;
use etendue_store::output::OutputFile;

/// Runs `etendue diff`; returns the exit code.
pub(crate) fn diff(args: &DiffArgs) -> Result<u8, Failure> {
    let diff = Diff::read([&args.a, &args.b], args.alpha)?;
    if let Some(why) = diff.unpaired().filter(|_| args.pairs) {
        return Err(Failure::bad_input(format!(
            "--pairs: the results are not compared in pairs, because {why}"
        )));
    }
    if let Some(path) = &args.draw {
        let bytes = diff.drawn(path)?;
        let kind = SealKind::of(path).unwrap_or(SealKind::Png);
        OutputFile::claim_sealed(path, args.force.force, &[], kind)?.write(&bytes)?;
    }
    match args.json {
        true => deliver_json(&format!("{:#}", json(&diff)))?,
        false => deliver(&text(&diff))?,
    }
    Ok(code_of(diff.verdict()))
}
