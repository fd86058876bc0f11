//! Ends commands whose results are a folder with an index.

use crate::print::{deliver, say_replaced};
use etendue_store::sealed::json;
use etendue_store::{Failure, Results};
use serde_json::Value;

/// Adds the list of files to the index, writes the index last, and prints where the results are.
pub(crate) fn finish(results: Results, mut index: Value, quiet: bool) -> Result<(), Failure> {
    let finished = results.finish(|files| {
        index["files"] = serde_json::json!(files);
        json(&index)
    })?;
    say_replaced(&finished, quiet);
    if !quiet {
        deliver(&format!("results in {}", finished.folder.display()))?;
    }
    Ok(())
}
