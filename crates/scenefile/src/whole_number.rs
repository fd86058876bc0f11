//! Recognises whole numbers among doubles.

/// A number as an integer, if it is a whole number.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the number was checked to be a whole number below 2^53"
)]
pub(crate) fn whole(x: f64) -> Option<u64> {
    let small = (0.0..9_007_199_254_740_992.0).contains(&x);
    (small && x.fract() == 0.0).then_some(x as u64)
}
