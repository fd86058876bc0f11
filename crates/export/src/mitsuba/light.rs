//! Lights as Mitsuba's emitters.

use super::picture::{pfm, sampled};
use super::xml::{self, emitter};
use super::{NotInMitsuba, Writer, sky};
use etendue_field::{Image, Light, Rectangle, Shape};
use etendue_scene::Scene;
use std::f64::consts::PI;

/// Width and height of a picture in pixels.
const PIXELS: usize = 1024;
/// Extent of a picture, in widths of the light's Gaussian. The rest is below 10⁻¹² of its peak.
const WIDTHS: f64 = 3.0;

impl Writer {
    pub(super) fn light(&mut self, light: &Light) -> Result<(), NotInMitsuba> {
        match light {
            Light::Area { exponent, .. } if *exponent > 0.0 => {
                return Err(NotInMitsuba::Light(format!(
                    "area light whose radiance falls off as cosⁿθ: a spot with exponent {exponent} cannot be exported; allowed: exponent 0"
                )));
            }
            Light::Area {
                shape, radiance, ..
            } => {
                self.xml
                    .comment("the light shines along z; its back is dark");
                let looks = [emitter(*radiance), xml::black()].concat();
                self.xml.flat("light", shape, 0.0, &looks);
            }
            Light::Point { intensity } => {
                self.xml
                    .comment("the light: a point that emits ahead only, as a spot of 90 degrees");
                self.xml.point_light(*intensity);
            }
            Light::Projector { intensity, image } => self.projector(*intensity, image),
            Light::Beam { irradiance, image } => self.beam(*irradiance, image),
            Light::Environment { environment } => {
                let (width, values) = sky::map(environment);
                let file = self.file("sky.pfm", pfm(width, &values));
                self.xml
                    .comment("the sky; directions against the central ray are dark, as in Étendue");
                self.xml.sky(&file, &environment.frame);
            }
            Light::Rays { .. } => {
                let what = "light that consists of rays: the rays of a file cannot be exported";
                return Err(NotInMitsuba::Light(what.to_owned()));
            }
        }
        Ok(())
    }

    /// Writes further lights. Lights overlap if their bounds overlap.
    pub(super) fn other_lights(&mut self, scene: &Scene) -> Result<(), NotInMitsuba> {
        let flat = |of: &Scene| match of.light {
            Light::Area {
                shape,
                radiance,
                exponent,
            } if exponent <= 0.0 && of.path == scene.path => Ok((shape, radiance)),
            _ => Err(NotInMitsuba::Lights),
        };
        let all: Vec<_> = scene.lights().map(flat).collect::<Result<_, _>>()?;
        for (i, (shape, radiance)) in all.iter().enumerate().skip(1) {
            let own = shape.bounds();
            let overlaps = |(other, _): &(Shape, f64)| {
                let other = other.bounds();
                (0..2).all(|axis| {
                    let [a, b] = [own.extent(axis), other.extent(axis)];
                    a[0] < b[1] && b[0] < a[1]
                })
            };
            if all[..i].iter().any(overlaps) {
                return Err(NotInMitsuba::Lights);
            }
            let looks = [emitter(*radiance), xml::black()].concat();
            let id = format!("light_{}", i + 1);
            self.xml.comment(&format!("light {}", i + 1));
            self.xml.flat(&id, shape, 0.0, &looks);
        }
        Ok(())
    }

    /// The irradiance of Mitsuba's projector is the intensity divided by π (1 + u² + v²)^(3/2), as
    /// measured with 3.9.1. In its picture, −x points to the right and y points up.
    fn projector(&mut self, intensity: f64, image: &Image) {
        let half = WIDTHS * image.width[0].max(image.width[1]);
        let picture = sampled([PIXELS; 2], |column, row| {
            let [u, v] = [column, row].map(|at| half * (1.0 - 2.0 * at / PIXELS as f64));
            let s2 = 1.0 + u * u + v * v;
            intensity * image.value(u, v) / (PI * s2 * s2.sqrt())
        });
        self.xml.comment(&error_of(image, half));
        let file = self.file("picture.pfm", pfm(picture.0, &picture.1));
        let angle = 2.0 * libm::atan(half).to_degrees();
        self.xml.projector(&file, angle);
    }

    /// Writes a sheet that emits along its normal. The picture of the sheet has x to the right and
    /// y down.
    fn beam(&mut self, irradiance: f64, image: &Image) {
        let half = WIDTHS * image.width[0].max(image.width[1]);
        let picture = sampled([PIXELS; 2], |column, row| {
            let [x, y] = [column, row].map(|at| half * (2.0 * at / PIXELS as f64 - 1.0));
            irradiance * image.value(x, y)
        });
        self.xml.comment(&error_of(image, half));
        let file = self.file("picture.pfm", pfm(picture.0, &picture.1));
        let looks = format!(
            "<emitter type=\"directionalarea\">{}</emitter>{}",
            xml::picture("radiance", &file),
            xml::black()
        );
        let sheet = Shape::Rectangle(Rectangle {
            center: [0.0; 2],
            size: [2.0 * half; 2],
        });
        self.xml.flat("light", &sheet, 0.0, &looks);
    }
}

/// The error of a picture of a smooth function that is interpolated linearly between
/// pixels. The error is an eighth of the second derivative times the squared pixel width.
fn error_of(image: &Image, half: f64) -> String {
    let pixel = 2.0 * half / PIXELS as f64;
    let narrow = image.width[0].min(image.width[1]);
    // The second derivative of exp(−π a²/w²) is at most 2π/w², and the second derivative of the
    // grating is at most (2πf)²/2.
    let wave = image
        .grating
        .map_or(0.0, |g| 2.0 * PI * PI * g.frequency * g.frequency);
    let error = pixel * pixel / 8.0 * (2.0 * PI / (narrow * narrow) + wave);
    format!(
        "the light: a picture of {PIXELS} by {PIXELS} pixels, with errors of at most {error:.1e} of its peak"
    )
}
