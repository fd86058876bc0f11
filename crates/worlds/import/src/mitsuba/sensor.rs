//! Sensors, as cameras, and the integrator of a scene, which limits the depth of paths.

use super::object::{MitsubaObject, ObjectRef};
use super::reader::MitsubaReader;
use crate::range::MAX_PIXELS;
use crate::report::quoted;
use etendue_world::{Camera, Lens, Projection};
use glam::{DAffine3, DVec3};

/// Plugins supported as cameras.
const ALLOWED: &str = "perspective, thinlens, orthographic";

/// Default size of a film in pixels.
const SIZE: [usize; 2] = [768, 576];

/// Diagonal of a frame of 35 mm film, mm, to which focal lengths refer.
const DIAGONAL: f64 = 43.266_615_305_567_87;

/// Maximum nesting depth of integrators; the integrators `moment` and `aov` contain other
/// integrators.
const MAX_DEPTH: usize = 8;

impl<'a> MitsubaReader<'a> {
    pub(super) fn sensors(&mut self, scene: ObjectRef<'a>) {
        let all = self.children(scene, "sensor");
        let is_known =
            |sensor: &MitsubaObject<'_>| ALLOWED.split(", ").any(|known| known == sensor.plugin);
        let knows_any = all.iter().any(|(_, sensor)| is_known(sensor));
        for (_, sensor) in all {
            if is_known(sensor) {
                let camera = self.camera(sensor);
                match camera {
                    Some(camera) => self.world.cameras.push(camera),
                    None => self.lost(sensor),
                }
            } else if knows_any {
                let plugin = quoted(&sensor.plugin);
                sensor.note(format!("sensor {plugin} is left out; allowed: {ALLOWED}"));
                self.drop_all(sensor);
            } else {
                let _: Option<Camera> = self.unsupported(sensor, ALLOWED);
            }
        }
    }

    fn camera(&mut self, object: ObjectRef<'a>) -> Option<Camera> {
        let size = self.film(object);
        self.sampler(object);
        let clip = self.clip(object);
        let (to_world, projection, clip) = match object.plugin.as_str() {
            "orthographic" => {
                let (to_world, stretch) = self.orthographic(object)?;
                // If the camera is scaled, Mitsuba's rays begin elsewhere, but the distance between
                // the two clipping planes does not change.
                let [near, far] = clip?;
                let clip = [near * stretch, near * stretch + far - near];
                (to_world, Projection::Orthographic, clip)
            }
            plugin => {
                let projection = self.perspective(object, size?, clip?, plugin == "thinlens");
                (self.rigid(object)?, projection?, clip?)
            }
        };
        Some(Camera {
            name: object.id.clone().unwrap_or_default(),
            to_world,
            size: size?,
            projection,
            clip,
        })
    }

    fn clip(&self, object: ObjectRef<'a>) -> Option<[f64; 2]> {
        let near = object.number("near_clip").unwrap_or(1e-2);
        let far = object.number("far_clip").unwrap_or(1e4);
        if 0.0 < near && near < far {
            return Some([near, far]);
        }
        let message = format!("the clip planes are at {near} and {far}; allowed: 0 < near < far");
        object.refuse(message)
    }

    fn perspective(
        &mut self,
        object: ObjectRef<'a>,
        size: [usize; 2],
        [_, far]: [f64; 2],
        is_lens: bool,
    ) -> Option<Projection> {
        let half_width = self.half_width(object, size);
        let shift = ["principal_point_offset_x", "principal_point_offset_y"].map(|name| {
            if is_lens || !object.has(name) {
                return 0.0;
            }
            // The sign of the shift is reversed, because Mitsuba shifts the position in the picture
            // and not the picture itself.
            -object.number(name).unwrap_or_default()
        });
        let lens = if is_lens {
            let radius = object.number_within("aperture_radius", "0 or more", |r| r >= 0.0);
            if !object.has("aperture_radius") {
                object.cause("thinlens without aperture_radius");
            }
            let focus = object.number_or("focus_distance", far, "above 0", |f| f > 0.0);
            let (radius, focus) = (radius?, focus?);
            (radius > 0.0).then_some(Lens { radius, focus })
        } else {
            None
        };
        Some(Projection::Perspective {
            half_width: half_width?,
            shift,
            lens,
        })
    }

    /// Half of the width that the picture of a camera or a projector has at distance 1.
    pub(super) fn half_width(
        &self,
        object: ObjectRef<'a>,
        [width, height]: [usize; 2],
    ) -> Option<f64> {
        let aspect = width as f64 / height as f64;
        let diagonal = |tangent: f64| tangent / (1.0 + 1.0 / (aspect * aspect)).sqrt();
        if !object.has("fov") {
            return self
                .focal_length(object)
                .map(|length| diagonal(DIAGONAL / 2.0 / length));
        }
        if object.has("focal_length") {
            let message = "focal_length is given together with fov; allowed: one of them";
            object.cause_at("focal_length", message);
        }
        let axis = object.choice(
            "fov_axis",
            &[
                ("x", 'x'),
                ("y", 'y'),
                ("diagonal", 'd'),
                ("smaller", if aspect > 1.0 { 'y' } else { 'x' }),
                ("larger", if aspect > 1.0 { 'x' } else { 'y' }),
            ],
        );
        let is_angle = |fov: f64| 0.0 < fov && fov < 180.0;
        let fov = object.number_within("fov", "between 0 and 180 degrees", is_angle)?;
        let tangent = libm::tan(fov.to_radians() / 2.0);
        Some(match axis? {
            'x' => tangent,
            'y' => tangent * aspect,
            _ => diagonal(tangent),
        })
    }

    /// The focal length in millimetres, for 35 mm film.
    fn focal_length(&self, object: ObjectRef<'a>) -> Option<f64> {
        if !object.has("focal_length") {
            return Some(50.0);
        }
        let text = object.text("focal_length")?;
        let number = text.strip_suffix("mm").unwrap_or(text);
        match super::value::number(number) {
            Ok(length) if length > 0.0 => Some(length),
            _ => {
                let message = format!("focal_length is {}; allowed: such as 50mm", quoted(text));
                object.fault("focal_length", message)
            }
        }
    }

    /// The placement of the camera with the axis Z normalised, and the original length of
    /// Z.
    fn orthographic(&self, object: ObjectRef<'a>) -> Option<(DAffine3, f64)> {
        if !object.has("to_world") {
            return Some((DAffine3::IDENTITY, 1.0));
        }
        let mut map = object.transform("to_world")?;
        let stretch = map.matrix3.z_axis.length();
        let [x, y, z] = [0, 1, 2].map(|i| map.matrix3.col(i).normalize_or_zero());
        let lengths = [map.matrix3.x_axis.length(), map.matrix3.y_axis.length()];
        let is_square = [x.dot(y), y.dot(z), z.dot(x)]
            .iter()
            .all(|c| c.abs() < 1e-3);
        let is_even = (lengths[0] - lengths[1]).abs() <= 1e-3 * lengths[0];
        if !is_square || !is_even || [x, y, z].contains(&DVec3::ZERO) {
            return object.fault("to_world", "to_world shears, or scales x and y differently");
        }
        map.matrix3.z_axis = z;
        Some((map, stretch))
    }

    /// The width and height in pixels.
    fn film(&self, object: ObjectRef<'a>) -> Option<[usize; 2]> {
        let Some(film) = self.child(object, "film") else {
            return Some(SIZE);
        };
        let size = ["width", "height"].map(|name| self.pixels(film, name));
        for (name, whole) in [("crop_width", 0), ("crop_height", 1)] {
            let cropped = film.whole(name);
            if cropped.is_some_and(|c| size[whole].is_some_and(|s| usize::try_from(c) != Ok(s))) {
                self.refuse_crop(film, name);
            }
        }
        for name in ["crop_offset_x", "crop_offset_y"] {
            if film.whole(name).is_some_and(|offset| offset != 0) {
                self.refuse_crop(film, name);
            }
        }
        for (_, filter) in self.children(film, "rfilter") {
            if filter.plugin != "box" {
                let plugin = quoted(&filter.plugin);
                let message = format!("rfilter {plugin} is approximated by the box filter");
                filter.note(message);
            }
            self.drop_all(filter);
        }
        if self.children(film, "rfilter").is_empty() {
            let message = "rfilter `gaussian`, the default, is approximated by the box filter";
            film.note(message);
        }
        let [width, height] = size;
        Some([width?, height?])
    }

    fn refuse_crop(&self, film: ObjectRef<'a>, name: &str) {
        film.cause_at(name, format!("{name}: parts of a film are not supported"));
    }

    fn pixels(&self, film: ObjectRef<'a>, name: &str) -> Option<usize> {
        if !film.has(name) {
            return Some(SIZE[usize::from(name == "height")]);
        }
        let value = film.whole(name)?;
        if (1..=MAX_PIXELS).contains(&value) {
            return usize::try_from(value).ok();
        }
        let message = format!("{name} is {value}; allowed: 1 to {MAX_PIXELS}");
        film.fault(name, message)
    }

    /// Adds a note on the sampler, which is not needed for a world, and marks the sampler as
    /// read.
    fn sampler(&self, object: ObjectRef<'a>) {
        for (_, sampler) in self.children(object, "sampler") {
            let plugin = quoted(&sampler.plugin);
            sampler.note(format!("sampler {plugin} is left out"));
            self.drop_all(sampler);
        }
    }

    /// Reads the depth from the integrator. The other settings of the integrator affect only how
    /// Mitsuba computes, not the result.
    pub(super) fn integrator(&mut self, scene: ObjectRef<'a>) {
        let Some(mut object) = self.child(scene, "integrator") else {
            return;
        };
        for _ in 0..MAX_DEPTH {
            object.is_used.set(true);
            match object.plugin.as_str() {
                "moment" | "aov" => match self.child(object, "integrator") {
                    Some(nested) => object = nested,
                    None => return self.note_depth(object),
                },
                "direct" => {
                    self.world.depth = Some(1);
                    return self.hide(object);
                }
                "path" | "volpath" | "volpathmis" | "ptracer" | "prb" | "prbvolpath" => {
                    self.world.depth = self.depth(object);
                    return self.hide(object);
                }
                _ => return self.note_depth(object),
            }
        }
    }

    /// Notes where light passes masks that the integrator of the scene takes for opaque.
    pub(super) fn note_masks(&self, scene: ObjectRef<'a>) {
        let is_mask = |of: &MitsubaObject<'_>| {
            of.is_used.get() && matches!(of.plugin.as_str(), "mask" | "null")
        };
        if let Some((_, object)) = self.children(scene, "integrator").first()
            && !object.plugin.contains("volpath")
            && self.objects.iter().any(is_mask)
        {
            let message = "light passes `mask` and `null` as in volpath: also light of point lights, and without being counted by max_depth";
            object.note(message);
        }
    }

    fn hide(&mut self, object: ObjectRef<'a>) {
        self.world.hides_sources = object.truth("hide_emitters");
    }

    fn note_depth(&self, object: ObjectRef<'a>) {
        let message = format!(
            "integrator {} is left out: paths have no maximum length",
            quoted(&object.plugin)
        );
        object.note(message);
    }

    /// The depth. Mitsuba counts the edges of a path, so depth 1 shows only sources, and
    /// depth 2 adds direct light.
    fn depth(&self, object: ObjectRef<'a>) -> Option<u32> {
        match object.whole("max_depth")? {
            -1 => None,
            // A picture with depth 0 is black, which the depth of a world cannot express.
            0 => {
                let message = "max_depth is 0, which shows nothing; allowed: -1, or 1 or more";
                object.fault("max_depth", message)
            }
            depth => match depth.checked_sub(1).map(u32::try_from) {
                Some(Ok(less)) => Some(less),
                _ => {
                    let message = format!("max_depth is {depth}; allowed: -1, or 1 or more");
                    object.fault("max_depth", message)
                }
            },
        }
    }
}
