use crate::args::SceneArgs;
use crate::values::{Point, said_at};
use etendue_scene::{
    RunFile, Scene, SceneError, SceneFile, limits, read_below, read_file, resolve,
};
use etendue_store::Failure;
use etendue_store::machine;
use etendue_store::stored::copy_of;
use etendue_store::{Plan, Results};
use std::path::{Path, PathBuf};

/// Reads, overrides and resolves the scene named on the command line; `options` are overrides of the command
/// line's own.
pub(crate) fn scene(
    args: &SceneArgs,
    options: impl FnOnce(&mut RunFile),
) -> Result<Scene, Failure> {
    let path = &args.path;
    let shown = path.display();
    let unreadable =
        |e: &dyn std::fmt::Display| Failure::bad_input(format!("cannot read {shown}: {e}"));
    let bytes = read_file(path, limits::FILE_BYTES).map_err(|e| unreadable(&e))?;
    let text = str::from_utf8(&bytes).map_err(|e| unreadable(&e))?;
    let mut file =
        SceneFile::parse(text).map_err(|e| Failure::bad_input(format!("{shown}: {e}")))?;
    let refused = |e| Failure::bad_input(format!("{shown}: --set {e}"));
    file = file.with_all(&args.set).map_err(refused)?;
    let photons = file.run.photons;
    options(&mut file.run);
    let mut set = named(&args.set);
    if file.run.photons != photons {
        let option = format!("--photons {}", file.run.photons);
        set.push(("run.photons".to_owned(), option));
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let scene = resolve(&name, file, folder(args), machine::available_memory());
    scene.map_err(|error| self::refused(&error, &shown.to_string(), text, &set))
}

/// For each field that was set, what has set it.
pub(crate) fn named(set: &[(String, String)]) -> Vec<(String, String)> {
    let set = set.iter();
    set.map(|(path, value)| (path.clone(), format!("--set {path}={value}")))
        .collect()
}

/// What is wrong with a scene, a line for each fault: where it is in the text, or what has set it.
pub(crate) fn refused(
    error: &SceneError,
    shown: &str,
    text: &str,
    set: &[(String, String)],
) -> Failure {
    let lines = error.in_text(text, set);
    let lines = lines.lines().map(|line| format!("{shown}: {line}"));
    Failure::of_scene(error, lines.collect::<Vec<_>>().join("\n"))
}

/// The scene with some fields set to numbers besides.
pub(crate) fn scene_at(
    args: &SceneArgs,
    point: &Point,
    options: impl FnOnce(&mut RunFile),
) -> Result<Scene, Failure> {
    let mut set = args.set.clone();
    set.extend(
        point
            .iter()
            .map(|(path, value)| (path.clone(), format!("{value:?}"))),
    );
    let args = SceneArgs {
        path: args.path.clone(),
        set,
    };
    scene(&args, options).map_err(|failure| Failure {
        message: said_at(point, failure.message),
        ..failure
    })
}

/// The folder of the scene file, in which its meshes and pictures are.
fn folder(args: &SceneArgs) -> &Path {
    args.path.parent().unwrap_or(Path::new(""))
}

/// The scene file, and all that it names.
pub(crate) fn inputs(args: &SceneArgs, scene: &Scene) -> Vec<PathBuf> {
    let named = scene.inputs.keys().map(|name| folder(args).join(name));
    named.chain([args.path.clone()]).collect()
}

/// Claims a folder for a stage with these files, and copies the meshes and pictures of the scene there: the next
/// stage looks for them beside the index.
pub(crate) fn stage(
    out: &Path,
    index: &'static str,
    mut files: Vec<String>,
    scene: &Scene,
    args: &SceneArgs,
    force: bool,
) -> Result<Results, Failure> {
    files.extend(scene.inputs.keys().map(|name| copy_of(index, name)));
    let plan = Plan {
        index,
        files,
        inputs: inputs(args, scene),
        force,
    };
    let mut results = Results::claim(out, plan)?;
    for (name, hash) in &scene.inputs {
        let path = folder(args).join(name);
        let shown = path.display();
        let bytes = read_below(folder(args), name, u64::MAX)
            .map_err(|e| Failure::bad_input(format!("cannot read {shown}: {e}")))?;
        if *hash != blake3::hash(&bytes).to_hex().as_str() {
            let message = format!("{shown} changed while it was read");
            return Err(Failure::bad_input(message));
        }
        results.write(&copy_of(index, name), &bytes)?;
    }
    Ok(results)
}
