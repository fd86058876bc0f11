//! Scenes of pbrt-v4.
//!
//! `token`, `entity` and `directive` turn the files into a [`scene::PbrtScene`]. `reader` and the
//! modules below it turn this scene into a world. Each parameter that is read is marked, and each
//! parameter without a mark becomes a note. Conventions follow the source of pbrt-v4.
//!
//! # Light
//!
//! The value of a light is the value of a pixel that shows the light in a picture by pbrt, with the
//! default sensor and an imaging ratio of 1. The program pbrt divides each light by an integral.
//! This integral is over the product of the eye's sensitivity ȳ and the spectrum of the light; for
//! an `rgb`, the white of the colour space replaces the spectrum. The sensor of pbrt does not
//! divide again. The values of lights are therefore:
//!
//! * `rgb L [r g b]` is the colour (r, g, b) in linear sRGB, times `scale`. The colour (1, 1, 1)
//!   shows 1 in each channel, and has luminance 1.
//! * `blackbody` and `spectrum` have luminance 1 times `scale`, whatever their values. Only the
//!   colour of the light depends on the spectrum.
//! * A light without `rgb`, `blackbody` or `spectrum` is white, with the colour (1, 1, 1).
//! * `power` and `illuminance` above 0 apply to white light. A colour of luminance 1 is multiplied
//!   by the required value, divided by the value that the light has with radiance or intensity 1.
//!
//! Reflectances and indices of refraction are also colours in linear sRGB. Spectra of reflectances
//! and indices are weighted with D65 and converted as described at [`Color`](crate::Color).
//!
//! # Space
//!
//! The left-handed coordinates of pbrt are kept. The map of the camera mirrors coordinates instead,
//! so the camera's X axis points to the left of the picture. Mirrored coordinates do not change
//! light transport. The front of a surface is the side to which pbrt's normal points.
//!
//! # Limits
//!
//! The maximum nesting depth is 64 for files, 4096 for blocks, 16 for textures and 8 for materials.
//! A scene has at most 16384 included files, 256 parameters of `Attribute` at once, and 2²⁰ shapes
//! including instances. At most 4 GiB are read and unpacked in all.

mod build;
mod camera;
mod directive;
mod entity;
mod light;
mod material;
mod mesh;
mod reader;
mod scene;
mod shape;
mod sky;
mod spectrum;
mod texture;
mod token;
mod transform;

use crate::main_file::MainFile;
use crate::{Imported, Options, Refused};
use std::path::Path;

pub(crate) fn import(file: &Path, options: &Options) -> Result<Imported, Refused> {
    let file = MainFile::open(file, options)?;
    let text = build::read(&file.files, &file.path).map_err(|error| file.refused(error))?;
    read(&text, file)
}

pub(crate) fn read(text: &str, file: MainFile<'_>) -> Result<Imported, Refused> {
    let whole = file.place();
    for (name, _) in &file.options.set {
        let message = format!("{name} is set, but pbrt files have no parameters");
        file.report.cause(&whole, message);
    }
    let scene = build::Builder::new(&file).build(text, &file.name);
    let world = reader::PbrtReader::new(&scene, &file).world(&whole);
    scene::tell_unused(&scene, &file.report);
    file.finish(world)
}
