//! What processes say to each other: words, and bytes that they are about.

use etendue_store::framing::joined;
use serde::{Deserialize, Serialize};

/// What a process says to the one that leads, which answers with an [`Order`].
#[derive(Debug, Serialize, Deserialize)]
pub(crate) enum WorkerMessage {
    /// It has scenes with this key, and measures so many batches at a time.
    Ready { key: String, abreast: usize },
    /// The bytes of these pieces follow.
    Done { pieces: Vec<Piece> },
    /// It cannot do what it was told.
    Failed { message: String },
}

/// What there is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Task {
    /// Batches to measure.
    Batches,
    /// Planes to predict.
    Planes,
    /// Points of a sweep to run.
    Points,
}

/// Something to do, or something done.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Piece {
    pub number: u32,
    /// How many parts of a batch are done, unless it is whole or not begun.
    pub parts: Option<u32>,
    /// How many bytes it has.
    pub length: usize,
}

/// Pieces to do; none ends the work. The bytes of batches that are begun follow.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Order {
    pub(crate) task: Task,
    pub(crate) pieces: Vec<Piece>,
    /// When to send back batches that are not done by then.
    pub(crate) seconds: f64,
}

/// A piece with its bytes.
pub(crate) type Packed = (Piece, Vec<u8>);

/// The message that says `words` about pieces, and has their bytes.
pub(crate) fn packed<T: Serialize>(
    words: impl FnOnce(Vec<Piece>) -> T,
    pieces: Vec<Packed>,
) -> Vec<u8> {
    let (pieces, bytes): (Vec<Piece>, Vec<Vec<u8>>) = pieces.into_iter().unzip();
    joined(&words(pieces), &bytes.concat())
}

/// The bytes of each of some pieces, which follow each other.
pub(crate) fn unpack<'a>(
    pieces: &'a [Piece],
    mut bytes: &'a [u8],
) -> impl Iterator<Item = (&'a Piece, &'a [u8])> {
    pieces.iter().map(move |piece| {
        let (own, rest) = bytes.split_at_checked(piece.length).unwrap_or_default();
        bytes = rest;
        (piece, own)
    })
}
