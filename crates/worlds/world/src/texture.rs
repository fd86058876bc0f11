//! Textures: numbers that vary over a surface.

use crate::mesh_values::MeshValues;
use crate::texture_point::TexturePoint;
use etendue_field::Raster;
use glam::{DAffine2, DVec2};
use std::sync::Arc;

/// A number that may vary over a surface. It is a function of the texture coordinates (u, v), or of
/// the place on a triangle of a mesh.
#[derive(Clone, Debug)]
pub enum Texture {
    /// A constant.
    Constant(f64),
    /// Alternating squares of half a unit. The first number applies where both components of (u, v)
    /// mod 1 are below ½ or both are above ½.
    Checkerboard {
        /// The map from the (u, v) of the surface to the (u, v) of the checkerboard.
        to_uv: DAffine2,
        /// Both numbers.
        values: [f64; 2],
    },
    /// A picture.
    Bitmap(Bitmap),
    /// Numbers of the vertices or of the triangles of a mesh. Only surfaces with this mesh have
    /// such a texture.
    OfMesh(MeshValues),
}

/// A picture over the unit square of texture coordinates. The first pixel is at the top left. From
/// there, u increases to the right and v increases downwards.
#[derive(Clone, Debug)]
pub struct Bitmap {
    /// The map from the (u, v) of the surface to the (u, v) of the picture.
    pub to_uv: DAffine2,
    /// Its pixels.
    pub pixels: Arc<Raster>,
    /// The values of the picture beyond its edges.
    pub wrap: Wrap,
    /// The interpolation between pixel centres.
    pub filter: Filter,
}

/// How a picture continues beyond its edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// Repeated.
    Repeat,
    /// Repeated with alternating mirror images.
    Mirror,
    /// Each place beyond an edge has the value of the nearest pixel.
    Clamp,
}

/// The interpolation between pixel centres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// Bilinear interpolation.
    Bilinear,
    /// The nearest pixel.
    Nearest,
}

impl Texture {
    /// The value at a point of the surface.
    #[inline]
    #[must_use]
    pub fn value(&self, point: &TexturePoint) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Checkerboard { to_uv, values } => {
                let at = to_uv.transform_point2(point.uv);
                let is_low = |x: f64| x - x.floor() < 0.5;
                values[usize::from(is_low(at.x) != is_low(at.y))]
            }
            Self::Bitmap(bitmap) => bitmap.value(point.uv),
            Self::OfMesh(values) => values.value(point),
        }
    }

    /// Its largest value.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.extreme(0.0, f64::max)
    }

    /// Its smallest value.
    #[must_use]
    pub fn smallest(&self) -> f64 {
        self.extreme(f64::INFINITY, f64::min)
    }

    fn extreme(&self, start: f64, of: fn(f64, f64) -> f64) -> f64 {
        let all = match self {
            Self::Constant(value) => return *value,
            Self::Checkerboard { values, .. } => return of(values[0], values[1]),
            Self::Bitmap(bitmap) => bitmap.pixels.values(),
            Self::OfMesh(values) => values.values(),
        };
        all.iter().copied().fold(start, of)
    }
}

impl Bitmap {
    fn value(&self, uv: DVec2) -> f64 {
        let [w, h] = [self.pixels.width(), self.pixels.height()];
        let at = self.to_uv.transform_point2(uv) * DVec2::new(w as f64, h as f64);
        let pixel = |x: i64, y: i64| {
            let (x, y) = (self.wrap.index(x, w), self.wrap.index(y, h));
            self.pixels.values()[y * w + x]
        };
        match self.filter {
            Filter::Nearest => pixel(whole(at.x), whole(at.y)),
            Filter::Bilinear => {
                let at = at - 0.5;
                let (x, y) = (whole(at.x), whole(at.y));
                let share = at - at.floor();
                let row = |y| pixel(x, y) * (1.0 - share.x) + pixel(x + 1, y) * share.x;
                row(y) * (1.0 - share.y) + row(y + 1) * share.y
            }
        }
    }
}

/// The index of a pixel, before it is wrapped; very large texture coordinates are clamped.
#[expect(clippy::cast_possible_truncation, reason = "the value is clamped")]
fn whole(x: f64) -> i64 {
    x.floor().clamp(-1e15, 1e15) as i64
}

impl Wrap {
    fn index(self, i: i64, count: usize) -> usize {
        let n = i64::try_from(count).unwrap_or(i64::MAX);
        let inside = match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Clamp => i.clamp(0, n - 1),
            Self::Mirror => {
                let twice = i.rem_euclid(2 * n);
                twice.min(2 * n - 1 - twice)
            }
        };
        usize::try_from(inside).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_go_on_beyond_their_edges() {
        let pixels = Arc::new(Raster::new(3, 1, vec![1.0, 2.0, 4.0]).unwrap());
        let at = |wrap, filter, u| {
            let (to_uv, pixels) = (DAffine2::IDENTITY, Arc::clone(&pixels));
            let bitmap = Bitmap {
                to_uv,
                pixels,
                wrap,
                filter,
            };
            Texture::Bitmap(bitmap).value(&DVec2::new(u / 3.0, 0.5).into())
        };
        for (wrap, u, nearest) in [
            (Wrap::Repeat, 3.5, 1.0),
            (Wrap::Repeat, -0.5, 4.0),
            (Wrap::Mirror, 3.5, 4.0),
            (Wrap::Mirror, -1.5, 2.0),
            (Wrap::Clamp, 7.5, 4.0),
            (Wrap::Clamp, -7.5, 1.0),
        ] {
            // The tolerance covers the rounding error of u / 3.
            assert!(
                (at(wrap, Filter::Nearest, u) - nearest).abs() < 1e-12,
                "{wrap:?} {u}"
            );
        }
        assert!((at(Wrap::Clamp, Filter::Bilinear, 1.0) - 1.5).abs() < 1e-12);
        assert!((at(Wrap::Repeat, Filter::Bilinear, 3.0) - 2.5).abs() < 1e-12);
    }

    #[test]
    fn checkerboards_begin_with_the_first_number() {
        let board = Texture::Checkerboard {
            to_uv: DAffine2::IDENTITY,
            values: [0.4, 0.2],
        };
        for (u, v, value) in [
            (0.1, 0.1, 0.4),
            (0.6, 0.1, 0.2),
            (0.6, 0.9, 0.4),
            (-0.1, 0.2, 0.2),
        ] {
            // The tolerance admits only equal values.
            assert!(
                (board.value(&DVec2::new(u, v).into()) - value).abs() < 1e-300,
                "({u}, {v})"
            );
        }
    }
}
