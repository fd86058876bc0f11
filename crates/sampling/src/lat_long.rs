//! Sampling of directions in proportion to the radiance of a latitude–longitude picture.

use crate::DiscreteDistribution;
use crate::warp::tent;
use etendue_field::LatLong;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// A picture of all directions, from which directions are sampled in proportion to radiance.
///
/// Radiance is a sum of tent functions around the centres of pixels. The sampler selects a pixel
/// in proportion to its light, then a position within the pixel's tent. The density is therefore
/// interpolated like the radiance, with each pixel weighted by the circumference of its row.
#[derive(Clone, Debug)]
pub struct LatLongSampler {
    map: Arc<LatLong>,
    /// The sine of the polar angle of each row.
    sines: Vec<f64>,
    rows: DiscreteDistribution,
    /// The distribution of the pixels in each row.
    columns: Vec<DiscreteDistribution>,
}

impl LatLongSampler {
    /// The sampler of a picture.
    #[must_use]
    pub fn new(map: &Arc<LatLong>) -> Self {
        let raster = map.raster();
        let [top, bottom] = map.poles();
        let height = bottom - top;
        // A row at a pole has only half of a tent. The centroid of this half is a third of a row
        // away from the pole.
        let steepest = 0.5 - 1.0 / (3.0 * height);
        let sines: Vec<f64> = (0..raster.height())
            .map(|row| {
                let latitude = 0.5 - (row as f64 + 0.5 - top) / height;
                libm::cos(PI * latitude.clamp(-steepest, steepest))
            })
            .collect();
        let rows = raster.values().chunks_exact(raster.width()).zip(&sines);
        let columns: Vec<DiscreteDistribution> = rows
            .map(|(values, sine)| DiscreteDistribution::new(values.iter().map(|v| sine * v)))
            .collect();
        let rows = columns.iter().enumerate().map(|(row, columns)| {
            // A row extends half a row on either side of its centre, or to the pole if the pole
            // is nearer.
            let center = row as f64 + 0.5;
            let share = (center - top).min(0.5) + (bottom - center).min(0.5);
            share * columns.total()
        });
        Self {
            rows: DiscreteDistribution::new(rows),
            columns,
            sines,
            map: Arc::clone(map),
        }
    }

    /// Samples a direction from which light comes.
    #[must_use]
    pub fn sample(&self, r: [f64; 4]) -> DVec3 {
        let row = self.rows.sample(r[0]);
        let column = self.columns[row].sample(r[1]);
        // A position beyond a pole is reflected back.
        let [top, bottom] = self.map.poles();
        let down = top + (row as f64 + 0.5 + tent(r[3]) - top).abs();
        let down = bottom - (bottom - down).abs();
        self.map.direction([column as f64 + 0.5 + tent(r[2]), down])
    }

    /// The density of [`Self::sample`].
    #[must_use]
    pub fn density(&self, from: DVec3) -> f64 {
        self.radiance_and_density(from).1
    }

    /// The radiance from a direction, and the density of [`Self::sample`].
    #[must_use]
    pub fn radiance_and_density(&self, from: DVec3) -> (f64, f64) {
        let raster = self.map.raster();
        let [column, row] = self.map.place(from);
        let [mut radiance, mut weighted] = [0.0; 2];
        for (pixel, share) in raster.around(column, row, true) {
            let part = share * raster.values()[pixel];
            radiance += part;
            weighted += part * self.sines[pixel / raster.width()];
        }
        if weighted <= 0.0 {
            return (radiance, 0.0);
        }
        let [top, bottom] = self.map.poles();
        // A square of latitude and longitude, and the solid angle of that square.
        let pixel = (TAU / raster.width() as f64)
            * (PI / (bottom - top))
            * DVec2::new(from.x, from.z).length().max(f64::MIN_POSITIVE);
        (radiance, weighted / (self.rows.total() * pixel))
    }
}
