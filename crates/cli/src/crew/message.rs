//! What processes say to each other: words, and bytes that they are about.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// What a process says to the one that leads, which answers with an [`Order`].
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Said {
    /// It has scenes with this key, and measures so many batches at a time.
    Ready { key: String, abreast: usize },
    /// What follows these words are the pieces of these numbers, each of so many bytes.
    Done { pieces: Vec<(u32, usize)> },
    /// It cannot do what it was told.
    Failed { message: String },
}

/// What there is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Task {
    /// Batches to measure.
    Batches,
    /// Planes to predict.
    Planes,
    /// Points of a sweep to run.
    Points,
}

/// The numbers of pieces to do; none ends the work.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Order {
    pub(super) task: Task,
    pub(super) numbers: Vec<u32>,
}

/// The length of words, the words, and the bytes that they are about.
pub(crate) fn joined(words: &impl Serialize, bytes: &[u8]) -> Vec<u8> {
    let words = serde_json::to_vec(words).unwrap_or_default();
    let length = (words.len() as u64).to_le_bytes();
    [&length, words.as_slice(), bytes].concat()
}

/// Words and bytes of [`joined`].
///
/// # Errors
/// When they are of something else.
pub(crate) fn split<T: DeserializeOwned>(bytes: &[u8]) -> Result<(T, &[u8]), String> {
    let fault = || "a message between processes is damaged".to_owned();
    let (length, rest) = bytes.split_first_chunk().ok_or_else(fault)?;
    let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| fault())?;
    let (words, rest) = rest.split_at_checked(length).ok_or_else(fault)?;
    Ok((serde_json::from_slice(words).map_err(|_| fault())?, rest))
}
