//! Encodes batches as bytes, for another process.

use super::message::{Packed, Piece};
use etendue_field::{PhotonSource, VirtualPlane};
use etendue_scene::Scene;
use etendue_spectrum::{Batch, PartialBatch};
use etendue_store::batches::Held;
use etendue_store::{Failure, Method, checkpoints};
use std::borrow::Cow;

/// Encodes batches of a scene, measured by a method, as bytes, and decodes them.
#[derive(Clone, Copy, Debug)]
pub struct Packing<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The method of measurement.
    pub method: Method,
}

impl Packing<'_> {
    /// The planes of each batch.
    pub(crate) fn planes(&self) -> Cow<'_, [VirtualPlane]> {
        self.method.recorded_planes(self.scene)
    }

    /// A batch as bytes. Fails if there is not enough memory for the bytes.
    pub fn packed(&self, batch: &Batch) -> Result<Vec<u8>, Failure> {
        checkpoints::packed(&self.planes(), batch)
    }

    /// The batch with this number, decoded from the bytes of [`Self::packed`]. The batch
    /// is identical to the batch that `source` emits. Fails if the bytes belong to another scene,
    /// seed or number of photons.
    pub fn unpacked(
        &self,
        source: &dyn PhotonSource,
        number: u32,
        bytes: &[u8],
    ) -> Result<Batch, Failure> {
        let held = Held {
            seed: self.scene.run.seed,
            method: self.method,
            photons: source.emitted(number),
            batches: number..number.saturating_add(1),
        };
        checkpoints::unpacked(bytes, &held, &self.planes())
    }

    /// The first parts of a batch as bytes.
    pub(crate) fn packed_partial(&self, batch: &PartialBatch) -> Result<Packed, Failure> {
        let bytes = batch
            .sum
            .as_ref()
            .map_or(Ok(Vec::new()), |sum| self.packed(sum))?;
        let piece = Piece {
            number: batch.index,
            parts: Some(batch.parts),
            length: bytes.len(),
        };
        Ok((piece, bytes))
    }

    /// The first parts of a batch, decoded from the bytes of [`Self::packed_partial`].
    pub(crate) fn unpacked_partial(
        &self,
        source: &dyn PhotonSource,
        piece: &Piece,
        bytes: &[u8],
    ) -> Result<PartialBatch, Failure> {
        let index = piece.number;
        let Some(parts) = piece.parts.filter(|parts| *parts > 0) else {
            return Ok(PartialBatch::new(index));
        };
        let sum = Some(self.unpacked(source, index, bytes)?);
        Ok(PartialBatch { index, parts, sum })
    }
}
