//! Work that several processes share, each of which has its own memory: one leads and hands out pieces as others ask for them.
//!
//! A piece is a batch of a run, a plane to predict, or a point of a sweep. What goes between processes is bytes, and pieces are told by
//! their numbers: so the result has the same bits however many processes there are, and whoever is faster, on processors of one kind. A process that leads works as well.

mod leader;
mod link;
mod message;
mod packing;

pub use leader::Leader;
pub use link::{Workers, key};
pub(crate) use message::{Order, Packed, Piece, Task, WorkerMessage, packed, unpack};
pub(crate) use packing::Packing;
