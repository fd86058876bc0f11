//! Formatting of numbers for readers, and conversion to whole numbers.

/// The shortest text that is accurate to twelve significant digits, which omits the digits
/// that contain rounding errors.
#[must_use]
pub fn tidy(x: f64) -> String {
    let rounded: f64 = format!("{x:.11e}").parse().unwrap_or(x);
    // Adding 0 turns −0 into 0.
    (rounded + 0.0).to_string()
}

/// A text with at most seven significant digits. If many zeros would hide the digits, the
/// text has a power of ten.
#[must_use]
pub fn brief(x: f64) -> String {
    let rounded: f64 = format!("{x:.6e}").parse().unwrap_or(x);
    let size = rounded.abs();
    if size == 0.0 || (1e-4..1e7).contains(&size) || !size.is_finite() {
        tidy(rounded)
    } else {
        format!("{rounded:e}")
    }
}

/// Formats a share in per cent, to `places` decimals. If this would give fewer than two digits, the
/// text has more decimals.
#[must_use]
pub fn percent(share: f64, places: usize) -> String {
    let percent = 100.0 * share;
    let places = if percent == 0.0 || !percent.is_finite() {
        places
    } else {
        places.max(decimals(percent.abs()))
    };
    fixed(percent, places) + " %"
}

/// Formats a number with a given number of decimals; the text is never −0.
#[must_use]
pub fn fixed(value: f64, places: usize) -> String {
    let text = format!("{value:.places$}");
    let is_zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
    if is_zero { text.replace('-', "") } else { text }
}

/// The number of decimals that shows two digits of a number above 0.
#[must_use]
pub fn decimals(x: f64) -> usize {
    whole((1.0 - libm::log10(x).floor()).clamp(0.0, 17.0))
}

/// Errors below this limit are written with a power of ten. In a decimal number, zeros would hide
/// their digits.
const MIN_PLAIN_ERROR: f64 = 1e-8;

/// Formats value ± error, to two digits of the error.
#[must_use]
pub fn uncertain(value: f64, error: f64) -> String {
    if !(error > 0.0 && error.is_finite()) {
        return format!("{value}");
    }
    let places = decimals(error);
    if error >= MIN_PLAIN_ERROR {
        return format!("{} ± {error:.places$}", fixed(value, places));
    }
    if value.abs() >= MIN_PLAIN_ERROR.sqrt() {
        return format!("{} ± {error:.1e}", fixed(value, places));
    }
    let [size, least] = [value.abs(), error].map(|x| libm::log10(x).floor());
    let digits = whole(size - least + 1.0).max(1);
    format!("{value:.digits$e} ± {error:.1e}")
}

/// The whole part of a number. The result is 0 for negative numbers and NaN, and saturates
/// at the largest value of the type.
#[inline]
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the function returns the whole part"
)]
pub fn whole(x: f64) -> usize {
    x as usize
}

/// Returns sin(πf)/(πf), which is the transform of a box of width 1. The value at zero is 1.
#[must_use]
pub fn sinc(f: f64) -> f64 {
    let t = std::f64::consts::PI * f;
    if t.abs() < 1e-9 {
        1.0
    } else {
        libm::sin(t) / t
    }
}

/// Formats 10000000 as 10 000 000.
#[must_use]
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let groups: Vec<&str> = digits
        .as_bytes()
        .rchunks(3)
        .rev()
        .map(|group| std::str::from_utf8(group).unwrap_or_default())
        .collect();
    groups.join(" ")
}

/// Formats 1.25e9 as 1.2 GB, in the largest of MB, GB, TB and PB that is not above the number.
#[must_use]
pub fn byte_size(bytes: f64) -> String {
    let mut units = ["MB", "GB", "TB", "PB"].iter().zip([1e6, 1e9, 1e12, 1e15]);
    let found = units.rfind(|(_, unit)| bytes >= *unit);
    let (name, unit) = found.unwrap_or((&"MB", 1e6));
    format!("{:.1} {name}", bytes / unit)
}

#[cfg(test)]
mod tests {
    use super::{brief, percent, tidy, uncertain};

    #[test]
    fn texts_for_people_are_short() {
        assert_eq!(brief(40.0 / 3.0), "13.33333");
        assert_eq!(brief(1.0), "1");
        assert_eq!(brief(-0.0), "0");
        assert_eq!(brief(-3.000_2e-12), "-3.0002e-12");
        assert_eq!(brief(2e7), "2e7");
        assert_eq!(uncertain(9e-17, 8.5e-16), "9.0e-17 ± 8.5e-16");
        assert_eq!(uncertain(0.0, 8.5e-16), "0.0e0 ± 8.5e-16");
        assert_eq!(
            uncertain(-0.962_242_323_7, 1.9e-9),
            "-0.9622423237 ± 1.9e-9"
        );
        assert_eq!(
            uncertain(1.234_567_89e-5, 2.1e-12),
            "1.23456789e-5 ± 2.1e-12"
        );
        assert_eq!(uncertain(0.199_999_56, 8.5e-7), "0.19999956 ± 0.00000085");
    }

    #[test]
    fn shares_have_two_digits_at_least() {
        assert_eq!(percent(0.00472, 3), "0.472 %");
        assert_eq!(percent(-0.25, 3), "-25.000 %");
        assert_eq!(percent(2.9e-6, 3), "0.00029 %");
        assert_eq!(percent(0.001, 2), "0.10 %");
        assert_eq!(percent(-0.0, 3), "0.000 %");
        assert_eq!(percent(f64::INFINITY, 3), "inf %");
        assert_eq!(percent(1e-300, 2), "0.00000000000000000 %");
    }

    #[test]
    fn what_arithmetic_leaves_is_not_shown() {
        assert_eq!(tidy(2.7 - 2.0), "0.7");
        assert_eq!(tidy(-0.0), "0");
        assert_eq!(tidy(-1e-9 / 3.0), "-0.000000000333333333333");
        assert_eq!(tidy(1e9 + 0.25), "1000000000.25");
        assert_eq!(tidy(f64::NAN), "NaN");
    }
}
