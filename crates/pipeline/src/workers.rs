//! Shares work among several processes, each with its own memory. One process leads, and gives
//! pieces of work to the other processes when they request them.
//!
//! A piece is a batch of a run, a plane to predict, or a point of a sweep. Processes exchange
//! bytes, and each piece is identified by a number. On processors of one kind, the bits of the
//! result therefore do not depend on the number or the speed of the processes. The leading
//! process also processes pieces itself.

mod leader;
mod link;
mod message;
mod packing;

pub use leader::Leader;
pub use link::{Workers, key};
pub use message::Task;
pub(crate) use message::{Order, Packed, Piece, WorkerMessage, packed, unpack, whole};
pub use packing::Packing;
