//! Environments as Mitsuba's environment pictures.
//!
//! Columns are intervals of longitude in both formats. Étendue's rows are intervals of latitude.
//! Mitsuba's rows are samples of latitude, from the upper pole in the first row to the lower pole
//! in the last row.

use etendue_field::{Environment, EnvironmentMap};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Minimum number of pixels in a row. Lobes are interpolated linearly, with an error of
/// (2π/4096/σ)²/8 of the peak: 2·10⁻⁶ at σ = 0.4, 2·10⁻⁴ at σ = 0.04.
const AROUND: usize = 4096;

/// The number of pixels per row, and the radiance row by row.
///
/// A pixel map is represented exactly, because the nodes of the new picture include all nodes of
/// the map. The radiance of light that travels against the central ray is set to 0.
pub(super) fn map(environment: &Environment) -> (usize, Vec<f64>) {
    let [width, rows] = match &environment.map {
        EnvironmentMap::Lobes(_) => [AROUND, AROUND / 2 + 1],
        EnvironmentMap::LatLong(map) => {
            let raster = map.raster();
            let finer = finer(raster.width());
            [finer * raster.width(), 2 * finer * raster.height() + 1]
        }
    };
    let pixels = (0..width * rows).map(|i| {
        let column = (i % width) as f64 + 0.5;
        let row = (i / width) as f64;
        let from = toward(column / width as f64, row / (rows - 1) as f64);
        // Light from this direction travels the opposite way; z is along the central ray.
        if environment.frame.vector_to_world(from).z >= 0.0 {
            return 0.0;
        }
        match &environment.map {
            EnvironmentMap::Lobes(_) => environment.map.radiance(from),
            EnvironmentMap::LatLong(map) => {
                let raster = map.raster();
                let (across, down) = (raster.width() as f64, raster.height() as f64);
                let column = column * across / width as f64;
                let row = row * down / (rows - 1) as f64;
                raster.value(column, row, true)
            }
        }
    });
    (width, pixels.collect())
}

/// The factor by which pixels are subdivided. This factor is odd, so the centres of old
/// pixels are also centres of new pixels.
fn finer(width: usize) -> usize {
    let least = AROUND.div_ceil(width);
    if width >= AROUND / 2 { 1 } else { least | 1 }
}

/// A direction. `around` is its azimuth as a fraction of a full turn, and `down` is 0 at
/// the upper pole and 1 at the lower pole.
fn toward(around: f64, down: f64) -> DVec3 {
    let (sin, cos) = libm::sincos(TAU * (0.5 - around));
    let (across, up) = libm::sincos(PI * down);
    DVec3::new(across * sin, up, across * cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::{Frame, LatLong, Raster};
    use std::sync::Arc;

    /// Checks that Mitsuba's interpolation between its nodes equals Étendue's interpolation
    /// between pixels.
    #[test]
    fn rows_become_nodes() {
        let values = (0..24).map(|i| f64::from(i * i % 17)).collect();
        let latlong = LatLong::new(Raster::new(6, 4, values).unwrap());
        // Half of the sky is dark: light comes only from −Z.
        let frame = Frame::IDENTITY;
        let environment = Environment {
            frame,
            map: EnvironmentMap::LatLong(Arc::new(latlong)),
        };
        let (width, values) = map(&environment);
        let rows = values.len() / width;
        let nodes = Raster::new(width, rows, values).unwrap();
        for (x, y) in [(0.3, 0.2), (-0.6, -0.9), (0.1, 3.0), (0.9, -0.1)] {
            let from = DVec3::new(x, y, -0.5).normalize();
            let column = width as f64 * (0.5 - libm::atan2(from.x, from.z) / TAU);
            let row = 0.5 + (rows - 1) as f64 * libm::acos(from.y) / PI;
            let theirs = nodes.value(column, row, true);
            let ours = environment.map.radiance(from);
            assert!((theirs - ours).abs() < 1e-9, "{from}: {theirs}, {ours}"); // rounding of angles, times slopes
        }
    }
}
