//! Light from far away.

use etendue_field::Raster;
use etendue_world::SkyMap;
use glam::{DMat3, DVec3};
use std::f64::consts::{PI, TAU};

/// Light from far away.
#[derive(Debug)]
pub(super) enum SampledSky {
    Constant(f64),
    Map(Map),
}

/// A map, of which pixels are drawn by the light in and around them.
#[derive(Debug)]
pub(super) struct Map {
    map: SkyMap,
    to_map: DMat3,
    /// Light of pixels, summed up to each.
    summed: Vec<f64>,
}

impl SampledSky {
    pub(super) fn new(map: &SkyMap) -> Self {
        let pixels = &*map.radiance;
        let (w, h) = (pixels.width(), pixels.height());
        let mut sum = 0.0;
        let summed = (0..w * h).map(|i| {
            let row = i / w;
            // The solid angle of a pixel, but for a factor.
            sum += around(pixels, i % w, row) * (edge(row, h) - edge(row + 1, h));
            sum
        });
        let summed = summed.collect();
        Self::Map(Map {
            map: map.clone(),
            to_map: map.to_world.inverse(),
            summed,
        })
    }

    /// Radiance from a direction.
    pub(super) fn radiance(&self, toward: DVec3) -> f64 {
        match self {
            Self::Constant(radiance) => *radiance,
            Self::Map(map) => {
                let [column, row] = map.place(toward);
                map.map.radiance.value(column, row, true)
            }
        }
    }

    /// A direction, by its light.
    pub(super) fn sample(&self, [a, b, c]: [f64; 3]) -> DVec3 {
        match self {
            Self::Constant(_) => sphere(1.0 - 2.0 * a, TAU * b),
            Self::Map(map) => map.sample([a, b, c]),
        }
    }

    /// The density of [`Self::sample`] per solid angle.
    pub(super) fn density(&self, toward: DVec3) -> f64 {
        match self {
            Self::Constant(_) => 1.0 / (4.0 * PI),
            Self::Map(map) => map.density(toward),
        }
    }
}

impl Map {
    /// The column and the row of a direction, in pixels.
    fn place(&self, toward: DVec3) -> [f64; 2] {
        let v = self.to_map * toward;
        let turn = libm::atan2(v.x, -v.z) / TAU;
        let turn = if turn < 0.0 { turn + 1.0 } else { turn };
        let down = libm::atan2(libm::hypot(v.x, v.z), v.y) / PI;
        [
            turn * self.map.radiance.width() as f64,
            0.5 + down * (self.map.radiance.height() - 1) as f64,
        ]
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a pixel's number"
    )]
    fn density(&self, toward: DVec3) -> f64 {
        let (w, h) = (self.map.radiance.width(), self.map.radiance.height());
        let [column, row] = self.place(toward);
        let (column, row) = ((column as usize).min(w - 1), (row as usize).min(h - 1));
        let pixel = row * w + column;
        let all = self.summed[self.summed.len() - 1];
        let before = if pixel == 0 {
            0.0
        } else {
            self.summed[pixel - 1]
        };
        let solid = TAU / w as f64 * (edge(row, h) - edge(row + 1, h));
        (self.summed[pixel] - before) / (all * solid)
    }

    fn sample(&self, [a, b, c]: [f64; 3]) -> DVec3 {
        let (w, h) = (self.map.radiance.width(), self.map.radiance.height());
        let wanted = c * self.summed[self.summed.len() - 1];
        let pixel = self
            .summed
            .partition_point(|sum| *sum <= wanted)
            .min(w * h - 1);
        let (top, bottom) = (edge(pixel / w, h), edge(pixel / w + 1, h));
        let turn = ((pixel % w) as f64 + a) / w as f64;
        // About Z, with the turn from −Z to X of the map: (x, y, z) of the map are (sin, up, −cos).
        let around = sphere(top + b * (bottom - top), TAU * turn);
        self.map.to_world * DVec3::new(around.y, around.z, -around.x)
    }
}

/// The cosine of the angle from the pole at the upper edge of a row of `count`; the first and the last row are half as high.
fn edge(row: usize, count: usize) -> f64 {
    let steps = (count - 1).max(1) as f64;
    libm::cos(PI * ((row as f64 - 0.5) / steps).clamp(0.0, 1.0))
}

/// The light of a pixel and its neighbours, which interpolation carries into it.
fn around(pixels: &Raster, column: usize, row: usize) -> f64 {
    let (w, h) = (pixels.width(), pixels.height());
    let rows = row.saturating_sub(1)..=(row + 1).min(h - 1);
    let columns = [column + w - 1, column, column + 1];
    let each = rows.flat_map(|row| columns.map(|column| pixels.values()[row * w + column % w]));
    // The pixel itself counts most.
    each.sum::<f64>() / 16.0 + 0.5 * pixels.values()[row * w + column]
}

/// The direction at an azimuth about Z with this z.
fn sphere(z: f64, azimuth: f64) -> DVec3 {
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(azimuth);
    DVec3::new(radius * cos, radius * sin, z)
}
