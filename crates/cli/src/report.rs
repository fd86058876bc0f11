//! A result as one page that any browser shows, without network: `report.html` of each run, and
//! `etendue report`, which puts several of them side by side.

mod data;
pub(crate) mod explorer;

use crate::args::ReportArgs;
use crate::say;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
pub(crate) use data::data;
use etendue_scene::read_file;
use etendue_store::Failure;
use etendue_store::SUMMARY;
use etendue_store::output::OutputFile;
use serde::de::IgnoredAny;
use std::path::{Path, PathBuf};

/// The page of a run, among its results.
pub(crate) const NAME: &str = "report.html";

/// Most bytes of a page that is read.
const MOST: u64 = 1 << 28;

/// What is around the data of a run in a page; before it, where the explorer is.
const BEFORE: &str = "class=\"run-data\">";
const AFTER: &str = "</script>";

/// `etendue report`: returns the exit code.
pub(crate) fn report(args: &ReportArgs) -> Result<u8, Failure> {
    let pages: Vec<PathBuf> = args
        .folders
        .iter()
        .map(|folder| folder.join(NAME))
        .collect();
    let summaries = args.folders.iter().map(|folder| folder.join(SUMMARY));
    let inputs: Vec<PathBuf> = pages.iter().cloned().chain(summaries).collect();
    let blocks = args.folders.iter().map(|folder| stored(folder));
    let blocks: Vec<String> = blocks.collect::<Result<_, _>>()?;
    let folder = |path: &PathBuf| {
        path.file_name()
            .map(|name| name.to_string_lossy().into_owned())
    };
    let names: Vec<String> = args.folders.iter().filter_map(folder).collect();
    let out = OutputFile::claim(&args.out, args.force.force, &inputs)?;
    let parent = args.out.parent().filter(|path| *path != Path::new(""));
    let parent = parent.unwrap_or(Path::new("."));
    let beside = args.folders.iter().map(|folder| address(folder, parent));
    let blocks: Vec<_> = beside.zip(blocks).collect();
    out.write(page(&names.join(", "), &blocks).as_bytes())?;
    say(&format!("report in {}", args.out.display()));
    Ok(0)
}

/// The data of the run in a folder, as they were written.
fn stored(folder: &Path) -> Result<String, Failure> {
    let shown = folder.join(NAME);
    let fault = |what: &str| Failure::bad_input(format!("{}: {what}", shown.display()));
    let hash = etendue_store::hash_of(folder, SUMMARY, NAME).ok_or_else(|| {
        let folder = folder.display();
        Failure::bad_input(format!(
            "{folder} is no whole result with a {NAME}: run the scene again with this version"
        ))
    })?;
    let bytes = read_file(&shown, MOST).map_err(|e| fault(&e.to_string()))?;
    if hash != blake3::hash(&bytes).to_hex().as_str() {
        return Err(fault("damaged: its hash is not the one in summary.json"));
    }
    let text = String::from_utf8(bytes).map_err(|e| fault(&e.to_string()))?;
    let inside = text
        .split_once(BEFORE)
        .and_then(|(_, rest)| rest.split_once(AFTER));
    let (data, _) = inside.ok_or_else(|| fault("it holds no data of a run"))?;
    // An index can be made anew around any page: what is taken from it is data.
    serde_json::from_str::<IgnoredAny>(data).map_err(|e| fault(&e.to_string()))?;
    Ok(data.to_owned())
}

/// A folder as seen from another, with a / at its end.
fn address(folder: &Path, from: &Path) -> String {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let [folder, from] = [folder, from].map(absolute);
    let inside = folder.strip_prefix(&from).unwrap_or(&folder);
    format!("{}/", inside.display())
}

/// A page of the data of some runs in JSON, each with the folder it is in, as seen from the page.
pub(crate) fn page(title: &str, blocks: &[(String, String)]) -> String {
    let block = |(folder, data): &(String, String)| {
        let folder = escaped(folder).replace('"', "&quot;");
        // In JSON it is in strings alone: no name in a scene ends the data.
        let data = data.replace('<', "\\u003c");
        format!("<script type=\"application/json\" data-folder=\"{folder}\" {BEFORE}{data}{AFTER}")
    };
    let data: Vec<String> = blocks.iter().map(block).collect();
    let [sequential, diverging] = etendue_figures::palettes().map(|colors| STANDARD.encode(colors));
    let colors = format!("{{\"sequential\": \"{sequential}\", \"diverging\": \"{diverging}\"}}");
    // The data last: whatever stands in them is not looked at again.
    include_str!("report/page.html")
        .replace("<!--TITLE-->", &escaped(title))
        .replace("<!--STYLE-->", include_str!("report/page.css"))
        .replace("<!--SCRIPT-->", include_str!("report/page.js"))
        .replace("<!--COLORS-->", &colors)
        .replacen("<!--DATA-->", &data.join("\n"), 1)
}

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;");
    text.replace('<', "&lt;").replace('>', "&gt;")
}
