//! Checks environments, and the pictures that vary surfaces.

use super::Resolver;
use super::faults::{show, vector};
use crate::picture;
use etendue_field::{
    Environment, EnvironmentMap, Frame, LatLong, Light, Pattern, Picture, Raster, SphericalGaussian,
};
use etendue_scenefile::limits::MAX_NUMBER;
use etendue_scenefile::number;
use etendue_scenefile::{EnvironmentFile, Fault};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;
use std::sync::Arc;

/// Beyond this distance from the centre of a lobe, in widths of the lobe, the lobe's light is
/// negligible.
const REACH: f64 = 6.0;

impl Resolver<'_> {
    /// The light from an environment. The axes are directions in the world of the scene
    /// file; `light` is the frame at the light.
    pub(super) fn environment(
        &mut self,
        [up, front]: [&[f64; 3]; 2],
        scale: f64,
        map: &EnvironmentFile,
        light: &Frame,
    ) -> Light {
        let [y, d] = [up, front].map(|v| light.vector_to_local(DVec3::from(*v)));
        // The axis `up` fixes the poles, and `front` is made orthogonal to `up`.
        let across = y.try_normalize().map_or(DVec3::NAN, |y| d - y * d.dot(y));
        let frame = Frame::new(DVec3::ZERO, d, y).and(Frame::new(DVec3::ZERO, across, y.cross(d)));
        if frame.is_none() && y.is_finite() && d.is_finite() {
            let shown = format!("{} and {}", vector(up), vector(front));
            let allowed = "two directions that are not parallel, neither of length 0";
            self.faults.add("light.up and light.front", shown, allowed);
        }
        let map = match map {
            EnvironmentFile::Lobes(lobes) => {
                if lobes.is_empty() {
                    self.faults.add("light.map", "no lobe", "at least one lobe");
                }
                let lobes = lobes.iter().enumerate().map(|(i, lobe)| {
                    let of = format!("light.map[{i}]");
                    let from = self.faults_of_direction(&format!("{of}.from"), lobe.from);
                    SphericalGaussian {
                        from,
                        radiance: scale * lobe.radiance.number(self.color),
                        width: lobe.width,
                    }
                });
                EnvironmentMap::Lobes(lobes.collect())
            }
            EnvironmentFile::File(path) => {
                let raster = self.picture("light.map", path, &["exr"], MAX_NUMBER);
                let dark = |raster: &Raster| raster.values().iter().all(|value| *value <= 0.0);
                if raster.as_ref().is_some_and(dark) {
                    let allowed = "a picture that is not dark everywhere";
                    self.faults.add("light.map", show(path), allowed);
                }
                let scaled = raster.and_then(|raster| {
                    let values = raster.values().iter().map(|value| scale * value);
                    Raster::new(raster.width(), raster.height(), values.collect())
                });
                let dark = || LatLong::from_fn(1, 1, |_| 0.0);
                EnvironmentMap::LatLong(Arc::new(scaled.map_or_else(dark, LatLong::new)))
            }
        };
        let frame = frame.unwrap_or(Frame::IDENTITY);
        if let EnvironmentMap::Lobes(lobes) = &map {
            self.behind(&frame, lobes);
        }
        Light::Environment {
            environment: Environment { frame, map },
        }
    }

    /// Adds a fault for each lobe that sends no light forward.
    fn behind(&mut self, frame: &Frame, lobes: &[SphericalGaussian]) {
        for (i, lobe) in lobes.iter().enumerate() {
            let from = frame.vector_to_world(lobe.from);
            let reach = REACH * lobe.width;
            // If the width of a lobe is faulty, the fault has been reported already.
            let is_narrow = lobe.width > 0.0 && reach < FRAC_PI_2;
            if is_narrow && from.z > libm::sin(reach) {
                let allowed = "a direction from which light goes forward, along path.direction: an environment emits no other light";
                let DVec3 { x, y, z } = lobe.from;
                self.faults
                    .add(format!("light.map[{i}].from"), vector(&[x, y, z]), allowed);
            }
        }
    }

    fn faults_of_direction(&mut self, of: &str, direction: [f64; 3]) -> DVec3 {
        let direction = DVec3::from(direction);
        direction.try_normalize().unwrap_or_else(|| {
            if direction.is_finite() {
                let DVec3 { x, y, z } = direction;
                self.faults.add(of, vector(&[x, y, z]), "a direction");
            }
            DVec3::Z
        })
    }

    /// A picture that varies a BRDF over a surface.
    pub(super) fn picture_pattern(&mut self, of: &str, file: &str, size: [f64; 2]) -> Pattern {
        let raster = self.picture(&format!("{of}.file"), file, &["exr", "png"], 1.0);
        let black = || LatLong::from_fn(1, 1, |_| 0.0).raster().clone();
        Pattern::Picture(Picture {
            size,
            pixels: Arc::new(raster.unwrap_or_else(black)),
        })
    }

    /// The picture in a file, with values from 0 to `most`.
    pub(super) fn picture(
        &mut self,
        of: &str,
        path: &str,
        extensions: &[&str],
        most: f64,
    ) -> Option<Raster> {
        let bytes = self.named_file(of, path)?;
        let file = Path::new(path);
        let raster = picture::parse(file, &bytes, extensions, self.color, self.memory);
        let raster = raster.map_err(|fault| {
            let field = format!("{of}, {path:?}: {}", fault.field);
            self.faults.add_fault(Fault { field, ..fault });
        });
        let (raster, transient) = raster.ok()?;
        // Levels, numbers, and a copy of the numbers that are scaled or searched for edges.
        self.pictures += transient + 2 * size_of_val(raster.values());
        let mut values = raster.values().iter();
        if let Some(pixel) = values.position(|value| !(0.0..=most).contains(value)) {
            let [column, row] = [pixel % raster.width(), pixel / raster.width()];
            let field = format!("{of}, {path:?}: pixel {column} of row {row}");
            let allowed = format!("0 to {}", number(most));
            self.faults
                .add(field, number(raster.values()[pixel]), allowed);
            return None;
        }
        Some(raster)
    }
}
