//! Scenes of Mitsuba 3, in XML.
//!
//! `xml` makes objects of the files; `reader` and what follows make a world of the objects. Each property that is asked for is marked, and what is
//! left without a mark becomes a note. Conventions were held against Mitsuba 3.9.1.

mod ask;
mod cube;
mod include;
mod index;
mod integrator;
mod leftover;
mod light;
mod material;
mod mesh;
mod mesh_key;
mod metals;
mod nested;
mod object;
mod parameters;
mod property;
mod property_names;
mod reader;
mod sensor;
mod serialized;
mod shape;
mod source;
mod texture;
mod transform;
mod upgrade;
mod value;
mod xml;

use crate::files::Files;
use crate::report::Report;
use crate::{Imported, Options, Refused};
use etendue_world::World;
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
    let bytes = files.read(&path).map_err(unread)?;
    let text = String::from_utf8(bytes).map_err(|_| unread("is no UTF-8".to_owned()))?;
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
    let path = folder.canonicalize().map_err(unread)?.join("text.xml");
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
    let mut tree = xml::Tree::new(files, &report, &options.set);
    tree.read(text, name, path);
    let (objects, ids) = (tree.objects, tree.ids);
    let mut world = World::default();
    if !objects.is_empty() {
        let reader = reader::MitsubaReader::new(&objects, &ids, files, &report, options.color);
        world = reader.world();
        leftover::tell(&objects, &report);
    }
    report.finish(world)
}
