//! What carries bytes between processes, and how they know that they have the same work.

use etendue_scene::Scene;
use etendue_store::stored::VERSION;

/// Processes that work together, by whatever carries bytes between them. Number 0 leads.
pub trait Workers: Sync {
    /// The number of this process.
    fn number(&self) -> usize;

    /// How many there are, this one included.
    fn count(&self) -> usize;

    /// Sends bytes to a process.
    ///
    /// # Errors
    /// In words, when they cannot be sent.
    fn send(&self, to: usize, bytes: &[u8]) -> Result<(), String>;

    /// Waits for bytes, from any process; tells whose they are.
    ///
    /// # Errors
    /// In words, when nothing can be received.
    fn receive(&self) -> Result<(usize, Vec<u8>), String>;
}

/// What all processes must have in common: otherwise they would work on different things.
pub fn key<'a>(scenes: impl IntoIterator<Item = &'a Scene>) -> String {
    let scenes = scenes.into_iter();
    let words = scenes.map(|scene| format!(" {} {}", scene.hash(), scene.run.seed));
    let words: String = words.collect();
    format!("{VERSION} {}", blake3::hash(words.as_bytes()).to_hex())
}
