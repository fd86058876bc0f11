//! A scene file, read and resolved; and folders for what a stage makes of it.

use etendue_scene::{
    RunFile, Scene, SceneError, SceneFile, limits, read_below, read_file, resolve,
};
use etendue_store::Failure;
use etendue_store::machine;
use etendue_store::stored::copy_of;
use etendue_store::{Plan, Results};
use std::path::{Path, PathBuf};

/// A scene file, and what is set in it.
#[derive(Clone, Debug)]
pub struct SceneSource {
    /// The file, in RON or JSON.
    pub path: PathBuf,
    /// Fields set to values, each as by [`SceneFile::with`].
    pub set: Vec<(String, String)>,
}

/// Reads, overrides and resolves the scene named on the command line; `options` are overrides of the command
/// line's own.
pub fn scene(source: &SceneSource, options: impl FnOnce(&mut RunFile)) -> Result<Scene, Failure> {
    let path = &source.path;
    let shown = path.display();
    let unreadable =
        |e: &dyn std::fmt::Display| Failure::bad_input(format!("cannot read {shown}: {e}"));
    let bytes = read_file(path, limits::FILE_BYTES).map_err(|e| unreadable(&e))?;
    let text = str::from_utf8(&bytes).map_err(|e| unreadable(&e))?;
    let mut file =
        SceneFile::parse(text).map_err(|e| Failure::bad_input(format!("{shown}: {e}")))?;
    let refused = |e| Failure::bad_input(format!("{shown}: --set {e}"));
    file = file.with_all(&source.set).map_err(refused)?;
    let photons = file.run.photons;
    options(&mut file.run);
    let mut set = named(&source.set);
    if file.run.photons != photons {
        let option = format!("--photons {}", file.run.photons);
        set.push(("run.photons".to_owned(), option));
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let scene = resolve(&name, file, folder(source), machine::available_memory());
    scene.map_err(|error| self::refused(&error, &shown.to_string(), text, &set))
}

/// For each field that was set, what has set it.
pub fn named(set: &[(String, String)]) -> Vec<(String, String)> {
    let set = set.iter();
    set.map(|(path, value)| (path.clone(), format!("--set {path}={value}")))
        .collect()
}

/// What is wrong with a scene, a line for each fault: where it is in the text, or what has set it.
pub fn refused(error: &SceneError, shown: &str, text: &str, set: &[(String, String)]) -> Failure {
    let lines = error.in_text(text, set);
    let lines = lines.lines().map(|line| format!("{shown}: {line}"));
    Failure::of_scene(error, lines.collect::<Vec<_>>().join("\n"))
}

/// The folder of the scene file, in which its meshes and pictures are.
fn folder(source: &SceneSource) -> &Path {
    source.path.parent().unwrap_or(Path::new(""))
}

/// The scene file, and all that it names.
pub fn inputs(source: &SceneSource, scene: &Scene) -> Vec<PathBuf> {
    let named = scene.inputs.keys().map(|name| folder(source).join(name));
    named.chain([source.path.clone()]).collect()
}

/// Claims a folder for a stage with these files, and copies the meshes and pictures of the scene there: the next
/// stage looks for them beside the index.
pub fn stage(
    out: &Path,
    index: &'static str,
    mut files: Vec<String>,
    scene: &Scene,
    source: &SceneSource,
    force: bool,
) -> Result<Results, Failure> {
    files.extend(scene.inputs.keys().map(|name| copy_of(index, name)));
    let plan = Plan {
        index,
        files,
        inputs: inputs(source, scene),
        force,
    };
    let mut results = Results::claim(out, plan)?;
    for (name, hash) in &scene.inputs {
        let path = folder(source).join(name);
        let shown = path.display();
        let bytes = read_below(folder(source), name, u64::MAX)
            .map_err(|e| Failure::bad_input(format!("cannot read {shown}: {e}")))?;
        if *hash != blake3::hash(&bytes).to_hex().as_str() {
            let message = format!("{shown} changed while it was read");
            return Err(Failure::bad_input(message));
        }
        results.write(&copy_of(index, name), &bytes)?;
    }
    Ok(results)
}
