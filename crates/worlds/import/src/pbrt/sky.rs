//! Environment pictures in an equal-area map of the sphere to a square (Clarberg 2008, *Fast
//! equal-area mapping of the (hemi)sphere using SIMD*).

use super::entity::{CauseGiven, Entity, Read};
use super::reader::PbrtReader;
use super::texture::default_curve;
use super::transform::without_scale;
use etendue_field::{LatLong, Raster, whole};
use etendue_world::{Light, SkyMap};
use glam::{DAffine3, DVec3};
use std::f64::consts::{FRAC_2_PI, PI, TAU};
use std::sync::Arc;

/// Maximum number of pixels along a side: the converted map has eight times as many pixels.
const MAX_PIXELS: usize = 2048;

/// Number of samples along a side of a map. It bounds the time, because larger maps have fewer
/// samples per pixel. A pixel has at least 3 and at most 16 samples along a side.
const WITHIN: usize = 4096;

impl PbrtReader<'_> {
    pub(super) fn sky(&mut self, entity: &Entity<'_>, to_world: DAffine3) -> Read<Light> {
        if entity.has("L") {
            let message = "L is given together with filename; allowed: one of them";
            return Err(entity.fault("L", message));
        }
        let scale = self.scale_of(entity);
        let turned = without_scale(to_world)
            .ok_or_else(|| entity.refuse("the sky has shear, or different scales along its axes"));
        let curve = default_curve(self.file_name(entity)?);
        let square = self.picture(entity, curve)?;
        let side = square.width();
        if side != square.height() || side > MAX_PIXELS {
            let (w, h) = (side, square.height());
            let message = format!(
                "{w} × {h} pixels; allowed: squares of at most {MAX_PIXELS} × {MAX_PIXELS}"
            );
            return Err(entity.fault("filename", message));
        }
        let factor = self.wanted(entity, "illuminance", illuminance(&square))?;
        let bytes = (8 * side * (2 * side + 1) * size_of::<f64>()) as u64;
        let spent = self.files.spend(bytes);
        spent.map_err(|error| entity.fault("filename", error))?;
        let radiance = longitudes(&square, scale? * factor).ok_or(CauseGiven)?;
        let (w, h) = (radiance.width(), radiance.height());
        let message = format!(
            "approximated: the square picture is resampled to {w} × {h} pixels by longitude and latitude, and interpolated"
        );
        self.report.note_once(&entity.place, &message);
        Ok(Light::Sky(SkyMap {
            to_world: turned?.0.matrix3,
            radiance: Arc::new(LatLong::from_pole_to_pole(radiance)),
        }))
    }
}

/// The illuminance of a surface with normal Z.
fn illuminance(square: &Raster) -> f64 {
    let side = square.width();
    let pixel = 4.0 * PI / (side * side) as f64;
    let at = |i: usize| {
        let [x, y] = [i % side, i / side].map(|k| (k as f64 + 0.5) / side as f64);
        square.values()[i].max(0.0) * direction([x, y]).z.max(0.0)
    };
    (0..side * side).map(at).sum::<f64>() * pixel
}

/// The picture over longitude and latitude, from pole to pole. Each pixel is the mean over
/// its area.
fn longitudes(square: &Raster, scale: f64) -> Option<Raster> {
    let side = square.width();
    let (w, h) = (4 * side, 2 * side + 1);
    let count = (WITHIN / side).clamp(3, 16);
    let within = |k: usize| (k as f64 + 0.5) / count as f64 - 0.5;
    let pixel = |i: usize| {
        let (column, row) = ((i % w) as f64 + 0.5, (i / w) as f64);
        let places = (0..count * count).map(|k| {
            // The polar angle is limited because the sphere has no area beyond the poles.
            let polar = ((row + within(k / count)) * PI / (h - 1) as f64).clamp(0.0, PI);
            let (sin, cos) = libm::sincos(polar);
            let (x, z) = libm::sincos((column + within(k % count)) * TAU / w as f64);
            nearest(square, DVec3::new(sin * x, cos, -sin * z))
        });
        scale * places.sum::<f64>() / (count * count) as f64
    };
    Raster::new(w, h, (0..w * h).map(pixel).collect())
}

/// The pixel that a direction falls into.
fn nearest(square: &Raster, toward: DVec3) -> f64 {
    let side = square.width();
    let [x, y] = place(toward).map(|v| whole(v.clamp(0.0, 1.0) * side as f64).min(side - 1));
    square.values()[y * side + x].max(0.0)
}

/// The position of a direction in the unit square.
fn place(toward: DVec3) -> [f64; 2] {
    let [x, y, z] = toward.abs().to_array();
    let r = (1.0 - z).max(0.0).sqrt();
    // Returns the azimuth as a share of a quarter turn, from 0 to 1.
    let turn = FRAC_2_PI * libm::atan2(y, x);
    let (u, v) = (r * (1.0 - turn), r * turn);
    let (u, v) = if toward.z < 0.0 {
        (1.0 - v, 1.0 - u)
    } else {
        (u, v)
    };
    [u.copysign(toward.x), v.copysign(toward.y)].map(|v| (v + 1.0) / 2.0)
}

/// The direction for a position in the unit square.
fn direction(place: [f64; 2]) -> DVec3 {
    let [u, v] = place.map(|v| 2.0 * v - 1.0);
    let signed = 1.0 - (u.abs() + v.abs());
    let r = 1.0 - signed.abs();
    let turn = if r > 0.0 {
        (v.abs() - u.abs()) / r + 1.0
    } else {
        1.0
    };
    let (sin, cos) = libm::sincos(turn * PI / 4.0);
    let across = r * (2.0 - r * r).max(0.0).sqrt();
    DVec3::new(
        (across * cos).copysign(u),
        (across * sin).copysign(v),
        (1.0 - r * r).copysign(signed),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_directions_agree() {
        for i in 0..64 {
            let at = [f64::from(i % 8) / 8.0 + 0.07, f64::from(i / 8) / 8.0 + 0.03];
            let back = place(direction(at));
            // The tolerance of the comparison is the rounding error.
            assert!(
                (back[0] - at[0]).abs() + (back[1] - at[1]).abs() < 1e-12,
                "{at:?}"
            );
        }
        // According to pbrt's math.cpp the centre is Z, the corners are −Z, and the middle of the
        // right edge is X.
        assert!(direction([0.5; 2]).abs_diff_eq(DVec3::Z, 1e-12));
        assert!(direction([1.0; 2]).abs_diff_eq(DVec3::NEG_Z, 1e-12));
        assert!(direction([1.0, 0.5]).abs_diff_eq(DVec3::X, 1e-12));
        assert!(direction([0.5, 0.0]).abs_diff_eq(DVec3::NEG_Y, 1e-12));
    }

    #[test]
    fn an_even_sky_has_its_illuminance() {
        let square = Raster::new(64, 64, vec![2.0; 4096]).unwrap();
        // The illuminance is π times the radiance, with an error of the size of a pixel, about
        // 1/64².
        assert!((illuminance(&square) - TAU).abs() < 1e-2);
    }
}
