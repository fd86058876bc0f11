//! Scenes of Mitsuba 3, in XML.
//!
//! `xml` turns the files into objects. `reader` and the modules below it turn the objects into a
//! world. Each property that is read is marked, and each property without a mark becomes a note.
//! Conventions were checked against Mitsuba 3.9.1.

mod ask;
mod index;
mod light;
mod material;
mod mesh;
mod mesh_data;
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
use crate::{Imported, Options, Refused};
use etendue_world::World;
use std::path::Path;

pub(crate) fn import(file: &Path, options: &Options) -> Result<Imported, Refused> {
    let file = MainFile::open(file, options)?;
    let text = files::text(file.read()?).map_err(|error| file.refused(error))?;
    read(text, file)
}

/// Reads the text of a scene, which is dropped when it has become a tree.
pub(crate) fn read(text: String, file: MainFile<'_>) -> Result<Imported, Refused> {
    let mut tree = xml::Tree::new(&file);
    tree.read(&text, &file);
    drop(text);
    let mut world = World::default();
    if !tree.objects.is_empty() {
        world = reader::MitsubaReader::new(&tree, file.options.color).world();
        object::tell_unused(&tree.objects);
    }
    file.finish(world)
}
