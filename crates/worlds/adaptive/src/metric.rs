//! Defines symmetric matrices that state the bandwidth of light along directions of the picture.

/// A symmetric 2 × 2 matrix over the picture, in units of 1/pixel². Columns count to the right, and
/// rows count downwards.
///
/// The matrix of a criterion gives the squared bandwidth along each direction, in cycles per pixel.
/// The matrix of samples defines distances. Measured in this way, neighbouring samples are about 1
/// apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Metric {
    /// The diagonal entry for steps along columns.
    pub(crate) xx: f64,
    /// The mixed entry.
    pub(crate) xy: f64,
    /// The diagonal entry for steps along rows.
    pub(crate) yy: f64,
}

impl Metric {
    /// An isotropic metric.
    pub(crate) fn even(square: f64) -> Self {
        Self {
            xx: square,
            xy: 0.0,
            yy: square,
        }
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            xx: self.xx + other.xx,
            xy: self.xy + other.xy,
            yy: self.yy + other.yy,
        }
    }

    pub(crate) fn times(self, factor: f64) -> Self {
        Self {
            xx: factor * self.xx,
            xy: factor * self.xy,
            yy: factor * self.yy,
        }
    }

    /// The squared length of a step.
    pub(crate) fn square(&self, [x, y]: [f64; 2]) -> f64 {
        x * (self.xx * x + self.xy * y) + y * (self.xy * x + self.yy * y)
    }

    pub(crate) fn determinant(&self) -> f64 {
        self.xx * self.yy - self.xy * self.xy
    }

    /// The larger eigenvalue.
    pub(crate) fn largest(&self) -> f64 {
        let (mean, off) = (0.5 * (self.xx + self.yy), 0.5 * (self.xx - self.yy));
        mean + (off * off + self.xy * self.xy).sqrt()
    }

    /// All steps up to the length `radius` fill an ellipse. Returns half of its extents along
    /// columns and rows.
    pub(crate) fn reach(&self, radius: f64) -> [f64; 2] {
        let determinant = self.determinant();
        [self.yy, self.xx].map(|across| radius * (across / determinant).sqrt())
    }

    /// A metric that is changed towards an isotropic metric, so that the lengths of a step
    /// in different directions differ by at most a factor of `most`.
    pub(crate) fn rounder(self, most: f64) -> Self {
        let large = self.largest();
        let small = self.xx + self.yy - large;
        let wanted = large / (most * most);
        // An isotropic metric is added, which makes the sum rounder.
        let added = (wanted - small) / (1.0 - (most * most).recip());
        self.plus(Self::even(added.max(0.0)))
    }
}
