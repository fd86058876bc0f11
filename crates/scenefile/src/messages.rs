//! Explains in words why a value does not fit a field.

use crate::hints::wanted;
use crate::suggestion::did_you_mean;
use serde_path_to_error::{Path, Segment};

/// A path as messages show it, without names of variants.
pub(crate) fn path_of(path: &Path) -> String {
    let mut written = String::new();
    for segment in path.iter() {
        match segment {
            Segment::Seq { index } => written.push_str(&format!("[{index}]")),
            Segment::Map { key } if written.is_empty() => written.push_str(key),
            Segment::Map { key } => written.extend([".", key]),
            Segment::Enum { .. } | Segment::Unknown => {}
        }
    }
    written
}

/// The reason why a value does not fit its field or a nested field.
pub(crate) fn unfit(error: &serde_path_to_error::Error<serde_json::Error>) -> String {
    let field = path_of(error.path());
    let told = error.inner().to_string();
    // The line and the column are reported separately, so they are removed from this message.
    let told = told.split(" at line ").next().unwrap_or_default();
    // If a name is unknown, the message contains this name, followed by the known names.
    let mut names = told.split('`').skip(1).step_by(2);
    let meant = match names.next() {
        Some(found) if told.starts_with("unknown ") => did_you_mean(found, names),
        _ => String::new(),
    };
    let told = match told.split_once(", expected struct ") {
        // The name of a type of this program tells the user nothing.
        Some((found, _)) => format!("{found}, expected fields"),
        None if told == "expected value" => "no value of this kind".to_owned(),
        None => told.to_owned(),
    };
    let at = if field.is_empty() { "" } else { ": " };
    format!("{field}{at}{told}{meant}; allowed: {}", wanted(&field))
}
