//! Scenes of pbrt-v4.
//!
//! `token`, `parameter` and `directive` turn the files into a [`scene::Scene`]; `reader` and the
//! modules below it turn this scene into a world. Each parameter that is read is marked, and each
//! parameter without a mark becomes a note. Conventions are those of pbrt-v4's source.
//!
//! # Light
//!
//! The value of a light is that of a pixel in which pbrt shows the light, with the default sensor
//! and an imaging ratio of 1. pbrt divides each light by the integral of its spectrum with the
//! eye's sensitivity ȳ, and for an `rgb` by that of the white of its colour space; its sensor does
//! not divide again. So
//!
//! * `rgb L [r g b]` is the colour (r, g, b) in linear sRGB, times `scale`: (1, 1, 1) shows 1 in each channel, and has luminance 1;
//! * `blackbody` and `spectrum` have luminance 1, whatever their values, times `scale`: only their colour is that of the spectrum;
//! * without any of these, a light is white: (1, 1, 1);
//! * `power` and `illuminance` above 0 apply to white light: a colour of luminance 1 is
//!   multiplied by the required value, divided by the value that the light has with radiance or
//!   intensity 1.
//!
//! Reflectances and indices are colours in linear sRGB too. Spectra of reflectances and indices
//! are weighted with D65 and converted as described at [`Color`](crate::Color).
//!
//! # Space
//!
//! pbrt's left-handed coordinates are kept. The camera's map mirrors instead, so its X points to
//! the left of the picture. A mirror does not change light transport. The front of a surface is
//! where pbrt's normal points.
//!
//! # Limits
//!
//! Limits: files nest at most 64 deep and 16384 in all, blocks 4096 deep, textures 16 and materials
//! 8; at most 256 parameters of `Attribute` at once; at most 2²⁰ shapes with all instances. At most
//! 4 GiB are read and unpacked in all.

mod area;
mod block;
mod build;
mod camera;
mod directive;
mod entity;
mod imagemap;
mod include;
mod keys;
mod leftover;
mod light;
mod material;
mod mesh;
mod named;
mod parameter;
mod reader;
mod scene;
mod shape;
mod sky;
mod spectrum;
mod texture;
mod token;
mod transform;
mod words;

use crate::main_file::MainFile;
use crate::report::Report;
use crate::{Imported, Options, Refused};
use std::path::Path;

pub(crate) fn import(file: &Path, options: &Options) -> Result<Imported, Refused> {
    let file = MainFile::open(file, options)?;
    let text = include::read(&file.files, &file.path).map_err(|error| file.refused(error))?;
    read(&text, &file, options)
}

pub(crate) fn import_text(
    text: &str,
    folder: &Path,
    options: &Options,
) -> Result<Imported, Refused> {
    read(
        text,
        &MainFile::of_text(folder, "text.pbrt", options)?,
        options,
    )
}

fn read(text: &str, file: &MainFile<'_>, options: &Options) -> Result<Imported, Refused> {
    let (files, report, whole) = (&file.files, Report::default(), file.place());
    for (name, _) in &options.set {
        let message = format!("{name} is set, but pbrt files have no parameters");
        report.cause(&whole, message);
    }
    let scene = build::Builder::new(files, &report, &file.path).build(text, &file.name);
    let reader = reader::PbrtReader::new(&scene, files, &report, options.color, file.folder());
    let world = reader.world(&whole);
    leftover::tell(&scene, &report);
    report.finish(world)
}
