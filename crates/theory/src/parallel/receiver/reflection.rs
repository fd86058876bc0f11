//! Light that a diffuse receiver reflects.

use crate::parallel::chain::ChainSegment;
use crate::parallel::receiver::Receiver;

impl<'a> ChainSegment<'a> {
    /// The diffuse surface at the end of the path, if there is one, and what shines on it.
    ///
    /// # Panics
    /// When there is more than one factor G.
    pub(crate) fn receiver(&self) -> Option<Receiver<'a>> {
        let reflection = self.reflection?;
        assert!(self.cosines < 2, "a receiver has one cosine");
        Some(Receiver::new(
            self.light,
            &self.layers,
            self.distance,
            self.cosines == 1,
            reflection.after,
            reflection.albedo,
        ))
    }
}
