//! Numbers on a grid of pixels.

use serde::Serialize;

/// Numbers on a grid of pixels, row by row from the top, each row from the left.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Raster {
    width: usize,
    height: usize,
    #[serde(skip)]
    values: Vec<f64>,
}

impl Raster {
    /// The raster, or `None` if there is no pixel or if the number of values differs from
    /// the number of pixels.
    #[must_use]
    pub fn new(width: usize, height: usize, values: Vec<f64>) -> Option<Self> {
        let fits = !values.is_empty() && width.checked_mul(height) == Some(values.len());
        fits.then_some(Self {
            width,
            height,
            values,
        })
    }

    /// The number of pixels in a row.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// The number of rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// The values of all pixels.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The four pixels whose centres surround a position. Also returns the weights of these
    /// pixels in bilinear interpolation.
    ///
    /// Positions are in pixels from the left and from the top edge: the centre of the first pixel
    /// is at (½, ½). Beyond the outermost centres, the nearest pixel is used. If the raster
    /// `wraps`, its columns are periodic.
    #[inline]
    #[must_use]
    pub fn around(&self, column: f64, row: f64, wraps: bool) -> [(usize, f64); 4] {
        let ([left, right], across) = neighbours(column, self.width, wraps);
        let ([above, below], down) = neighbours(row, self.height, false);
        [
            (above * self.width + left, (1.0 - down) * (1.0 - across)),
            (above * self.width + right, (1.0 - down) * across),
            (below * self.width + left, down * (1.0 - across)),
            (below * self.width + right, down * across),
        ]
    }

    /// The bilinear interpolation at a position, see [`Self::around`].
    #[inline]
    #[must_use]
    pub fn value(&self, column: f64, row: f64, wraps: bool) -> f64 {
        let around = self.around(column, row, wraps).into_iter();
        around
            .map(|(pixel, share)| share * self.values[pixel])
            .sum()
    }
}

/// The two pixels, in a row of `count` pixels, whose centres surround a position. Also
/// returns the weight of the second pixel.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the number of a pixel, already limited to the range"
)]
fn neighbours(place: f64, count: usize, wraps: bool) -> ([usize; 2], f64) {
    let last = count - 1;
    let place = place - 0.5;
    if wraps {
        let place = place.rem_euclid(count as f64);
        let first = (place.floor() as usize).min(last);
        let second = if first == last { 0 } else { first + 1 };
        return ([first, second], (place - first as f64).clamp(0.0, 1.0));
    }
    let place = place.clamp(0.0, last as f64);
    let first = (place.floor() as usize).min(last);
    ([first, (first + 1).min(last)], place - first as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_those_between_centres() {
        let raster = Raster::new(3, 2, vec![1.0, 2.0, 4.0, 10.0, 20.0, 40.0]).unwrap();
        for (column, row, wraps, expected) in [
            (0.5, 0.5, false, 1.0),
            (1.0, 0.5, false, 1.5),
            (2.0, 1.0, false, 16.5),
            (-3.0, 9.0, false, 10.0),
            (0.0, 0.5, false, 1.0),
            (0.0, 0.5, true, 2.5),
            (3.0, 0.0, true, 2.5),
            (-0.25, 1.5, true, 32.5),
        ] {
            let found = raster.value(column, row, wraps);
            // The limit is the rounding error.
            assert!((found - expected).abs() < 1e-13, "{column} {row}: {found}");
        }
        assert!(Raster::new(3, 2, vec![1.0; 5]).is_none());
        assert!(Raster::new(0, 0, vec![]).is_none());
    }
}
