//! Scenes of pbrt-v4.
//!
//! `token`, `parameter` and `directive` make a [`scene::Scene`] of the files; `reader` and what follows make a world of it. Each parameter that is
//! asked for is marked, and what is left without a mark becomes a note. Conventions are those of pbrt-v4's source.
//!
//! # Light
//!
//! A light's number is what a pixel of pbrt's own picture shows of it with the default sensor and an imaging ratio of 1. pbrt divides each light by what
//! its spectrum adds up to with the eye's sensitivity ȳ, and for an `rgb` by that of the white of its colour space; its sensor does not divide again. So
//!
//! * `rgb L [r g b]` is the colour (r, g, b) in linear sRGB, times `scale`: (1, 1, 1) shows 1 in each channel, and has luminance 1;
//! * `blackbody` and `spectrum` have luminance 1, whatever their values, times `scale`: only their colour is that of the spectrum;
//! * nothing is white: (1, 1, 1);
//! * `power` and `illuminance` above 0 are those of white light: a number of luminance 1 is multiplied with them over what the light sends out for 1.
//!
//! Reflectances and indices are colours in linear sRGB too; spectra of them become such, weighed with D65, as [`Color`](crate::Color) says.
//!
//! # Space
//!
//! pbrt's coordinates are left-handed. They stay as they are, and the camera's map mirrors instead: its X goes to the left of the picture. A mirror leaves
//! all that light does as it is. The front of a surface is where pbrt's normal points.
//!
//! # Limits
//!
//! Files are at most 64 in one another and 16384 in all, blocks 4096, textures 16 and materials 8 in one another; parameters of `Attribute` at most
//! 256 at once; shapes at most 2²⁰ with all instances. What is read and unpacked is at most 4 GiB in all.

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
        let message = format!("{name} is set, but pbrt's files have no parameters of their own");
        report.cause(&whole, message);
    }
    let scene = build::Builder::new(files, &report, &file.path).build(text, &file.name);
    let reader = reader::PbrtReader::new(&scene, files, &report, options.color, file.folder());
    let world = reader.world(&whole);
    leftover::tell(&scene, &report);
    report.finish(world)
}
