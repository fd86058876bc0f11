//! Writes and checks JSON files that end with the number of their format and with their own hash.
//! Indices and timings are such files.
//!
//! The last field is `index_hash`, the BLAKE3 hash of all bytes before it. If a file was edited in
//! any way, its hash no longer matches.

use crate::version::{FORMAT, VERSION};
use serde::Serialize;
use serde_json::Value;

/// Returns readable JSON with a final newline. Numbers that are not finite become null.
pub fn json(value: &impl Serialize) -> Vec<u8> {
    // Serialisation cannot fail, because all keys are text.
    let mut bytes = serde_json::to_vec_pretty(value).unwrap_or_default();
    bytes.push(b'\n');
    bytes
}

/// The text before and after the 64 digits of the hash.
const BEFORE: &str = ",\n  \"index_hash\": \"";
const AFTER: &str = "\"\n}\n";
/// The text with which a JSON object must end before it is sealed.
const END: &str = "\n}\n";

/// Appends the format and the hash to a JSON object with at least one field, in readable form.
pub fn sealed(json: &[u8]) -> Vec<u8> {
    let body = json.strip_suffix(END.as_bytes()).unwrap_or(json);
    let format = format!(",\n  \"format\": {FORMAT}");
    let body = [body, format.as_bytes()].concat();
    let hash = blake3::hash(&body).to_hex();
    [&body, BEFORE.as_bytes(), hash.as_bytes(), AFTER.as_bytes()].concat()
}

/// Returns the JSON object that was sealed, or `None` if the bytes do not end with their own hash.
pub fn unsealed(bytes: &[u8]) -> Option<Vec<u8>> {
    let text = str::from_utf8(bytes).ok().filter(|_| is_sealed(bytes))?;
    let (body, _) = text.rsplit_once(",\n  \"format\": ")?;
    Some([body, END].concat().into_bytes())
}

/// Fails if a JSON file has another format than this version reads.
///
/// # Errors
/// The fault, in words.
pub fn check_format(json: &[u8]) -> Result<(), String> {
    let tree: Value = serde_json::from_slice(json).unwrap_or_default();
    match tree.get("format") {
        Some(format) if *format != FORMAT => Err(format!(
            "format is {format}; this version of etendue, {VERSION}, reads format {FORMAT}"
        )),
        _ => Ok(()),
    }
}

/// Fails if a file does not end with its own hash.
///
/// # Errors
/// The fault, in words.
pub fn check_seal(bytes: &[u8]) -> Result<(), String> {
    let changed = "the file was changed after it was written: its index_hash does not match the text before it";
    if is_sealed(bytes) {
        Ok(())
    } else {
        Err(changed.to_owned())
    }
}

/// Checks whether bytes end with their own hash.
pub fn is_sealed(bytes: &[u8]) -> bool {
    let hash_of = || {
        let rest = bytes.strip_suffix(AFTER.as_bytes())?;
        let (rest, digits) = rest.split_at_checked(rest.len().checked_sub(64)?)?;
        let body = rest.strip_suffix(BEFORE.as_bytes())?;
        Some((blake3::hash(body), digits))
    };
    hash_of().is_some_and(|(hash, digits)| hash.to_hex().as_bytes() == digits)
}

#[cfg(test)]
mod tests {
    use super::{is_sealed, sealed, unsealed};
    use crate::version::FORMAT;

    #[test]
    fn every_changed_bit_breaks_the_seal() {
        let whole = sealed(b"{\n  \"a\": 1\n}\n");
        assert!(is_sealed(&whole));
        assert_eq!(unsealed(&whole).unwrap(), b"{\n  \"a\": 1\n}\n");
        let json: serde_json::Value = serde_json::from_slice(&whole).unwrap();
        assert_eq!([&json["a"], &json["format"]], [1, FORMAT]);
        for bit in 0..8 * whole.len() {
            let mut changed = whole.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            assert!(!is_sealed(&changed), "bit {bit}");
        }
        for length in 0..whole.len() {
            assert!(!is_sealed(&whole[..length]), "{length} bytes");
        }
    }
}
