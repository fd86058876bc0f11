//! Implements `etendue new`: writes a first scene.

use crate::args::{NewArgs, SCENES};
use crate::print::deliver;
use etendue_store::Failure;
use std::fs::File;
use std::io::{ErrorKind, Write};

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
