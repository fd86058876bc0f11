//! Numbers of points at which variances are predicted and found.

use crate::variance::sampler::MAX_POINTS;
use std::str::FromStr;

/// The largest number of numbers of points.
pub const MAX_COUNTS: usize = 64;

/// Numbers of points, ascending: 1 to [`MAX_COUNTS`] different numbers from 2 to [`MAX_POINTS`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PointCounts(Vec<usize>);

impl PointCounts {
    /// Sorts numbers of points and removes repetitions. Returns `None` if there are none or too
    /// many, or if one is outside its range.
    #[must_use]
    pub fn new(mut counts: Vec<usize>) -> Option<Self> {
        counts.sort_unstable();
        counts.dedup();
        let is_allowed = (1..=MAX_COUNTS).contains(&counts.len())
            && counts.iter().all(|n| (2..=MAX_POINTS).contains(n));
        is_allowed.then_some(Self(counts))
    }

    /// The numbers of points.
    #[must_use]
    pub fn all(&self) -> &[usize] {
        &self.0
    }
}

/// The numbers of points 4, 16, 64, 256, 1024 and 4096.
impl Default for PointCounts {
    fn default() -> Self {
        Self([4, 16, 64, 256, 1024, 4096].to_vec())
    }
}

impl FromStr for PointCounts {
    type Err = String;

    /// Parses A..B, which stands for A, 4A, 16A, ... up to B, or A,B,C.
    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<usize>().ok();
        let counts = if let Some((first, last)) = text.split_once("..") {
            let ends = number(first).zip(number(last));
            ends.filter(|(first, last)| *first > 0 && *last <= MAX_POINTS)
                .map(|(first, last)| {
                    let all = std::iter::successors(Some(first), |n| n.checked_mul(4));
                    all.take_while(|n| *n <= last).collect()
                })
        } else {
            text.split(',').map(number).collect()
        };
        counts.and_then(Self::new).ok_or_else(|| {
            format!(
                "must be A..B, such as 4..4096, or a list, such as 16,81,256, of numbers from 2 to {MAX_POINTS}"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_points_are_ranges_or_lists() {
        let of = |text: &str| text.parse::<PointCounts>().map(|counts| counts.0);
        assert_eq!(of("4..4096"), Ok(PointCounts::default().0));
        assert_eq!(of("16..100"), Ok(vec![16, 64]));
        assert_eq!(of("81, 16,16"), Ok(vec![16, 81]));
        for text in [
            "1..16", "0..16", "16..4", "4..65537", "4..", "", "4,x", "-4",
        ] {
            assert!(of(text).unwrap_err().contains("from 2 to 65536"), "{text}");
        }
        assert_eq!(PointCounts::new((2..=66).collect()), None);
    }
}
