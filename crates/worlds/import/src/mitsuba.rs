//! Scenes of Mitsuba 3, in XML.
//!
//! `xml` turns the files into objects. `reader` and the modules below it turn the objects into a
//! world. Each property that is read is marked, and each property without a mark becomes a note.
//! Conventions were checked against Mitsuba 3.9.1.

mod ask;
mod include;
mod index;
mod integrator;
mod light;
mod material;
mod mesh;
mod mesh_data;
mod metals;
mod object;
mod parameters;
mod property;
mod reader;
mod sensor;
mod serialized;
mod shape;
mod texture;
mod transform;
mod upgrade;
mod value;
mod xml;

use crate::files;
use crate::main_file::MainFile;
use crate::report::Report;
use crate::{Imported, Options, Refused};
use etendue_world::World;
use std::path::Path;

pub(crate) fn import(file: &Path, options: &Options) -> Result<Imported, Refused> {
    let file = MainFile::open(file, options)?;
    let text = files::text(file.read()?).map_err(|error| file.refused(error))?;
    read(text, &file, options)
}

pub(crate) fn import_text(
    text: &str,
    folder: &Path,
    options: &Options,
) -> Result<Imported, Refused> {
    read(
        text.to_owned(),
        &MainFile::of_text(folder, "text.xml", options)?,
        options,
    )
}

fn read(text: String, file: &MainFile<'_>, options: &Options) -> Result<Imported, Refused> {
    let (files, report) = (&file.files, Report::default());
    let mut tree = xml::Tree::new(files, &report, &options.set);
    tree.read(&text, &file.name, &file.path);
    drop(text);
    let (objects, ids) = (tree.objects, tree.ids);
    let mut world = World::default();
    if !objects.is_empty() {
        let reader = reader::MitsubaReader::new(&objects, &ids, files, &report, options.color);
        world = reader.world();
        object::tell_unused(&objects, &report);
    }
    report.finish(world, files)
}
