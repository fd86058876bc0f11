use crate::args::SceneArgs;
use crate::failure::Failure;
use crate::machine;
use crate::results::Results;
use etendue_scene::{RunFile, Scene, SceneError, SceneFile, resolve};
use std::fs;
use std::path::Path;

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
    resolved(&name, file, folder(args), &shown.to_string())
}

/// The folder of the scene file, in which its meshes and pictures are.
fn folder(args: &SceneArgs) -> &Path {
    args.path.parent().unwrap_or(Path::new(""))
}

/// Copies the meshes and pictures of a scene into a stage's folder, where the next stage looks for them.
pub(crate) fn copy_files(
    results: &mut Results,
    scene: &Scene,
    args: &SceneArgs,
) -> Result<(), Failure> {
    for name in scene.file.named_files() {
        let path = folder(args).join(name);
        let shown = path.display();
        let bytes =
            fs::read(&path).map_err(|e| Failure::bad_input(format!("cannot read {shown}: {e}")))?;
        results.write(name, &bytes)?;
    }
    Ok(())
}

/// Resolves a scene file for this machine; its meshes are in `folder`, and `shown` is where it comes from, for messages.
pub(crate) fn resolved(
    name: &str,
    file: SceneFile,
    folder: &Path,
    shown: &str,
) -> Result<Scene, Failure> {
    resolve(name, file, folder, machine::available_memory()).map_err(|error| {
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
