//! What a surface does to light, in a word.

use etendue_field::Lobe;

/// What a surface does to light, in a word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflects {
    /// It is black from here.
    Nothing,
    /// It sends light alike to all directions.
    Diffuse,
    /// It sends light one way.
    Mirror,
    /// It has a lobe about the mirror direction, perhaps above a diffuse base.
    Lobe(Lobe),
}
