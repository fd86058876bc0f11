use crate::args::SceneArgs;
use crate::failure::Failure;
use crate::machine;
use etendue_scene::{Scene, SceneError, SceneFile, resolve};
use std::fs;

/// Reads, overrides and resolves the scene named on the command line.
///
/// `more` are overrides of the command line's own options, such as `run.photons`.
pub(crate) fn scene(args: &SceneArgs, more: &[(&str, String)]) -> Result<Scene, Failure> {
    let path = &args.path;
    let shown = path.display();
    let text = fs::read_to_string(path)
        .map_err(|e| Failure::bad_input(format!("cannot read {shown}: {e}")))?;
    let mut file =
        SceneFile::parse(&text).map_err(|e| Failure::bad_input(format!("{shown}: {e}")))?;
    let set = args.set.iter().map(|(p, v)| (p.as_str(), v));
    let more = more.iter().map(|(p, v)| (*p, v));
    for (field, value) in set.chain(more) {
        file = file.with(field, value).map_err(Failure::bad_input)?;
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    resolve(&name, file, machine::available_memory()).map_err(|error| {
        let message = format!("{shown}:\n{error}");
        match &error {
            // The scene is sound; it is this machine that is too small.
            SceneError::Values(faults) if faults.iter().all(|f| f.memory) => {
                Failure::cannot_run(message)
            }
            _ => Failure::bad_input(message),
        }
    })
}
