//! Numbers as people read them, and whole parts.

/// The shortest text that is right to twelve significant digits: without the last digits that arithmetic leaves.
#[must_use]
pub fn tidy(x: f64) -> String {
    let rounded: f64 = format!("{x:.11e}").parse().unwrap_or(x);
    // Adding 0 turns −0 into 0.
    (rounded + 0.0).to_string()
}

/// The whole part of a number: 0 of negative ones and of NaN, the largest there is beyond.
#[inline]
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "what is asked for is the whole part"
)]
pub fn whole(x: f64) -> usize {
    x as usize
}

#[cfg(test)]
mod tests {
    use super::tidy;

    #[test]
    fn what_arithmetic_leaves_is_not_shown() {
        assert_eq!(tidy(2.7 - 2.0), "0.7");
        assert_eq!(tidy(-0.0), "0");
        assert_eq!(tidy(-1e-9 / 3.0), "-0.000000000333333333333");
        assert_eq!(tidy(1e9 + 0.25), "1000000000.25");
        assert_eq!(tidy(f64::NAN), "NaN");
    }
}
