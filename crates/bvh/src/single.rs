//! Single-precision numbers, used to find candidates.

#[inline]
#[expect(
    clippy::cast_possible_truncation,
    reason = "f32 is used only to find candidates, and padding covers its rounding errors"
)]
pub(crate) fn single(x: f64) -> f32 {
    x as f32
}
