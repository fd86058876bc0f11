//! The kind of reflection of a surface.

use etendue_field::Lobe;

/// The kind of reflection of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflects {
    /// The surface is black on this side.
    Nothing,
    /// Diffuse.
    Diffuse,
    /// A mirror.
    Mirror,
    /// A lobe around the mirror direction, possibly above a diffuse base.
    Lobe(Lobe),
}
