//! Defines the transport of bytes between processes, and checks that all processes do the same
//! work.

use etendue_scene::Scene;
use etendue_store::VERSION;
use std::iter;

/// Processes that work together, over any transport of bytes. Number 0 leads.
pub trait Workers: Sync {
    /// The number of this process.
    fn number(&self) -> usize;

    /// The number of processes, including this process.
    fn count(&self) -> usize;

    /// Sends bytes to a process.
    ///
    /// # Errors
    /// A description of the reason, when the bytes cannot be sent.
    fn send(&self, to: usize, bytes: &[u8]) -> Result<(), String>;

    /// Waits for bytes from any process; returns the number of the sender.
    ///
    /// # Errors
    /// A description of the reason, when nothing can be received.
    fn receive(&self) -> Result<(usize, Vec<u8>), String>;
}

/// A key that identifies the scenes and the version of the program. All processes must
/// have the same key, so that all of them work on the same scenes.
pub fn key<'a>(scenes: impl IntoIterator<Item = &'a Scene>) -> String {
    let words: String = scenes
        .into_iter()
        .flat_map(|scene| iter::once(scene).chain(scene.against.as_deref()))
        .map(|scene| format!(" {} {}", scene.hash(), scene.run.seed))
        .collect();
    format!("{VERSION} {}", blake3::hash(words.as_bytes()).to_hex())
}
