use crate::args::ExportArgs;
use crate::failure::Failure;
use crate::{load, say};
use std::fs;
use std::path::Path;

/// `etendue export`: returns the exit code.
pub(crate) fn export(args: &ExportArgs) -> Result<u8, Failure> {
    let scene = load::scene(&args.scene, |_| ())?;
    // One other program is known so far, and clap has checked that it is meant.
    let export = etendue_export::mitsuba(&scene).map_err(Failure::bad_input)?;
    let folder = args
        .out
        .clone()
        .unwrap_or_else(|| Path::new("out").join(format!("{}-mitsuba", scene.name)));
    fs::create_dir_all(&folder).map_err(|e| Failure::write(&folder, e))?;
    for (name, bytes) in &export.files {
        let path = folder.join(name);
        fs::write(&path, bytes).map_err(|e| Failure::write(&path, e))?;
    }
    say(&format!("{}: exported to {}", scene.name, folder.display()));
    Ok(0)
}
