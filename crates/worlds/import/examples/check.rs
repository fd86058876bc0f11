//! Imports scenes and prints the content of their worlds, all notes and all causes.
//!
//!     cargo run --example check -p etendue-import -- [--root FOLDER] [--set NAME=VALUE] SCENE...

#![allow(clippy::print_stdout, reason = "the example prints its results")]

use etendue_import::{Options, import};
use std::path::PathBuf;

fn main() {
    let mut options = Options::default();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--root" => options.root = arguments.next().map(PathBuf::from),
            "--set" => {
                let given = arguments.next().unwrap_or_default();
                let (name, value) = given.split_once('=').unwrap_or((&given, ""));
                options.set.push((name.to_owned(), value.to_owned()));
            }
            file => check(file, &options),
        }
    }
}

fn check(file: &str, options: &Options) {
    match import(file.as_ref(), options) {
        Ok(imported) => {
            let world = &imported.world;
            println!(
                "{file}: {} shapes, {} materials, {} lights, {} cameras, depth {:?}",
                world.shapes.len(),
                world.materials.len(),
                world.lights.len(),
                world.cameras.len(),
                world.depth
            );
            for note in imported.notes {
                println!("  note {note}");
            }
        }
        Err(refused) => {
            println!("{file}: refused");
            for cause in refused.causes {
                println!("  cause {cause}");
            }
        }
    }
}
