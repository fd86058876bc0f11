//! Stores the results of a stage in a folder, from which a later stage reads them. The folder holds
//! arrays, and an index that lists them.

use crate::fields::{FieldChange, difference};
use crate::npz::NpzFile;
use crate::sealed::json;
use crate::version::VERSION;
use crate::{
    ArgumentStyle, Failure, Finished, MAX_INDEX_BYTES, MEASUREMENT, Method, Plan, Results, SUMMARY,
    machine, sealed,
};
use etendue_scene::{Color, Scene, SceneFile, read_below, read_file, scene_hash};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json as tree_of};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// The path at which a stage keeps a copy of a mesh or picture, beside the index called
/// `index`.
pub fn copy_of(index: &str, input: &str) -> String {
    let stage = index.trim_end_matches(".json");
    format!("{stage}.inputs/{input}")
}

/// An index: the stage, its scene, and the hash of each file.
#[derive(Debug, Serialize, Deserialize)]
pub struct Index<T> {
    /// Name of the scene.
    pub scene: String,
    scene_hash: String,
    version: String,
    /// The stage's own data.
    #[serde(flatten)]
    pub content: T,
    /// The scene file, including defaults and overrides.
    pub scene_file: SceneFile,
    /// BLAKE3 hash of each mesh and picture of the scene, by its name in the scene file.
    #[serde(default)]
    inputs: BTreeMap<String, String>,
    files: BTreeMap<String, String>,
}

impl<T: Serialize> Index<T> {
    /// The index of a stage for a scene.
    pub fn new(scene: &Scene, content: T) -> Self {
        Self {
            scene: scene.name.clone(),
            scene_hash: scene.hash(),
            version: VERSION.to_owned(),
            content,
            scene_file: scene.file.clone(),
            inputs: scene.inputs.clone(),
            files: BTreeMap::new(),
        }
    }

    /// Writes the index after the files it lists.
    pub fn finish(mut self, results: Results) -> Result<Finished, Failure> {
        results.finish(|files| {
            self.files.clone_from(files);
            json(&self)
        })
    }
}

/// The results folder that an earlier stage wrote.
#[derive(Debug)]
pub struct Stored<T> {
    /// Path of the folder.
    pub folder: PathBuf,
    /// Path of the index, for messages.
    path: PathBuf,
    name: &'static str,
    /// The index of the stage.
    pub index: Index<T>,
}

impl<T: DeserializeOwned> Stored<T> {
    /// Reads the index called `name` in a folder. The index must be unchanged and written by this
    /// version.
    pub fn read(folder: &Path, name: &'static str) -> Result<Self, Failure> {
        let path = folder.join(name);
        let shown = path.display();
        let bytes = read_below(folder, name, MAX_INDEX_BYTES)
            .map_err(|e| Failure::bad_input(format!("cannot read {shown}: {e}")))?;
        let fault = |what: String| Failure::bad_input(format!("{shown}: {what}"));
        let tree: Value = serde_json::from_slice(&bytes).unwrap_or_default();
        // The version is checked first, because another version may write the other fields
        // differently.
        if let Some(version) = tree["version"].as_str().filter(|v| *v != VERSION) {
            return Err(fault(format!(
                "the file was written by version {version}, but this program is version {VERSION}: all stages must be of the same version"
            )));
        }
        sealed::check_seal(&bytes).map_err(fault)?;
        let index: Index<T> = serde_json::from_slice(&bytes).map_err(|e| fault(e.to_string()))?;
        let stored = Self {
            folder: folder.to_owned(),
            path,
            name,
            index,
        };
        // A run does not list the meshes and pictures of its scene.
        match name == SUMMARY || stored.has_hash_of_scene() {
            true => Ok(stored),
            false => Err(stored.fault("scene_hash is not the hash of scene_file and inputs")),
        }
    }
}

impl<T> Stored<T> {
    /// Checks whether the stage is one of a scene.
    pub fn is_of(&self, scene: &Scene) -> bool {
        self.index.scene_hash == scene.hash()
    }

    fn has_hash_of_scene(&self) -> bool {
        self.index.scene_hash == scene_hash(&self.index.scene_file, &self.index.inputs)
    }

    /// The scene of the stage; its meshes and pictures are the stage's own copies.
    pub fn scene(&self) -> Result<Scene, Failure> {
        if !self.has_hash_of_scene() {
            return Err(self.fault(
                "a run holds no copies of the meshes and pictures of its scene; allowed: a folder of `measure`",
            ));
        }
        let Index {
            scene,
            scene_file,
            inputs,
            ..
        } = &self.index;
        self.check_inputs()?;
        let copies = self.folder.join(copy_of(self.name, ""));
        let scene = machine::resolved(
            scene,
            scene_file.clone(),
            &copies,
            &self.path.display().to_string(),
        )?;
        if scene.inputs != *inputs {
            return Err(self.fault("the field inputs does not match the files in the folder"));
        }
        Ok(scene)
    }

    /// Checks that the stage's copies of the scene's meshes and pictures are unchanged.
    pub fn check_inputs(&self) -> Result<(), Failure> {
        let mut names = self.index.inputs.keys();
        names.try_for_each(|name| self.bytes(&copy_of(self.name, name)).map(drop))
    }

    /// The paths of the index and of all files it lists.
    pub fn paths(&self) -> Vec<PathBuf> {
        let files = self.index.files.keys().map(|name| self.folder.join(name));
        files.chain([self.path.clone()]).collect()
    }

    /// Checks whether the index lists the file `name`.
    #[must_use]
    pub fn lists(&self, name: &str) -> bool {
        self.index.files.contains_key(name)
    }

    /// The arrays in the file `name`.
    pub fn npz(&self, name: &str) -> Result<NpzFile, Failure> {
        NpzFile::new(self.folder.join(name), self.bytes(name)?)
    }

    /// The file `name`, whose bytes must be unchanged.
    fn bytes(&self, name: &str) -> Result<Vec<u8>, Failure> {
        listed_bytes(&self.folder, self.name, &self.index.files, name)
    }

    /// Fails if `other` belongs to another scene or, if `run` is set, if its measurement has
    /// different settings.
    pub fn check_scene<U>(&self, other: &Stored<U>, run: bool) -> Result<(), Failure> {
        let tree = |file: &SceneFile, inputs: &BTreeMap<String, String>| {
            let mut tree = serde_json::to_value(file).unwrap_or_default();
            if let Some(fields) = tree.as_object_mut() {
                if !run {
                    fields.remove("run");
                }
                fields.insert("inputs".to_owned(), tree_of!(inputs));
            }
            tree
        };
        let own = tree(&self.index.scene_file, &self.index.inputs);
        let others = tree(&other.index.scene_file, &other.index.inputs);
        self.check_same(other, &own, &others)
    }

    /// Fails if this index and `other` hold different values.
    pub fn check_same<U>(
        &self,
        other: &Stored<U>,
        own: &Value,
        others: &Value,
    ) -> Result<(), Failure> {
        let Some(FieldChange { field, values }) = difference(own, others) else {
            return Ok(());
        };
        let [own, others] = values;
        let (path, other) = (self.path.display(), other.path.display());
        Err(Failure::bad_input(format!(
            "{path} and {other} are incompatible: {field} is {own} and {others}"
        )))
    }

    /// The message for a fault of the index.
    pub fn fault(&self, what: impl Display) -> Failure {
        Failure::bad_input(format!("{}: {what}", self.path.display()))
    }
}

/// A result of `run` or `compare`, or a measurement, by any version of this program. Every file is
/// verified when it is read.
#[derive(Debug)]
pub struct ResultFolder {
    /// Path of the folder.
    pub folder: PathBuf,
    /// Name of the index: `summary.json` or `measurement.json`.
    pub name: &'static str,
    /// The bytes of the index.
    pub index: Vec<u8>,
    files: BTreeMap<String, String>,
}

impl ResultFolder {
    /// Reads the index of a folder, which must be unchanged.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let mut names = [SUMMARY, MEASUREMENT].into_iter();
        let name = names.find(|name| folder.join(name).is_file());
        let name = name.ok_or_else(|| no_result(folder))?;
        let path = folder.join(name);
        let shown = path.display();
        let fault = |what: String| Failure::bad_input(format!("{shown}: {what}"));
        let index = read_below(folder, name, MAX_INDEX_BYTES)
            .map_err(|e| Failure::bad_input(format!("cannot read {shown}: {e}")))?;
        sealed::check_format(&index).map_err(fault)?;
        #[derive(Deserialize)]
        struct Files {
            files: BTreeMap<String, String>,
        }
        let Files { files } = serde_json::from_slice(&index)
            .map_err(|e| fault(format!("the file is not a summary of a run: {e}")))?;
        sealed::check_seal(&index).map_err(fault)?;
        Ok(Self {
            folder: folder.to_owned(),
            name,
            index,
            files,
        })
    }

    /// The hash of the file `name`, if the index lists it.
    #[must_use]
    pub fn hash(&self, name: &str) -> Option<&String> {
        self.files.get(name)
    }

    /// The file `name`, whose bytes must be unchanged.
    pub fn bytes(&self, name: &str) -> Result<Vec<u8>, Failure> {
        listed_bytes(&self.folder, self.name, &self.files, name)
    }

    /// Writes the index and all files that it lists to another folder, byte by byte; returns the
    /// folder. `arguments` is the style in which messages name `force`.
    pub fn copy(
        &self,
        out: &Path,
        force: bool,
        arguments: ArgumentStyle,
    ) -> Result<PathBuf, Failure> {
        let tree: Value = serde_json::from_slice(&self.index).unwrap_or_default();
        check_earlier_file(out, self.name, tree["scene_file"].clone(), force, arguments)?;
        let plan = Plan {
            index: self.name,
            files: self.files.keys().cloned().collect(),
            inputs: Vec::new(),
            force,
            arguments,
        };
        let mut results = Results::claim(out, plan)?;
        for name in self.files.keys() {
            results.write(name, &self.bytes(name)?)?;
        }
        let index = sealed::unsealed(&self.index).unwrap_or_default();
        Ok(results.finish(|_| index)?.folder)
    }
}

/// The error of a folder without a result. The folder of `run --rgb` has a result in each
/// of its folders.
#[must_use]
pub fn no_result(folder: &Path) -> Failure {
    let shown = folder.display();
    let colors = [Color::Red, Color::Green, Color::Blue].map(Color::name);
    let is_rgb = colors
        .iter()
        .all(|c| folder.join(c).join(SUMMARY).is_file());
    Failure::bad_input(if is_rgb {
        format!(
            "{shown} holds results of three channels; allowed: one of {shown}/red, {shown}/green and {shown}/blue"
        )
    } else if folder.is_dir() {
        format!(
            "{shown} holds no result, because it has no {SUMMARY}; allowed: a folder that run, compare or measure has written"
        )
    } else {
        format!("{shown}: no such folder")
    })
}

/// The file `name` of a folder. The hash of its bytes must equal the hash in `files`, which
/// comes from the index called `index`.
fn listed_bytes(
    folder: &Path,
    index: &str,
    files: &BTreeMap<String, String>,
    name: &str,
) -> Result<Vec<u8>, Failure> {
    let [shown, index] = [name, index].map(|name| folder.join(name));
    let (shown, index) = (shown.display(), index.display());
    let hash = files.get(name).ok_or_else(|| {
        Failure::bad_input(format!("{index}: the field files does not list {name}"))
    })?;
    let bytes = read_below(folder, name, machine::available_memory())
        .map_err(|e| Failure::bad_input(format!("cannot read {shown}: {e}")))?;
    if *hash != blake3::hash(&bytes).to_hex().as_str() {
        let message = format!("{shown} is damaged: its hash differs from the hash in {index}");
        return Err(Failure::bad_input(message));
    }
    Ok(bytes)
}

/// The summary of a run if the run had exactly this scene, method and version.
pub fn summary_of(folder: &Path, scene: &Scene, method: Method) -> Option<Value> {
    let bytes = read_file(&folder.join(SUMMARY), MAX_INDEX_BYTES).ok()?;
    let summary: Value = serde_json::from_slice(&bytes).ok()?;
    let same = summary["scene_hash"] == scene.hash()
        && summary["version"] == VERSION
        && summary["against"] == tree_of!(scene.hash_of_other())
        && summary["method"] == serde_json::to_value(method).ok()?;
    (sealed::is_sealed(&bytes) && same).then_some(summary)
}

/// Fails if a folder holds a result of another scene. Two scenes may have the same name, but the
/// result of one must not replace the result of the other. Settings of the measurement are ignored.
/// `arguments` is the style in which the message names `force`.
pub fn check_earlier(
    folder: &Path,
    index: &str,
    scene: &Scene,
    force: bool,
    arguments: ArgumentStyle,
) -> Result<(), Failure> {
    let now = serde_json::to_value(&scene.file).unwrap_or_default();
    check_earlier_file(folder, index, now, force, arguments)
}

/// [`check_earlier`] for the tree of a scene file.
fn check_earlier_file(
    folder: &Path,
    index: &str,
    mut now: Value,
    force: bool,
    arguments: ArgumentStyle,
) -> Result<(), Failure> {
    let earlier = || {
        let bytes = read_file(&folder.join(index), MAX_INDEX_BYTES).ok()?;
        let mut earlier: Value = serde_json::from_slice(&bytes).ok()?;
        Some(earlier.get_mut("scene_file")?.take())
    };
    let Some(mut earlier) = earlier() else {
        return Ok(());
    };
    for tree in [&mut earlier, &mut now] {
        tree.as_object_mut().map(|fields| fields.remove("run"));
    }
    match difference(&earlier, &now).filter(|_| !force) {
        None => Ok(()),
        Some(FieldChange { field, values }) => Err(Failure::cannot_run(format!(
            "{} holds the result of another scene, in which {field} is {} and not {}: \
             {}, or replace it with {}",
            folder.display(),
            values[0],
            values[1],
            arguments.another_folder(),
            arguments.force()
        ))),
    }
}
