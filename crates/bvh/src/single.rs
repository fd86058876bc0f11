//! Single-precision numbers, used to find candidates.

#[inline]
#[expect(
    clippy::cast_possible_truncation,
    reason = "f32 only names candidates; padding covers its rounding"
)]
pub(crate) fn single(x: f64) -> f32 {
    x as f32
}
