//! Implements `etendue report`: shows the pages of several results side by side.

use crate::args::ReportArgs;
use crate::print::say;
use etendue_report::page::{NAME, page, stored_data};
use etendue_store::file_seal::SealKind;
use etendue_store::output::OutputFile;
use etendue_store::{Failure, SUMMARY};
use std::fs;
use std::path::{Path, PathBuf};

/// Runs `etendue report`; returns the exit code.
pub(crate) fn report(args: &ReportArgs) -> Result<u8, Failure> {
    write(&args.folders, &args.out, args.force.force)?;
    say(&format!("report in {}", args.out.display()));
    Ok(0)
}

/// Checks that the page of several results can be written.
pub(crate) fn claim(folders: &[PathBuf], out: &Path, force: bool) -> Result<OutputFile, Failure> {
    let pages = folders.iter().map(|folder| folder.join(NAME));
    let summaries = folders.iter().map(|folder| folder.join(SUMMARY));
    let inputs: Vec<PathBuf> = pages.chain(summaries).collect();
    OutputFile::claim_sealed(out, force, &inputs, SealKind::Markup)
}

/// Writes a page that shows several results side by side.
pub(crate) fn write(folders: &[PathBuf], out: &Path, force: bool) -> Result<(), Failure> {
    let blocks = folders.iter().map(|folder| stored_data(folder));
    let blocks: Vec<String> = blocks.collect::<Result<_, _>>()?;
    let folder = |path: &PathBuf| {
        path.file_name()
            .map(|name| name.to_string_lossy().into_owned())
    };
    let names: Vec<String> = folders.iter().filter_map(folder).collect();
    let parent = out.parent().filter(|path| *path != Path::new(""));
    let parent = parent.unwrap_or(Path::new("."));
    fs::create_dir_all(parent).map_err(|e| Failure::write(out, e))?;
    let file = claim(folders, out, force)?;
    let beside = folders.iter().map(|folder| address(folder, parent));
    let blocks: Vec<_> = beside.zip(blocks).collect();
    file.write(page(&names.join(", "), &blocks).as_bytes())
}

/// The relative path from the folder `from` to the folder `folder`, with a trailing /.
fn address(folder: &Path, from: &Path) -> String {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let [folder, from] = [folder, from].map(absolute);
    let (mut above, mut up) = (&*from, String::new());
    while !folder.starts_with(above) {
        up.push_str("../");
        above = above.parent().unwrap_or(Path::new(""));
    }
    let below = folder.strip_prefix(above).unwrap_or(&folder);
    format!("{up}{}/", below.display())
}
