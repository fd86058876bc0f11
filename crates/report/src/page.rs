//! Writes results as one page that any browser shows without network. The page is the `report.html`
//! of a run, or the output of `etendue report`, which shows several runs side by side.

mod data;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
pub use data::data;
use etendue_scene::read_file;
use etendue_store::stored::no_result;
use etendue_store::{Failure, SUMMARY};
use serde::de::IgnoredAny;
use std::path::Path;

/// The file name of a run's page, among its results.
pub const NAME: &str = "report.html";

/// The largest number of bytes of a page that is read.
const MAX_PAGE_BYTES: u64 = 1 << 28;

/// In a page, this text is before the data of a run, and the next text is after them.
const BEFORE: &str = "class=\"run-data\">";
const AFTER: &str = "</script>";

/// The data of the run in a folder, exactly as the page holds them.
pub fn stored_data(folder: &Path) -> Result<String, Failure> {
    let shown = folder.join(NAME);
    let fault = |what: &str| Failure::bad_input(format!("{}: {what}", shown.display()));
    if !folder.join(SUMMARY).is_file() {
        return Err(no_result(folder));
    }
    let hash = etendue_store::hash_of(folder, SUMMARY, NAME).ok_or_else(|| {
        let shown = folder.display();
        Failure::bad_input(format!(
            "{shown} holds no complete result with a {NAME}: run its scene again with this version"
        ))
    })?;
    let bytes = read_file(&shown, MAX_PAGE_BYTES).map_err(|e| fault(&e.to_string()))?;
    if hash != blake3::hash(&bytes).to_hex().as_str() {
        return Err(fault(
            "the page is damaged: its hash differs from the hash in summary.json",
        ));
    }
    let text = String::from_utf8(bytes).map_err(|e| fault(&e.to_string()))?;
    let inside = text
        .split_once(BEFORE)
        .and_then(|(_, rest)| rest.split_once(AFTER));
    let (data, _) = inside.ok_or_else(|| fault("the page does not contain the data of a run"))?;
    // A hash does not protect the page, because anyone can write a new index for a changed page.
    // The function therefore also checks that the text is valid JSON.
    serde_json::from_str::<IgnoredAny>(data).map_err(|e| fault(&e.to_string()))?;
    Ok(data.to_owned())
}

/// A page with the data of several runs. Each run has its data in JSON, and its folder
/// relative to the page.
pub fn page(title: &str, blocks: &[(String, String)]) -> String {
    let block = |(folder, data): &(String, String)| {
        let folder = escaped(folder).replace('"', "&quot;");
        // In JSON, the character `<` occurs only in strings. The character is escaped, so that no
        // name in a scene can end the data.
        let data = data.replace('<', "\\u003c");
        format!("<script type=\"application/json\" data-folder=\"{folder}\" {BEFORE}{data}{AFTER}")
    };
    let data: Vec<String> = blocks.iter().map(block).collect();
    let [sequential, diverging] = etendue_figures::palettes().map(|colors| STANDARD.encode(colors));
    let colors = format!("{{\"sequential\": \"{sequential}\", \"diverging\": \"{diverging}\"}}");
    // The data are inserted last, because they must not be searched for placeholders.
    include_str!("page/page.html")
        .replace("<!--TITLE-->", &escaped(title))
        .replace("<!--STYLE-->", include_str!("page/page.css"))
        .replace("<!--SCRIPT-->", include_str!("page/page.js"))
        .replace("<!--COLORS-->", &colors)
        .replacen("<!--DATA-->", &data.join("\n"), 1)
}

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;");
    text.replace('<', "&lt;").replace('>', "&gt;")
}
