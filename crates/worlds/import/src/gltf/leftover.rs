//! Notes on content of glTF files that a world cannot represent.

use super::reader::GltfReader;
use crate::report::quoted;

impl GltfReader<'_> {
    /// Adds notes on ignored content that concerns the whole file.
    pub(super) fn tell_leftovers(&self) {
        let root = self.root;
        for (i, animation) in root.animations.iter().enumerate() {
            let name = animation.name.as_deref().unwrap_or_default();
            let message = format!(
                "animation {} is left out: nodes keep the transforms that they have without it",
                quoted(name)
            );
            self.note(&format!("animations[{i}]"), message);
        }
        for name in root.extensions.iter().flat_map(|of| of.others.keys()) {
            self.note("extensions", format!("{} left out", quoted(name)));
        }
    }
}
