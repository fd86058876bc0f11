//! Text in a fixed number of UTF-32 characters, terminated by zeros.

use crate::Fault;
use crate::cursor::ByteCursor;

/// Reads a text from a field of `characters` characters; `what` names it in notes.
pub(super) fn read(
    cursor: &mut ByteCursor<'_>,
    characters: usize,
    what: &str,
    notes: &mut Vec<String>,
) -> Result<String, Fault> {
    let bytes = cursor.take(4 * characters, what)?;
    let codes = || {
        let code = |c: &[u8]| u32::from_le_bytes([c[0], c[1], c[2], c[3]]);
        bytes.chunks_exact(4).map(code)
    };
    let end = codes().position(|c| c == 0).unwrap_or(characters);
    let text: String = codes()
        .take(end)
        .map(|code| char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect();
    let wrong = codes()
        .take(end)
        .filter(|&code| char::from_u32(code).is_none())
        .count();
    if wrong > 0 {
        notes.push(format!(
            "{what}: {wrong} characters are invalid; shown as �"
        ));
    }
    if codes().skip(end).any(|code| code != 0) {
        notes.push(format!(
            "{what}: characters after the terminating zero are dropped"
        ));
    }
    Ok(text)
}

/// Appends a text, cut to the length of its field and padded with zeros.
pub(super) fn write(text: &str, characters: usize, bytes: &mut Vec<u8>) {
    let codes = text.chars().map(u32::from).chain(std::iter::repeat(0));
    bytes.extend(codes.take(characters).flat_map(u32::to_le_bytes));
}
