//! Reads and resolves scene files, and creates folders for the results of a stage.

use etendue_scene::{
    Color, RunFile, Scene, SceneError, SceneFile, limits, read_below, read_file, resolve,
};
use etendue_store::stored::copy_of;
use etendue_store::{ArgumentStyle, Failure, Plan, Results, machine};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// A scene file, and fields to set in it.
#[derive(Clone, Debug)]
pub struct SceneSource {
    /// The path of the scene file, in RON or JSON. The paths of meshes and pictures are relative
    /// to the folder of the scene file.
    pub path: PathBuf,
    /// A text that is read instead of the scene file; `path` then gives only the name and the
    /// folder of the scene.
    pub text: Option<String>,
    /// Fields of the scene, with the values to which [`SceneFile::with`] sets them.
    pub set: Vec<(String, String)>,
    /// The number of each colour, if it is not the number that the scene selects.
    pub color: Option<Color>,
    /// The style in which messages name arguments.
    pub arguments: ArgumentStyle,
}

impl SceneSource {
    /// A scene file that the command line names.
    #[must_use]
    pub fn file(path: &Path, set: &[(String, String)]) -> Self {
        Self {
            path: path.to_owned(),
            text: None,
            set: set.to_owned(),
            color: None,
            arguments: ArgumentStyle::Command,
        }
    }

    /// The folder of the scene's meshes and pictures.
    fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// The name of the scene, which is the file name without its extension.
    fn name(&self) -> Cow<'_, str> {
        self.path.file_stem().unwrap_or_default().to_string_lossy()
    }

    /// The name of the scene for messages: the path of the scene file, or the name of the
    /// scene if there is no file.
    fn shown(&self) -> String {
        match self.text {
            Some(_) => self.name().into_owned(),
            None => self.path.display().to_string(),
        }
    }

    /// The given text or, if no text is given, the content of the scene file.
    fn read(&self) -> Result<Cow<'_, str>, Failure> {
        if let Some(text) = &self.text {
            return Ok(text.into());
        }
        let unreadable = |e: &dyn std::fmt::Display| {
            Failure::bad_input(format!("cannot read {}: {e}", self.shown()))
        };
        let bytes = read_file(&self.path, limits::FILE_BYTES).map_err(|e| unreadable(&e))?;
        let text = String::from_utf8(bytes)
            .map_err(|_| unreadable(&"it is not text; allowed: a scene in RON or JSON"))?;
        Ok(text.into())
    }
}

/// Reads, overrides and resolves a scene; `options` applies the overrides that have their own
/// arguments.
pub fn scene(source: &SceneSource, options: impl FnOnce(&mut RunFile)) -> Result<Scene, Failure> {
    let arguments = source.arguments;
    let shown = source.shown();
    let text = source.read()?;
    let unread = |error| match error {
        // The user of a scene without a file has not written its text.
        SceneError::Syntax { message, .. } if source.text.is_some() => message,
        error => error.to_string(),
    };
    let mut file = SceneFile::parse(&text)
        .map_err(|error| Failure::bad_input(format!("{shown}: {}", unread(error))))?;
    let unset = |e| Failure::bad_input(format!("{shown}: {}", arguments.in_set(e)));
    file = file.with_all(&source.set).map_err(unset)?;
    file.run.color = source.color.unwrap_or(file.run.color);
    let photons = file.run.photons;
    options(&mut file.run);
    let mut set: Vec<(String, String)> = source
        .set
        .iter()
        .map(|(path, value)| (path.clone(), arguments.set(path, value)))
        .collect();
    if file.run.photons != photons {
        let option = arguments.with("photons", file.run.photons);
        set.push(("run.photons".to_owned(), option));
    }
    let memory = machine::available_memory();
    resolve(&source.name(), file, source.folder(), memory).map_err(|error| {
        // If the scene is a text without a file, messages do not state line numbers.
        let text = if source.text.is_none() { &*text } else { "" };
        // One line for each fault, with the position in the text or the argument that set the
        // faulty value.
        let faults = error.in_text(text, &set);
        let lines = faults.lines().map(|line| format!("{shown}: {line}"));
        Failure::of_scene(&error, lines.collect::<Vec<_>>().join("\n"))
    })
}

/// The scene file, if there is one, and all files that it names.
pub fn inputs(source: &SceneSource, scene: &Scene) -> Vec<PathBuf> {
    let file = source.text.is_none().then(|| source.path.clone());
    let named = scene.inputs.keys().map(|name| source.folder().join(name));
    named.chain(file).collect()
}

/// Claims the folder of a stage that will write the given files. Copies the scene's meshes and
/// pictures to this folder, because the next stage reads them from there.
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
        arguments: source.arguments,
    };
    let mut results = Results::claim(out, plan)?;
    for (name, hash) in &scene.inputs {
        let path = source.folder().join(name);
        let shown = path.display();
        let bytes = read_below(source.folder(), name, u64::MAX)
            .map_err(|e| Failure::bad_input(format!("cannot read {shown}: {e}")))?;
        if *hash != blake3::hash(&bytes).to_hex().as_str() {
            let message = format!("{shown} changed while it was read");
            return Err(Failure::bad_input(message));
        }
        results.write(&copy_of(index, name), &bytes)?;
    }
    Ok(results)
}
