use crate::chain::Path;
use crate::irradiance::{self, Receiver};

impl<'a> Path<'a> {
    /// The diffuse surface at the end of the path, if there is one, and what shines on it.
    ///
    /// # Panics
    /// When there is more than one factor G.
    pub(crate) fn receiver(&self) -> Option<Receiver<'a>> {
        let reflection = self.reflection?;
        assert!(self.cosines < 2, "a receiver has one cosine");
        let layers = self.layers.iter().map(|layer| irradiance::Layer {
            distance: layer.distance,
            mask: layer.mask,
        });
        Some(Receiver::new(
            self.light,
            &layers.collect::<Vec<_>>(),
            self.distance,
            self.cosines == 1,
            reflection.after,
            reflection.albedo,
        ))
    }
}
