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

use crate::files::Files;
use crate::report::{Report, SourcePlace};
use crate::{Imported, Options, Refused};
use std::path::Path;

pub(crate) fn import(file: &Path, options: &Options) -> Result<Imported, Refused> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let unread = |error: String| Refused::because(file, error);
    let root = options.root.as_deref().unwrap_or(folder);
    let files = Files::below(root).map_err(|error| unread(error.to_string()))?;
    // The scene itself is named by who asks, and need not be below the root.
    let path = file
        .canonicalize()
        .map_err(|error| unread(error.to_string()))?;
    let text = include::read(&files, &path).map_err(unread)?;
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    read(&text, &name, &path, &files, options)
}

pub(crate) fn import_text(
    text: &str,
    folder: &Path,
    options: &Options,
) -> Result<Imported, Refused> {
    let unread = |error: std::io::Error| Refused::because(folder, error.to_string());
    let root = options.root.as_deref().unwrap_or(folder);
    let files = Files::below(root).map_err(unread)?;
    let path = folder.canonicalize().map_err(unread)?.join("text.pbrt");
    read(text, "text", &path, &files, options)
}

fn read(
    text: &str,
    name: &str,
    path: &Path,
    files: &Files,
    options: &Options,
) -> Result<Imported, Refused> {
    let report = Report::default();
    let whole = SourcePlace::whole(name);
    for (name, _) in &options.set {
        let message = format!("{name} is set, but pbrt's files have no parameters of their own");
        report.cause(&whole, message);
    }
    let scene = build::Builder::new(files, &report, path).build(text, name);
    let folder = path.parent().unwrap_or(path).to_owned();
    let reader = reader::PbrtReader::new(&scene, files, &report, options.color, folder);
    let world = reader.world(&whole);
    leftover::tell(&scene, &report);
    report.finish(world)
}
