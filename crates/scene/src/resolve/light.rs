//! Checks the light of a scene file.

use super::Resolver;
use super::reflectance::grating_of;
use etendue_field::{Disc, Frame, Image, Light, Rectangle, Shape};
use etendue_scenefile::{BulbFile, ColorFile, ImageFile, LightFile};

impl Resolver<'_> {
    /// The light at the origin of the central ray, which is the origin of the frame at
    /// the light.
    pub(super) fn light(&mut self, light: &LightFile, frame: &Frame) -> Light {
        let number = |color: ColorFile| color.number(self.color);
        let area = |shape: Shape, radiance: ColorFile, exponent: f64| Light::Area {
            shape,
            radiance: number(radiance),
            exponent,
        };
        match *light {
            LightFile::Rectangle { size, radiance, .. } => area(square(size), radiance, 0.0),
            LightFile::Disc {
                radius, radiance, ..
            } => area(disc(radius), radiance, 0.0),
            LightFile::Point { intensity, .. } => Light::Point {
                intensity: number(intensity),
            },
            LightFile::Projector {
                intensity,
                ref image,
                ..
            } => Light::Projector {
                intensity: number(intensity),
                image: image_of(image),
            },
            LightFile::Beam {
                irradiance,
                ref image,
                ..
            } => Light::Beam {
                irradiance: number(irradiance),
                image: image_of(image),
            },
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
            } => match bulb {
                BulbFile::Square(side) => area(square([side; 2]), radiance, exponent),
                BulbFile::Disc(radius) => area(disc(radius), radiance, exponent),
            },
        }
    }
}

fn image_of(file: &ImageFile) -> Image {
    let grating = file.grating.as_ref();
    Image {
        width: file.width,
        grating: grating.map(grating_of),
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
