use crate::args::SceneArgs;
use crate::failure::Failure;
use crate::machine;
use etendue_scene::{RunFile, Scene, SceneError, SceneFile, resolve};
use std::fs;

/// Reads, overrides and resolves the scene named on the command line; `options` are overrides of the command
/// line's own.
pub(crate) fn scene(
    args: &SceneArgs,
    options: impl FnOnce(&mut RunFile),
) -> Result<Scene, Failure> {
    let path = &args.path;
    let shown = path.display();
    let text = fs::read_to_string(path)
        .map_err(|e| Failure::bad_input(format!("cannot read {shown}: {e}")))?;
    let mut file =
        SceneFile::parse(&text).map_err(|e| Failure::bad_input(format!("{shown}: {e}")))?;
    for (field, value) in &args.set {
        file = file.with(field, value).map_err(Failure::bad_input)?;
    }
    options(&mut file.run);
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    resolved(&name, file, &shown.to_string())
}

/// Resolves a scene file for this machine; `shown` is where it comes from, for messages.
pub(crate) fn resolved(name: &str, file: SceneFile, shown: &str) -> Result<Scene, Failure> {
    resolve(name, file, machine::available_memory()).map_err(|error| {
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
