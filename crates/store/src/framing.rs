//! Encodes messages that consist of a header in JSON, called words, and of bytes.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// The length of the words, the words, and the bytes.
pub fn joined(words: &impl Serialize, bytes: &[u8]) -> Vec<u8> {
    let words = serde_json::to_vec(words).unwrap_or_default();
    let length = (words.len() as u64).to_le_bytes();
    [&length, words.as_slice(), bytes].concat()
}

/// Splits the bytes of [`joined`] into words and bytes.
///
/// # Errors
/// When the bytes do not form a message of this kind.
pub fn split<T: DeserializeOwned>(bytes: &[u8]) -> Result<(T, &[u8]), String> {
    let fault = || "a message between processes is damaged".to_owned();
    let (length, rest) = bytes.split_first_chunk().ok_or_else(fault)?;
    let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| fault())?;
    let (words, rest) = rest.split_at_checked(length).ok_or_else(fault)?;
    Ok((serde_json::from_slice(words).map_err(|_| fault())?, rest))
}
