//! Lights of a scene file, checked.

use super::Resolver;
use crate::file::{BulbFile, ImageFile, LightFile};
use etendue_field::{Disc, Frame, Image, Light, Rectangle, Shape};

impl LightFile {
    /// Where the central ray leaves it, world coordinates.
    pub(super) fn center(&self) -> [f64; 3] {
        match self {
            Self::Rectangle { center, .. }
            | Self::Disc { center, .. }
            | Self::Point { center, .. }
            | Self::Spot { center, .. }
            | Self::Projector { center, .. }
            | Self::Beam { center, .. }
            | Self::Environment { center, .. }
            | Self::Rays { center, .. } => *center,
        }
    }
}

/// Highest exponent of a spot: it is 0.01 rad wide.
const SHARPEST: f64 = 1e4;

impl Resolver<'_> {
    /// The light, around the origin of the central ray, where its frame is.
    #[expect(clippy::too_many_lines, reason = "a case for each kind of light")]
    pub(super) fn light(&mut self, light: &LightFile, frame: &Frame) -> Light {
        self.faults.coordinates("light.center", &light.center());
        let area = |shape: Shape, radiance: f64, exponent: f64| Light::Area {
            shape,
            radiance,
            exponent,
        };
        match *light {
            LightFile::Rectangle { size, radiance, .. } => {
                self.size("light", &size);
                self.faults.positive("light.radiance", radiance);
                area(square(size), radiance, 0.0)
            }
            LightFile::Disc {
                radius, radiance, ..
            } => {
                self.faults.positive("light.radius", radius);
                self.faults.positive("light.radiance", radiance);
                area(disc(radius), radiance, 0.0)
            }
            LightFile::Point { intensity, .. } => {
                self.faults.positive("light.intensity", intensity);
                Light::Point { intensity }
            }
            LightFile::Projector {
                intensity,
                ref image,
                ..
            } => {
                self.faults.positive("light.intensity", intensity);
                let image = self.image(image);
                Light::Projector { intensity, image }
            }
            LightFile::Beam {
                irradiance,
                ref image,
                ..
            } => {
                self.faults.positive("light.irradiance", irradiance);
                let image = self.image(image);
                Light::Beam { irradiance, image }
            }
            LightFile::Environment {
                ref up,
                ref front,
                scale,
                ref map,
                ..
            } => self.environment([up, front], scale, map, frame),
            LightFile::Rays {
                file: ref name,
                front,
                up,
                flux,
                ..
            } => self.rays(name, [front, up], flux, frame),
            LightFile::Spot {
                bulb,
                radiance,
                exponent,
                ..
            } => {
                self.faults.positive("light.radiance", radiance);
                self.faults
                    .within("light.exponent", exponent, 0.0..=SHARPEST);
                let (BulbFile::Square(size) | BulbFile::Disc(size)) = bulb;
                self.faults.positive("light.bulb", size);
                match bulb {
                    BulbFile::Square(side) => area(square([side; 2]), radiance, exponent),
                    BulbFile::Disc(radius) => area(disc(radius), radiance, exponent),
                }
            }
        }
    }
}

impl Resolver<'_> {
    fn image(&mut self, file: &ImageFile) -> Image {
        for (i, width) in file.width.iter().enumerate() {
            self.faults
                .positive(format!("light.image.width[{i}]"), *width);
        }
        let grating = file.grating.as_ref();
        Image {
            width: file.width,
            grating: grating.map(|g| self.grating("light.image.grating", g)),
        }
    }
}

fn square(size: [f64; 2]) -> Shape {
    Shape::Rectangle(Rectangle {
        center: [0.0; 2],
        size,
    })
}

fn disc(radius: f64) -> Shape {
    Shape::Disc(Disc {
        center: [0.0; 2],
        radius,
    })
}
