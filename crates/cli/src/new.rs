//! Implements `etendue new`: writes a first scene.

use crate::args::NewArgs;
use crate::print::deliver;
use etendue_scenes::{FIG9B, FIG10, TABLE1_SOLAR_OVEN, TABLE1_TEXTURED_GLOSSY, TABLE1_TRAVEL};
use etendue_store::Failure;
use std::fs::File;
use std::io::{ErrorKind, Write};

/// The texts of the scenes, each with its name and a description.
pub(crate) const SCENES: [(&str, &str, &str); 5] = [
    (
        FIG9B,
        "blockers",
        "A square light, small blockers and a floor",
    ),
    (
        TABLE1_TRAVEL,
        "travel",
        "A slide of bars at three distances",
    ),
    (TABLE1_SOLAR_OVEN, "mirror", "A beam on a hollow mirror"),
    (
        TABLE1_TEXTURED_GLOSSY,
        "glossy",
        "A projector and a glossy sphere with a texture",
    ),
    (
        FIG10,
        "curved",
        "Seven steps of a reflection off a curved glossy surface",
    ),
];

/// Runs `etendue new`; returns the exit code.
pub(crate) fn new(args: &NewArgs) -> Result<u8, Failure> {
    let named = SCENES.iter().find(|(text, ..)| *text == args.text);
    let (_, name, about) = named.unwrap_or(&SCENES[0]);
    let path = args.out.clone();
    let path = path.unwrap_or_else(|| format!("{name}.ron").into());
    // A scene of the user is never replaced.
    let mut file = File::create_new(&path).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => Failure::cannot_run(format!(
            "{} exists and is not replaced: choose another file with --out",
            path.display()
        )),
        _ => Failure::write(&path, error),
    })?;
    let written = file.write_all(args.text.as_bytes());
    written.map_err(|error| Failure::write(&path, error))?;
    let shown = path.display();
    deliver(&format!("{shown}: {about}\nnext: etendue run {shown}"))?;
    Ok(0)
}
