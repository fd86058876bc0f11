//! The camera, the film and the path depth.

use super::entity::{CauseGiven, Entity, Read};
use super::reader::PbrtReader;
use super::transform::without_scale;
use crate::range::MAX_PIXELS;
use crate::report::{SourcePlace, quoted};
use etendue_world::{Camera, Lens, Projection};
use glam::{DAffine3, DVec3};
use std::rc::Rc;

/// Plugins supported as cameras.
const ALLOWED: &str = "perspective, orthographic";

/// Default size of a film in pixels.
const SIZE: [usize; 2] = [1280, 720];

/// pbrt's default depth.
const DEPTH: i64 = 5;

/// Integrators that sum the light of all paths.
const PATHS: [&str; 8] = [
    "path",
    "volpath",
    "simplepath",
    "simplevolpath",
    "lightpath",
    "bdpt",
    "mlt",
    "randomwalk",
];

/// Maximum relative deviation of a window from square pixels.
const SQUARE: f64 = 1e-4;

impl PbrtReader<'_> {
    pub(super) fn camera(&mut self, whole: &SourcePlace) {
        // pbrt uses this camera if a file names none.
        let default = Entity {
            report: self.report,
            kind: "camera",
            plugin: "perspective".to_owned(),
            place: whole.clone(),
            own: Vec::new(),
            defaults: Rc::default(),
            is_used: true.into(),
        };
        let default = (default, DAffine3::IDENTITY);
        let (entity, map) = self.scene.camera.as_ref().unwrap_or(&default);
        entity.is_used.set(true);
        let size = self.film(whole);
        if let Ok(camera) = self.camera_of(entity, *map, size) {
            self.world.cameras.push(camera);
        }
    }

    fn camera_of(
        &self,
        entity: &Entity<'_>,
        map: DAffine3,
        size: Read<[usize; 2]>,
    ) -> Read<Camera> {
        let is_flat = match entity.plugin.as_str() {
            "perspective" => false,
            "orthographic" => true,
            _ => return Err(entity.unsupported(ALLOWED)),
        };
        let placed = without_scale(map.inverse()).ok_or_else(|| {
            entity.refuse("the camera has shear, or different scales along its axes")
        });
        self.exposure(entity)?;
        let size = size?;
        let window = self.window(entity, size)?;
        let (rigid, scale) = placed?;
        // X points to the right of the picture in pbrt and to the left in a world. The camera's map
        // mirrors coordinates, because the coordinates in the file are left-handed.
        let rigid = rigid * DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        let (to_world, projection) = match is_flat {
            true => (
                self.flat(entity, rigid, scale, window)?,
                Projection::Orthographic,
            ),
            false => (rigid, self.perspective(entity, scale, window)?),
        };
        Ok(Camera {
            name: "camera".to_owned(),
            to_world,
            size,
            projection,
            clip: [0.0, f64::INFINITY],
        })
    }

    /// The visible range: minimum and maximum x, then minimum and maximum y. The shorter
    /// side of the visible range is from −1 to 1.
    fn window(&self, entity: &Entity<'_>, [w, h]: [usize; 2]) -> Read<[f64; 4]> {
        let film = w as f64 / h as f64;
        let aspect = entity.float_within("frameaspectratio", film, "above 0", |a| a > 0.0)?;
        let [x, y] = if aspect > 1.0 {
            [aspect, 1.0]
        } else {
            [1.0, 1.0 / aspect]
        };
        let window = entity.exactly::<4>("screenwindow", "float")?;
        let window = window.unwrap_or([-x, x, -y, y]);
        let [left, right, low, high] = window;
        let (width, height) = (right - left, high - low);
        let is_square = (width / height / film - 1.0).abs() <= SQUARE;
        if is_square && width > 0.0 && height > 0.0 {
            return Ok(window);
        }
        let message = format!(
            "the pixels are not square: the screen of {width} × {height} has {w} × {h} pixels"
        );
        Err(entity.refuse(message))
    }

    /// A perspective projection, where `fov` spans the shorter side, from −1 to 1.
    fn perspective(&self, entity: &Entity<'_>, scale: f64, window: [f64; 4]) -> Read<Projection> {
        let fov = entity.float_within("fov", 90.0, "between 0 and 180 degrees", |a| {
            0.0 < a && a < 180.0
        });
        let radius = entity.float_within("lensradius", 0.0, "0 or more", |r| r >= 0.0);
        let focus = entity.float_within("focaldistance", 1e6, "above 0", |f| f > 0.0);
        let tangent = libm::tan(fov?.to_radians() / 2.0);
        let (radius, focus) = (radius? * scale, focus? * scale);
        let [left, right, low, high] = window;
        let (width, height) = (right - left, high - low);
        Ok(Projection::Perspective {
            half_width: tangent * width / 2.0,
            shift: [
                -(left + right) / (2.0 * width),
                (low + high) / (2.0 * height),
            ],
            lens: (radius > 0.0).then_some(Lens { radius, focus }),
        })
    }

    /// The placement of an orthographic camera, in which X and Y are scaled by the width
    /// of the picture.
    fn flat(
        &self,
        entity: &Entity<'_>,
        rigid: DAffine3,
        scale: f64,
        [left, right, low, high]: [f64; 4],
    ) -> Read<DAffine3> {
        if entity.float_or("lensradius", 0.0)? > 0.0 {
            let message = "a lens of an orthographic camera is not supported";
            return Err(entity.fault("lensradius", message));
        }
        let middle = scale * DVec3::new(-(left + right) / 2.0, (low + high) / 2.0, 0.0);
        let half = scale * (right - left) / 2.0;
        let wide = DAffine3::from_scale(DVec3::new(half, half, 1.0));
        Ok(rigid * DAffine3::from_translation(middle) * wide)
    }

    /// Adds a note if pbrt multiplies the radiance by a factor for the exposure.
    fn exposure(&self, entity: &Entity<'_>) -> Read<()> {
        let open = entity.float_or("shutteropen", 0.0)?;
        let close = entity.float_or("shutterclose", 1.0)?;
        let film = self.scene.settings.get("Film");
        let iso = film.map_or(Ok(100.0), |film| film.float_or("iso", 100.0))?;
        let ratio = (close - open) * iso / 100.0;
        if (ratio - 1.0).abs() > 1e-9 {
            let message = format!(
                "pbrt multiplies the radiance by {ratio} for the exposure; this factor is left out"
            );
            self.report.note(&entity.place, message);
        }
        Ok(())
    }

    /// The width and height in pixels.
    fn film(&self, whole: &SourcePlace) -> Read<[usize; 2]> {
        let Some(film) = self.scene.settings.get("Film") else {
            return Ok(SIZE);
        };
        film.is_used.set(true);
        let pixels = |i: usize, name| {
            let default = i64::try_from(SIZE[i]).unwrap_or_default();
            let value = film.integer_or(name, default)?;
            let fits = usize::try_from(value)
                .ok()
                .filter(|_| (1..=MAX_PIXELS).contains(&value));
            let message = format!("{name} is {value}; allowed: 1 to {MAX_PIXELS}");
            fits.ok_or_else(|| film.fault(name, message))
        };
        let [w, h] = [pixels(0, "xresolution"), pixels(1, "yresolution")];
        let check_part = |name, kind, [right, low]: [f64; 2]| {
            let part = film.exactly::<4>(name, kind)?;
            match part.is_some_and(|part| is_part(part, [0.0, right, 0.0, low])) {
                true => Err(film.fault(name, "parts of a film are not supported")),
                false => Ok(()),
            }
        };
        check_part("cropwindow", "float", [1.0, 1.0])?;
        let (w, h) = (w?, h?);
        check_part("pixelbounds", "integer", [w as f64, h as f64])?;
        if !self.scene.settings.contains_key("PixelFilter") {
            let message = "filter `gaussian`, the default, is approximated by the box filter";
            self.report.note(whole, message);
        }
        Ok([w, h])
    }

    /// Adds notes on filters, samplers and accelerators that are approximated or left out, and
    /// marks their parameters as read.
    pub(super) fn settings(&self) {
        for (kind, entity) in &self.scene.settings {
            let plugin = quoted(&entity.plugin);
            let message = match *kind {
                "PixelFilter" if entity.plugin == "box" => {
                    self.check_box(entity);
                    continue;
                }
                "PixelFilter" => format!("filter {plugin} is approximated by the box filter"),
                "Sampler" | "Accelerator" => format!("{kind} {plugin} is left out"),
                _ => continue,
            };
            self.report.note(&entity.place, message);
            entity.drop_all();
        }
    }

    /// Checks the width of a box filter, and adds a note if the width is not one pixel.
    fn check_box(&self, entity: &Entity<'_>) {
        entity.is_used.set(true);
        for name in ["xradius", "yradius"] {
            let radius = entity.float_or(name, 0.5);
            if radius.is_ok_and(|radius| (radius - 0.5).abs() > 1e-9) {
                let message = format!("{name} is approximated by 0.5, a box of one pixel");
                self.report.note(entity.place_of(name), message);
            }
        }
    }

    /// Reads the number of bounces.
    pub(super) fn integrator(&mut self) {
        let mut depth = DEPTH;
        if let Some(entity) = self.scene.settings.get("Integrator") {
            entity.is_used.set(true);
            if !PATHS.contains(&entity.plugin.as_str()) {
                entity.unsupported(&PATHS.join(", "));
                return;
            }
            depth = match entity.integer_or("maxdepth", DEPTH) {
                Ok(depth) => depth,
                Err(CauseGiven) => return,
            };
            if depth < 0 {
                let message = format!("maxdepth is {depth}; allowed: 0 or more");
                entity.fault("maxdepth", message);
            }
        }
        self.world.depth = u32::try_from(depth).ok();
    }
}

/// Checks whether a window is smaller than the whole picture.
fn is_part(window: [f64; 4], whole: [f64; 4]) -> bool {
    let inward = [1.0, -1.0, 1.0, -1.0];
    (0..4).any(|i| (window[i] - whole[i]) * inward[i] > 0.0)
}
