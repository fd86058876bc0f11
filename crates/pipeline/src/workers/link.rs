//! The transport of bytes between processes, and the check that they do the same work.

use etendue_scene::Scene;
use etendue_store::stored::VERSION;

/// Processes that work together, over any transport of bytes. Number 0 leads.
pub trait Workers: Sync {
    /// Returns the number of this process.
    fn number(&self) -> usize;

    /// Returns the number of processes, including this process.
    fn count(&self) -> usize;

    /// Sends bytes to a process.
    ///
    /// # Errors
    /// A description, when the bytes cannot be sent.
    fn send(&self, to: usize, bytes: &[u8]) -> Result<(), String>;

    /// Waits for bytes from any process; returns the number of the sender.
    ///
    /// # Errors
    /// A description, when nothing can be received.
    fn receive(&self) -> Result<(usize, Vec<u8>), String>;
}

/// Returns a key of scenes and version. All processes must have the same key, which ensures that
/// they work on the same scenes.
pub fn key<'a>(scenes: impl IntoIterator<Item = &'a Scene>) -> String {
    let scenes = scenes.into_iter();
    let words = scenes.map(|scene| format!(" {} {}", scene.hash(), scene.run.seed));
    let words: String = words.collect();
    format!("{VERSION} {}", blake3::hash(words.as_bytes()).to_hex())
}
