//! Sums in comments of the form `stat:sum:KEY:VALUE`. When files are merged, these sums are added
//! (MCPL 2.1).

use crate::Fault;
use std::collections::BTreeSet;

const START: &str = "stat:sum:";
/// Number of characters of a value, blanks included.
const WIDTH: usize = 24;
/// Largest number of characters of a key.
const LONGEST: usize = 64;

/// A sum.
#[derive(Clone, Debug, PartialEq)]
pub struct StatSum {
    /// Name of the counted quantity.
    pub key: String,
    /// Value of the sum, 0 or more; `None` if the file marks it as not available (−1).
    pub value: Option<f64>,
}

/// The comment that holds a sum. The value is written as the shortest decimal number that
/// reads as the same f64.
///
/// # Errors
/// When the key is not an identifier of at most 64 characters, or the value is negative or not
/// finite.
pub fn stat_sum_comment(key: &str, value: f64) -> Result<Vec<u8>, Fault> {
    let shown = value.to_string();
    // In exponential notation, the longest number has 23 characters.
    let shown = if shown.len() > WIDTH {
        format!("{value:e}")
    } else {
        shown
    };
    let comment = format!("{START}{key}:{shown:>WIDTH$}").into_bytes();
    parse(&comment)?;
    Ok(comment)
}

/// The sums among comments.
pub(super) fn sums(comments: &[Vec<u8>]) -> Result<Vec<StatSum>, Fault> {
    let mut keys = BTreeSet::new();
    let mut sums = Vec::new();
    for comment in comments.iter().filter(|c| c.starts_with(START.as_bytes())) {
        let sum = parse(comment)?;
        if !keys.insert(sum.key.clone()) {
            return Err(fault(comment, "another comment has the same key"));
        }
        sums.push(sum);
    }
    Ok(sums)
}

fn parse(comment: &[u8]) -> Result<StatSum, Fault> {
    let refused = |why| fault(comment, why);
    let text = std::str::from_utf8(comment).map_err(|_| refused("it is not UTF-8"))?;
    let rest = text.strip_prefix(START).unwrap_or_default();
    let (key, value) = rest
        .split_once(':')
        .ok_or_else(|| refused("a colon must stand between key and value"))?;
    if !is_identifier(key) {
        return Err(refused(
            "a key must be a letter followed by letters, digits or _, and have at most 64 characters",
        ));
    }
    if value.len() != WIDTH {
        return Err(refused("a value must have 24 characters, including blanks"));
    }
    let digits = value.trim_matches(' ');
    let decimal = digits
        .bytes()
        .all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b));
    let number: f64 = match digits.parse() {
        Ok(number) if decimal => number,
        _ => return Err(refused("the value of a key is not a decimal number")),
    };
    let value = match number {
        v if v.to_bits() == (-1.0_f64).to_bits() => None,
        v if v.is_finite() && v >= 0.0 => Some(v),
        _ => return Err(refused("a value must be 0 or more, or −1 if not known")),
    };
    let key = key.to_owned();
    Ok(StatSum { key, value })
}

fn is_identifier(key: &str) -> bool {
    key.len() <= LONGEST
        && key.starts_with(|c: char| c.is_ascii_alphabetic())
        && key.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

fn fault(comment: &[u8], why: &str) -> Fault {
    let shown: String = String::from_utf8_lossy(comment).chars().take(120).collect();
    Fault::file(format!("comment {shown:?}: {why}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_read_as_written() {
        for value in [0.0, 0.1, 1e300, 123_456_789.0, 5e-324, f64::MAX, 1.0 / 3.0] {
            let comment = stat_sum_comment("n_photons", value).unwrap();
            assert_eq!(comment.len(), "stat:sum:n_photons:".len() + WIDTH);
            assert_eq!(parse(&comment).unwrap().value, Some(value));
        }
    }

    #[test]
    fn malformed_sums_are_refused() {
        assert!(stat_sum_comment("1n", 1.0).is_err());
        assert!(stat_sum_comment("n", -2.0).is_err());
        assert!(stat_sum_comment("n", f64::NAN).is_err());
        assert!(parse(b"stat:sum:n:1").is_err());
        assert!(parse(b"stat:sum:n:                     inf").is_err());
        let twice = vec![stat_sum_comment("n", 1.0).unwrap(); 2];
        assert!(sums(&twice).is_err());
    }
}
