//! Light that a diffuse receiver reflects, at the end of a chain.

use crate::parallel::chain::ChainSegment;
use crate::parallel::receiver::Receiver;

impl<'a> ChainSegment<'a> {
    /// Returns the diffuse surface at the end of the path, if there is one, with the light and
    /// masks before it.
    ///
    /// # Panics
    /// Panics if there is more than one factor G.
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
