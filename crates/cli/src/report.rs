//! Implements `etendue report`: shows the pages of several results side by side.

use crate::args::ReportArgs;
use crate::print::say;
use etendue_report::page::{NAME, page, stored_data};
use etendue_store::file_seal::SealKind;
use etendue_store::output::OutputFile;
use etendue_store::{Failure, SUMMARY};
use std::path::{Path, PathBuf};

/// Runs `etendue report`; returns the exit code.
pub(crate) fn report(args: &ReportArgs) -> Result<u8, Failure> {
    let pages: Vec<PathBuf> = args
        .folders
        .iter()
        .map(|folder| folder.join(NAME))
        .collect();
    let summaries = args.folders.iter().map(|folder| folder.join(SUMMARY));
    let inputs: Vec<PathBuf> = pages.iter().cloned().chain(summaries).collect();
    let blocks = args.folders.iter().map(|folder| stored_data(folder));
    let blocks: Vec<String> = blocks.collect::<Result<_, _>>()?;
    let folder = |path: &PathBuf| {
        path.file_name()
            .map(|name| name.to_string_lossy().into_owned())
    };
    let names: Vec<String> = args.folders.iter().filter_map(folder).collect();
    let (force, kind) = (args.force.force, SealKind::Markup);
    let out = OutputFile::claim_sealed(&args.out, force, &inputs, kind)?;
    let parent = args.out.parent().filter(|path| *path != Path::new(""));
    let parent = parent.unwrap_or(Path::new("."));
    let beside = args.folders.iter().map(|folder| address(folder, parent));
    let blocks: Vec<_> = beside.zip(blocks).collect();
    out.write(page(&names.join(", "), &blocks).as_bytes())?;
    say(&format!("report in {}", args.out.display()));
    Ok(0)
}

/// Returns the relative path from the folder `from` to the folder `folder`, with a trailing /.
fn address(folder: &Path, from: &Path) -> String {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let [folder, from] = [folder, from].map(absolute);
    let inside = folder.strip_prefix(&from).unwrap_or(&folder);
    format!("{}/", inside.display())
}
