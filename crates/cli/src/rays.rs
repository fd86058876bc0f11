//! Implements `etendue rays`, which describes a ray file and converts it to another format.

use crate::args::RaysArgs;
use crate::print::{deliver, say};
use etendue_rayfile::{Format, MEMORY, MEMORY_FREE, RayFile, convert, gz};
use etendue_report::ray_file;
use etendue_scene::read_file;
use etendue_store::output::OutputFile;
use etendue_store::{Failure, machine};
use std::path::Path;

/// The largest size of a ray file, in bytes.
const MOST_BYTES: u64 = 1 << 34;

/// Runs `etendue rays`; returns the exit code.
pub(crate) fn rays(args: &RaysArgs) -> Result<u8, Failure> {
    let format = args.out.as_deref().map(format_of).transpose()?;
    let path = &args.file;
    let refused = |e: &dyn std::fmt::Display| {
        Failure::bad_input(format!("cannot read {}: {e}", path.display()))
    };
    let bytes = read_file(path, MOST_BYTES).map_err(|e| refused(&e))?;
    check_memory(path, bytes.len())?;
    let out = args.out.as_deref();
    let inputs = [path.clone()];
    let out = out.map(|out| OutputFile::claim(out, args.force.force, &inputs));
    let out = out.transpose()?;
    let file = RayFile::read(&bytes).map_err(|fault| refused(&fault))?;
    deliver(&ray_file::description(&file, gz::is_packed(&bytes)).join("\n"))?;
    drop(bytes);
    if let (Some(out), Some(format)) = (out, format) {
        let converted = convert(&file, format).map_err(|fault| {
            let message = format!("{} cannot be written as {format}: {fault}", path.display());
            Failure::bad_input(message)
        })?;
        out.write(&converted.bytes)?;
        for note in converted.notes {
            say(&format!("note: {note}"));
        }
        let written = args.out.as_deref().unwrap_or(Path::new(""));
        say(&format!("written as {format}: {}", written.display()));
    }
    Ok(0)
}

fn format_of(path: &Path) -> Result<Format, Failure> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Format::of_name(&name).ok_or_else(|| {
        let message = format!(
            "--out {}: allowed endings: .tm25ray, .mcpl, .mcpl.gz, .npy",
            path.display()
        );
        Failure::bad_input(message)
    })
}

/// Checks that there is enough memory to read a file; for a gzip file, the unpacked size is known
/// only after reading.
fn check_memory(path: &Path, length: usize) -> Result<(), Failure> {
    // The memory in bytes for the content of the file and for its description.
    let needed = (length * (MEMORY + 2) + MEMORY_FREE) as u64;
    let free = machine::available_memory();
    if needed > free {
        return Err(Failure::cannot_run(format!(
            "{}: reading it takes {:.1} GB of memory, but only {:.1} GB are free",
            path.display(),
            needed as f64 / 1e9,
            free as f64 / 1e9
        )));
    }
    Ok(())
}
