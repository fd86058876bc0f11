//! Defines the messages between processes, and the bytes that follow each message.

use etendue_store::framing::joined;
use serde::{Deserialize, Serialize};

/// A message to the leading process, which answers it with an [`Order`].
#[derive(Debug, Serialize, Deserialize)]
pub(crate) enum WorkerMessage {
    /// The process has the scenes with the key `key`, and measures `abreast` batches in parallel.
    Ready { key: String, abreast: usize },
    /// The process has finished or returned the pieces `pieces`, whose bytes follow the message.
    Done { pieces: Vec<Piece> },
    /// The process cannot carry out the order that it received.
    Failed { message: String },
}

/// The kind of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Task {
    /// Batches to measure.
    Batches,
    /// Planes to predict.
    Planes,
    /// The points of a sweep that are to be run.
    Points,
}

/// A piece of work that is to be done or has been done.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Piece {
    pub number: u32,
    /// The number of finished parts of a batch; `None` if the batch is complete or not begun.
    pub parts: Option<u32>,
    /// The number of bytes of the piece.
    pub length: usize,
}

/// An order to process pieces; an empty list of pieces ends the work. The bytes of batches that
/// are already begun follow the order.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Order {
    pub(crate) task: Task,
    pub(crate) pieces: Vec<Piece>,
    /// The time in seconds after which unfinished batches are returned.
    pub(crate) seconds: f64,
}

/// A piece with its bytes.
pub(crate) type Packed = (Piece, Vec<u8>);

/// A piece that is complete or not begun, with its bytes.
pub(crate) fn whole(number: u32, bytes: Vec<u8>) -> Packed {
    let piece = Piece {
        number,
        parts: None,
        length: bytes.len(),
    };
    (piece, bytes)
}

/// The bytes of a message: the bytes of `words`, which describes the pieces, followed by
/// the bytes of the pieces.
pub(crate) fn packed<T: Serialize>(
    words: impl FnOnce(Vec<Piece>) -> T,
    pieces: Vec<Packed>,
) -> Vec<u8> {
    let (pieces, bytes): (Vec<Piece>, Vec<Vec<u8>>) = pieces.into_iter().unzip();
    joined(&words(pieces), &bytes.concat())
}

/// Splits the bytes that follow a message into the bytes of each piece.
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
