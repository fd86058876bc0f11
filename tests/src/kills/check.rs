//! Checks a folder against its index. The reader of the index shares no code with the program.

use crate::hostile::folder::Folder;
use crate::hostile::index::TAIL;
use serde_json::Value;

/// The state of a folder according to its index.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum IndexState {
    /// The folder has no index, and so does not claim to contain a result.
    Absent,
    Whole,
    /// The folder has an index, and so claims to contain a result, but a file or hash is wrong.
    Broken(String),
}

/// Checks the files of a folder against its index, and the index against its own hash.
pub(super) fn state(files: &Folder, index: &str) -> IndexState {
    let Some(Some(bytes)) = files.get(index) else {
        return IndexState::Absent;
    };
    match whole(files, index, bytes) {
        Ok(()) => IndexState::Whole,
        Err(reason) => IndexState::Broken(reason),
    }
}

fn whole(files: &Folder, index: &str, bytes: &[u8]) -> Result<(), String> {
    for (name, hash) in listed(index, bytes).ok_or(format!("{index} lists no files"))? {
        match files.get(&name) {
            Some(Some(bytes)) if *blake3::hash(bytes).to_hex() == *hash => (),
            Some(Some(_)) => return Err(format!("{name} is not what {index} lists")),
            _ => return Err(format!("{name} is not there, and {index} lists it")),
        }
    }
    sealed(bytes).map_err(|reason| format!("{index} {reason}"))?;
    match files.get("timing.json") {
        Some(Some(bytes)) => sealed(bytes).map_err(|reason| format!("timing.json {reason}")),
        _ => Ok(()),
    }
}

/// The names and hashes listed in an index.
pub(super) fn listed(index: &str, bytes: &[u8]) -> Option<Vec<(String, String)>> {
    let beside = index.rfind('/').map_or("", |at| &index[..=at]);
    let tree: Value = serde_json::from_slice(bytes).ok()?;
    let pairs = tree.get("files")?.as_object()?.iter();
    let pair = |(name, hash): (&String, &Value)| {
        Some((format!("{beside}{name}"), hash.as_str()?.to_owned()))
    };
    pairs.map(pair).collect()
}

/// The fault that an index has no hash of its own. This fault is counted separately.
pub(super) const NO_HASH: &str = "has no hash of its own";

/// The last field of an index is the hash of all bytes before it.
fn sealed(index: &[u8]) -> Result<(), &'static str> {
    let text = std::str::from_utf8(index).map_err(|_| "is not UTF-8")?;
    let at = text.rfind(TAIL).ok_or(NO_HASH)?;
    let hash = blake3::hash(&index[..at]).to_hex();
    if text[at..] == format!("{TAIL}{hash}\"\n}}\n") {
        Ok(())
    } else {
        Err("does not match its own hash")
    }
}

#[cfg(test)]
mod tests {
    use super::{IndexState, NO_HASH, state};
    use crate::hostile::folder::{self, Folder};
    use crate::hostile::index::TAIL;

    fn folder(index: &str, content: Option<&str>) -> Folder {
        let mut files = folder::of([("i.json", index.into())]);
        files.extend(content.map(|text| ("a/b".to_owned(), Some(text.into()))));
        files
    }

    #[test]
    fn only_a_whole_folder_is_a_result() {
        let hash = blake3::hash(b"content").to_hex();
        let body = format!("{{\n  \"files\": {{\n    \"a/b\": \"{hash}\"\n  }}");
        let own = blake3::hash(body.as_bytes()).to_hex();
        let index = format!("{body}{TAIL}{own}\"\n}}\n");
        let of = |index: &str, content| state(&folder(index, content), "i.json");
        assert_eq!(of(&index, Some("content")), IndexState::Whole);
        let broken = |index: &str, content, part: &str| match of(index, content) {
            IndexState::Broken(reason) => assert!(reason.contains(part), "{reason}"),
            other => panic!("{other:?}"),
        };
        broken(&index, Some("other"), "not what");
        broken(&index, None, "not there");
        broken(&format!("{body}\n}}\n"), Some("content"), NO_HASH);
        let changed = index.replace("\"files\"", " \"files\"");
        broken(&changed, Some("content"), "its own hash");
        broken("{", Some("content"), "lists no files");
        assert_eq!(state(&Folder::new(), "i.json"), IndexState::Absent);
    }
}
