//! The samplers, their names, and the numbers of points that they can have.

use std::fmt;
use std::sync::Arc;

/// The largest number of points of a set.
pub const MAX_POINTS: usize = 1 << 16;

/// The four coordinates of a window in the order (x, u, y, v), each from 0 at −h to 1 at +h.
pub type WindowPoint = [f64; 4];

/// A method that places N points in the window of a plane.
#[derive(Clone, Debug, PartialEq)]
pub enum Sampler {
    /// Independent points.
    Independent,
    /// One point in each of n⁴ equal cells; N = n⁴.
    Jitter,
    /// Latin hypercube: along each axis, one point in each of N intervals.
    LatinHypercube,
    /// The first N points of a Sobol' net with Owen's scrambling; N is a power of two.
    Sobol,
    /// Two jittered sets in two dimensions, whose points are paired at random; N is a square.
    Padded(AxisPairs),
    /// A set of points from a file.
    File(PointFile),
}

/// The two pairs of axes of a padded sampler. Each pair has a jittered set of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisPairs {
    /// (x, u) and (y, v).
    PositionWithSlope,
    /// (x, y) and (u, v).
    PositionAndSlope,
}

/// A set of points from a file, with a name for messages.
#[derive(Clone, Debug, PartialEq)]
pub struct PointFile {
    /// Name of the file.
    pub name: String,
    /// The points. They are shared, because they may be many.
    pub points: Arc<Vec<WindowPoint>>,
}

/// The reason why a file of points is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PointFileError {
    /// The set is empty or too large.
    #[error("it has {0} points; allowed: 2 to {MAX_POINTS}")]
    Count(usize),
    /// A coordinate is outside the window.
    #[error("point {point} has the coordinate {value}; allowed: numbers from 0 to below 1")]
    Coordinate {
        /// Number of the point, from 0.
        point: usize,
        /// The coordinate.
        value: f64,
    },
}

impl AxisPairs {
    /// The axes of both pairs, as indices into (x, u, y, v).
    #[must_use]
    pub fn axes(self) -> [[usize; 2]; 2] {
        match self {
            Self::PositionWithSlope => [[0, 1], [2, 3]],
            Self::PositionAndSlope => [[0, 2], [1, 3]],
        }
    }
}

impl PointFile {
    /// Checks a set of points.
    ///
    /// # Errors
    ///
    /// Fails if the set has fewer than 2 or more than [`MAX_POINTS`] points, or if a coordinate is
    /// outside \[0, 1).
    pub fn new(name: String, points: Vec<WindowPoint>) -> Result<Self, PointFileError> {
        if !(2..=MAX_POINTS).contains(&points.len()) {
            return Err(PointFileError::Count(points.len()));
        }
        for (i, point) in points.iter().enumerate() {
            if let Some(value) = point.iter().find(|z| !(0.0..1.0).contains(*z)) {
                return Err(PointFileError::Coordinate {
                    point: i,
                    value: *value,
                });
            }
        }
        Ok(Self {
            name,
            points: Arc::new(points),
        })
    }
}

impl Sampler {
    /// The names that [`named`](Self::named) knows.
    pub const NAMES: [&str; 5] = ["independent", "jitter", "lhs", "sobol", "padded"];

    /// The samplers with a name: one, or both padded samplers. Returns `None` if no sampler
    /// has this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Vec<Self>> {
        let padded = [AxisPairs::PositionWithSlope, AxisPairs::PositionAndSlope];
        Some(match name {
            "independent" => vec![Self::Independent],
            "jitter" => vec![Self::Jitter],
            "lhs" => vec![Self::LatinHypercube],
            "sobol" => vec![Self::Sobol],
            "padded" => padded.map(Self::Padded).to_vec(),
            _ => return None,
        })
    }

    /// Checks whether the sampler has sets of `count` points.
    #[must_use]
    pub fn allows(&self, count: usize) -> bool {
        let is_possible = (2..=MAX_POINTS).contains(&count);
        is_possible
            && match self {
                Self::Independent | Self::LatinHypercube => true,
                Self::Jitter => cells_per_axis(count, 4).is_some(),
                Self::Sobol => count.is_power_of_two(),
                Self::Padded(_) => cells_per_axis(count, 2).is_some(),
                Self::File(file) => file.points.len() == count,
            }
    }

    /// The number that selects the random numbers of the sampler's sets.
    pub(crate) fn number(&self) -> u64 {
        match self {
            Self::Independent => 0,
            Self::Jitter => 1,
            Self::LatinHypercube => 2,
            Self::Sobol => 3,
            Self::Padded(AxisPairs::PositionWithSlope) => 4,
            Self::Padded(AxisPairs::PositionAndSlope) => 5,
            Self::File(_) => 6,
        }
    }

    /// The numbers of points among `counts` that the sampler has. A file has only its own
    /// number of points.
    #[must_use]
    pub fn counts(&self, counts: &[usize]) -> Vec<usize> {
        match self {
            Self::File(file) => vec![file.points.len()],
            _ => counts.iter().copied().filter(|n| self.allows(*n)).collect(),
        }
    }
}

impl fmt::Display for Sampler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Independent => "independent",
            Self::Jitter => "jitter",
            Self::LatinHypercube => "lhs",
            Self::Sobol => "sobol",
            Self::Padded(AxisPairs::PositionWithSlope) => "padded xu+yv",
            Self::Padded(AxisPairs::PositionAndSlope) => "padded xy+uv",
            Self::File(file) => &file.name,
        })
    }
}

/// The four indices of an element of an array [n, n, n, n] in row-major order.
pub(crate) fn indices(element: usize, n: usize) -> [usize; 4] {
    [n * n * n, n * n, n, 1].map(|stride| element / stride % n)
}

/// Returns n if `count` is n to the power of `dimensions`.
pub(crate) fn cells_per_axis(count: usize, dimensions: u32) -> Option<usize> {
    (1..=count)
        .take_while(|n| n.pow(dimensions) <= count)
        .find(|n| n.pow(dimensions) == count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samplers_have_the_counts_that_their_cells_need() {
        let all: Vec<usize> = (2..=300).collect();
        assert_eq!(Sampler::Jitter.counts(&all), [16, 81, 256]);
        assert_eq!(Sampler::Sobol.counts(&all), [2, 4, 8, 16, 32, 64, 128, 256]);
        let padded = Sampler::Padded(AxisPairs::PositionAndSlope).counts(&all);
        assert_eq!(padded.len(), 16);
        assert_eq!(Sampler::LatinHypercube.counts(&all), all);
        assert!(!Sampler::Independent.allows(1) && !Sampler::Independent.allows(MAX_POINTS + 1));
    }

    #[test]
    fn samplers_have_names() {
        let all: Vec<Sampler> = Sampler::NAMES
            .into_iter()
            .flat_map(|name| Sampler::named(name).unwrap())
            .collect();
        assert_eq!(all.len(), 6);
        assert_eq!(all[3], Sampler::Sobol);
        assert_eq!(Sampler::named("halton"), None);
    }

    #[test]
    fn files_have_points_in_the_window() {
        let file = |points| PointFile::new("set".to_owned(), points);
        let set = file(vec![[0.0; 4], [0.5; 4], [0.25; 4]]).unwrap();
        assert_eq!(Sampler::File(set).counts(&[4, 16]), [3]);
        assert_eq!(file(vec![[0.0; 4]]), Err(PointFileError::Count(1)));
        let error = file(vec![[0.0; 4], [0.0, 1.0, 0.0, 0.0]]).unwrap_err();
        assert!(error.to_string().contains("point 1 has the coordinate 1;"));
        assert!(file(vec![[f64::NAN; 4]; 2]).is_err());
    }
}
