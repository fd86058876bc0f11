//! Environment lights: light from infinity.

use crate::{Frame, Raster};
use glam::DVec3;
use serde::{Serialize, Serializer};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Light from infinity: radiance that depends on direction alone.
///
/// Environments shine forward, because a ray in two-plane coordinates has the direction (u, v, 1).
/// Light that would travel against the central ray is left out, even if the map contains it. The
/// light begins in the plane that is perpendicular to the central ray at the ray's start. Nothing
/// behind this plane occludes the light.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Environment {
    /// The axes of the map, in the coordinates of the frame at the light. Y points up, D points to
    /// the front, and X = Y × D.
    pub frame: Frame,
    /// The radiance in each direction.
    pub map: EnvironmentMap,
}

/// Radiance as a function of the direction that light comes from, in the coordinates of an
/// [`Environment`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum EnvironmentMap {
    /// A sum of lobes.
    Lobes(Vec<SphericalGaussian>),
    /// A picture of all directions.
    LatLong(#[serde(serialize_with = "shared")] Arc<LatLong>),
}

/// A lobe of light: L exp((cos γ − 1)/σ²), where γ is the angle to the direction of maximum
/// radiance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SphericalGaussian {
    /// The direction from which most of the light comes, of unit length.
    pub from: DVec3,
    /// Peak radiance L, W m⁻² sr⁻¹.
    pub radiance: f64,
    /// Width σ, radians.
    pub width: f64,
}

/// Radiance on a grid over latitude and longitude, W m⁻² sr⁻¹. Radiance is bilinear between the
/// centres of pixels and periodic in longitude. From the centre of the first or the last row to the
/// nearest pole, radiance is constant along the meridian.
///
/// The axes are the same as in `OpenEXR`'s latitude–longitude maps. The top is up (Y), at latitude
/// π/2. The middle of the map is at longitude 0, which is the front (Z). Longitude grows to the
/// left, and π/2 is along X, so the map shows the sphere of directions from inside. A pixel is an
/// area, as in other renderers. In a map of w columns and h rows, the centre of column i is at
/// longitude π (1 − (2 i + 1)/w), and the centre of row j is at latitude π (½ − (j + ½)/h). In
/// Mitsuba 3, the centres of the first and the last row are at the poles instead, and the centre of
/// row j is at latitude π (½ − j/(h − 1)).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LatLong {
    radiance: Raster,
    /// Positions of the poles on the raster, in pixels from the top.
    #[serde(skip)]
    poles: [f64; 2],
}

fn shared<S: Serializer>(map: &Arc<LatLong>, serializer: S) -> Result<S::Ok, S::Error> {
    map.as_ref().serialize(serializer)
}

impl Environment {
    /// The radiance of light that travels along a direction of any length, in the
    /// coordinates of the frame at the light.
    #[inline]
    #[must_use]
    pub fn radiance(&self, along: DVec3) -> f64 {
        self.map.radiance(self.origin_of(along))
    }

    /// The direction from which light comes if it travels along `along`. The result has
    /// unit length and is in the coordinates of the map.
    #[inline]
    #[must_use]
    pub fn origin_of(&self, along: DVec3) -> DVec3 {
        -self.frame.vector_to_local(along).normalize()
    }
}

impl EnvironmentMap {
    /// The radiance of light that comes from a direction of unit length.
    #[inline]
    #[must_use]
    pub fn radiance(&self, from: DVec3) -> f64 {
        match self {
            Self::Lobes(lobes) => lobes.iter().map(|lobe| lobe.radiance_from(from)).sum(),
            Self::LatLong(map) => map.radiance(from),
        }
    }
}

impl SphericalGaussian {
    /// The radiance of the lobe from a direction of unit length.
    #[inline]
    #[must_use]
    pub fn radiance_from(&self, from: DVec3) -> f64 {
        // The value is 1 − cos γ, without cancellation for small γ.
        let fall = 0.5 * (from - self.from).length_squared();
        self.radiance * libm::exp(-fall / (self.width * self.width))
    }

    /// The integral of the lobe over all directions, 2π σ² (1 − exp(−2/σ²)) L.
    #[must_use]
    pub fn integral(&self) -> f64 {
        let squared = self.width * self.width;
        -TAU * squared * libm::expm1(-2.0 / squared) * self.radiance
    }
}

impl LatLong {
    /// The map of a picture.
    #[must_use]
    pub fn new(radiance: Raster) -> Self {
        let poles = [0.0, radiance.height() as f64];
        Self { radiance, poles }
    }

    /// The map of a picture in which the centres of the first and the last row are at the
    /// poles.
    #[must_use]
    pub fn from_pole_to_pole(radiance: Raster) -> Self {
        let height = radiance.height() as f64;
        // A single row covers all latitudes.
        let half = if height > 1.0 { 0.5 } else { 0.0 };
        let poles = [half, height - half];
        Self { radiance, poles }
    }

    /// A map of at least one pixel. The value of each pixel is `radiance` at the direction
    /// of the pixel's centre.
    #[must_use]
    pub fn from_fn(width: usize, height: usize, radiance: impl Fn(DVec3) -> f64) -> Self {
        let (width, height) = (width.max(1), height.max(1));
        let pixels = (0..width * height).map(|i| {
            let place = [(i % width) as f64 + 0.5, (i / width) as f64 + 0.5];
            radiance(toward(width as f64, [0.0, height as f64], place))
        });
        let raster = Raster::new(width, height, pixels.collect());
        Self::new(raster.unwrap_or_else(|| unreachable!("one value for each pixel")))
    }

    /// The radiance of the pixels.
    #[must_use]
    pub fn raster(&self) -> &Raster {
        &self.radiance
    }

    /// The distances of the upper and the lower pole from the top of the raster, in pixels.
    #[must_use]
    pub fn poles(&self) -> [f64; 2] {
        self.poles
    }

    /// The position of a direction on the raster, in pixels from the left and from the top.
    #[inline]
    #[must_use]
    pub fn place(&self, from: DVec3) -> [f64; 2] {
        let longitude = libm::atan2(from.x, from.z);
        let latitude = libm::atan2(from.y, libm::hypot(from.x, from.z));
        let width = self.radiance.width() as f64;
        let [top, bottom] = self.poles;
        let down = (bottom - top) * (0.5 - latitude / PI);
        [width * (0.5 - longitude / TAU), top + down]
    }

    /// The direction of a position on the raster, of unit length.
    #[inline]
    #[must_use]
    pub fn direction(&self, place: [f64; 2]) -> DVec3 {
        toward(self.radiance.width() as f64, self.poles, place)
    }

    /// The radiance of light that comes from a direction.
    #[inline]
    #[must_use]
    pub fn radiance(&self, from: DVec3) -> f64 {
        let [column, row] = self.place(from);
        self.radiance.value(column, row, true)
    }
}

/// The direction of a position on a raster with the given width and poles.
fn toward(width: f64, [top, bottom]: [f64; 2], [column, row]: [f64; 2]) -> DVec3 {
    let longitude = TAU * (0.5 - column / width);
    let latitude = PI * (0.5 - (row - top) / (bottom - top));
    let (up, across) = libm::sincos(latitude);
    let (x, z) = libm::sincos(longitude);
    DVec3::new(across * x, up, across * z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tests the axes of `OpenEXR`: up is at the top, +X (longitude π/2) is a quarter of the width
    /// from the left, and +Z is in the middle.
    #[test]
    fn the_map_is_seen_from_within() {
        let map = LatLong::from_fn(8, 4, |_| 1.0);
        for (direction, place) in [
            (DVec3::Y, [4.0, 0.0]),
            (DVec3::NEG_Y, [4.0, 4.0]),
            (DVec3::X, [2.0, 2.0]),
            (DVec3::Z, [4.0, 2.0]),
            (DVec3::NEG_X, [6.0, 2.0]),
        ] {
            // The limit is the rounding error of angles.
            assert!((map.direction(place) - direction).length() < 1e-15);
            let [column, row] = map.place(direction);
            assert!((column - place[0]).abs() + (row - place[1]).abs() < 1e-14); // rounding
        }
        let map = LatLong::from_pole_to_pole(Raster::new(8, 4, vec![1.0; 32]).unwrap());
        for (direction, row) in [(DVec3::Y, 0.5), (DVec3::X, 2.0), (DVec3::NEG_Y, 3.5)] {
            let [column, found] = map.place(direction);
            assert!((found - row).abs() < 1e-14); // rounding
            assert!((map.direction([column, row]) - direction).length() < 1e-15);
        }
        let radiance = |d: DVec3| 2.0 + d.x + 0.5 * d.y;
        let map = LatLong::from_fn(64, 32, radiance);
        let d = DVec3::new(0.3, -0.8, 0.4).normalize();
        // The error is an eighth of the square of a pixel's side, 0.1, times the second
        // derivatives.
        assert!((map.radiance(d) - radiance(d)).abs() < 3e-3);
    }

    #[test]
    fn environments_turn_with_their_frame() {
        let lobe = SphericalGaussian {
            from: DVec3::Z,
            radiance: 2.0,
            width: 0.3,
        };
        let frame = Frame::new(DVec3::ZERO, DVec3::X, DVec3::Y).unwrap();
        let environment = Environment {
            frame,
            map: EnvironmentMap::Lobes(vec![lobe]),
        };
        // Light that comes from along +X travels along −X.
        assert!((environment.radiance(DVec3::new(-3.0, 0.0, 0.0)) - 2.0).abs() < 1e-15);
        let aside =
            environment.radiance(DVec3::new(-(libm::cos(0.1_f64)), libm::sin(0.1_f64), 0.0));
        let expected = 2.0 * libm::exp((libm::cos(0.1_f64) - 1.0) / 0.09);
        assert!((aside - expected).abs() < 1e-14); // rounding of unit vectors
        // The integral over the sphere by the midpoint rule in cos γ has an error of (step/σ²)²/24.
        let n = 20_000;
        let sum: f64 = (0..n)
            .map(|i| {
                let cosine = (f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0;
                2.0 * libm::exp((cosine - 1.0) / 0.09) * TAU * 2.0 / f64::from(n)
            })
            .sum();
        assert!((lobe.integral() / sum - 1.0).abs() < 1e-7);
    }
}
